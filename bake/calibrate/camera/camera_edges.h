/* SPDX-License-Identifier: MIT */
/*
 * The camera's edge spread, from the edges between neighbouring corners of a board. Across each
 * edge at least squares fit, in linear light (of sRGB code values),
 *
 *     light(d) = a + (b - a) E(d - d0 - tilt along)
 *
 * with E the edge of a Gaussian convolved with a pixel's square, which the direction of the edge
 * makes a trapezoid. In ChArUco the paper ends again at its marker, whose distance is fitted, too.
 * The result is the median over the edges of all views.
 */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_EDGES_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_EDGES_H

#include "bake/calibrate/observe/boards.h"
#include "hal/image/image.h"

struct camera_edges {
	int count;	     /* edges that were fitted; 0: too few, and nothing is known */
	double sigma_px;     /* of the Gaussian */
	double deviation_px; /* one standard deviation of sigma */
};

/* picture[seen->views]: 8-bit pictures of the views, all of one board. -ENOMEM. */
int camera_edges_measure(const struct observations *seen, const struct image *picture,
			 const struct board *board, struct camera_edges *edges);

#endif
