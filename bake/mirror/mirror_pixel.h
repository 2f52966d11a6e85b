/* SPDX-License-Identifier: MIT */
/*
 * What a pixel's coats of low roughness mirror straight of the sky, as look-ups in the fisheye's
 * picture (struct basis_mirror).
 *
 * A pixel's samples are divided into a few spots, by the directions that a smooth surface would
 * mirror, and the rough coat's lobe into a few widths: a look-up for each, as wide as both. What a
 * sample has mirrored is shared among the widths by how steep its microfacet was. Spots that are
 * wide beside the sky's cells stay in T: cells have their shape, which a look-up does not.
 */
#ifndef INLAY_BAKE_MIRROR_MIRROR_PIXEL_H
#define INLAY_BAKE_MIRROR_MIRROR_PIXEL_H

#include "bake/trace/transport.h"
#include "hal/basis/basis_format.h"

/* A pixel's spots are found by this many samples; further ones count by their sums alone. */
#define MIRROR_SAMPLES_MOST 128

struct mirror_sample {
	double ideal[2]; /* place of what a smooth surface mirrors, in texels of level 0 */
	/* How far lobes where t = 1/2 move the sample: along the plane of incidence they are wider
	 * than across it, and samples spread by the difference. */
	double moved[2];
	double at[2]; /* its place in the lobe that is being divided */
	float steep;  /* x^2 of the microfacet that did it */
	int cell, spot;
	struct rgb light;
	float rest; /* share of it that no look-up has */
};

/* The samples of a pixel; zeroed: none. */
struct mirror_pixel {
	int count;
	double all[3], kept[3]; /* light of all samples; of those below */
	/* Sums of each sample's variance of the lobe where t = 1/2, rad^2: along the plane of
	 * incidence, and across it. */
	double along, across;
	struct mirror_sample sample[MIRROR_SAMPLES_MOST];
};

void mirror_pixel_clear(struct mirror_pixel *pixel);

/* Adds what a sample has mirrored from the surface towards wo. Returns whether it is one of those
 * that are kept. */
bool mirror_pixel_add(struct mirror_pixel *pixel, const struct surface *surface, struct v3 wo,
		      const struct transport_apart *apart);

/* Writes at most BASIS_MIRROR_MOST look-ups, but for their x and y, and returns their number. The
 * pixel has so many camera rays. Of the light of sample k the share sample[k].rest is left, times
 * scale[3]. */
int mirror_pixel_divide(struct mirror_pixel *pixel, const struct cells *cells, int rays,
			struct basis_mirror *mirror, double scale[3]);

#endif
