/* SPDX-License-Identifier: MIT */
/* The spherical Voronoi cells of a dome's nodes: outlines and solid angles. */
#ifndef INLAY_HAL_OPTICS_DOME_CELLS_H
#define INLAY_HAL_OPTICS_DOME_CELLS_H

#include "hal/optics/dome.h"

struct dome_cells {
	int *first;	     /* [count + 1]: corners of cell i are first[i]..first[i + 1] - 1 */
	double (*corner)[3]; /* unit; counter-clockwise from outside; z exactly 0 on the horizon */
	double *cumulative_sr; /* [corner]: sum of the solid angles of the cell's triangles (node,
				  corner, next corner) up to and including this corner */
	double *radius;	       /* [count]: of the cap around the node that holds the cell, rad */
};

/* Creates the cells of count nodes (unit, z >= 0), whose mutual angle is roughly spacing_rad. 0 or
 * -ENOMEM. */
int dome_cells_create(struct dome_cells **cells, const double (*node)[3], int count,
		      double spacing_rad);
void dome_cells_destroy(struct dome_cells *cells); /* NULL is harmless */

/* Integral of the unit direction over cell i, sr. */
void dome_cells_moment(const struct dome_cells *cells, int i, double moment[3]);

/* Solid angle of the spherical triangle between three unit vectors; negative if clockwise. */
double dome_triangle_sr(const double a[3], const double b[3], const double c[3]);

#endif
