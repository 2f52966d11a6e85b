/* SPDX-License-Identifier: MIT */
/* What blocks do to the picture, against the transport that they were made from. Private to the
 * encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_MEASURE_H
#define INLAY_BAKE_ENCODE_ENCODE_MEASURE_H

#include "bake/encode/encode_expose.h"
#include "bake/encode/encode_reader.h"

/* Sums of one part under one lighting, in a common exposure. */
struct measure_sums {
	double is[3][PART_PIXELS], got[3][PART_PIXELS];
};

/* The tile as a picture under one lighting: places are y * BASIS_TILE + x. */
struct measure_pixel {
	double object_is[3], object_got[3];
	double ratio_is[3], ratio_got[3];
	double back[3]; /* the ground's own light, covered or not; 0 where there is none */
};

struct measure {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct measure_sums *sums; /* [parts] */
	double *bound;		   /* [parts]: largest |what is - what blocks say| of any light */
	int room;
	/* Largest error of each place as a share of that asked for; skies: those that are tried. */
	double sky_over[PART_PIXELS], cell_over[PART_PIXELS];
	/* Of each sky, by its place, as shares of what is asked for. */
	double sky_rms[ENSEMBLE_SKIES_MAX], sky_most[ENSEMBLE_SKIES_MAX];
	struct measure_pixel pixel[PART_PIXELS];
};

void measure_free(struct measure *measure); /* zeroed is fine */

/* Parts of a tile, each with its reader: errors, and each part's bound. number: which sky is in
 * each place. -ENOMEM. */
int measure_tile(struct measure *measure, const struct part *parts,
		 const struct block_reader *readers, int count, const uint16_t *coverage,
		 const int *number, struct ensemble_error *error);

#endif
