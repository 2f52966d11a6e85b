/* SPDX-License-Identifier: MIT */
/* Measures the error of blocks in the picture, against the transport that they were made from.
 * Private to the encoder. */
#ifndef INLAY_BAKE_JUDGE_MEASURE_H
#define INLAY_BAKE_JUDGE_MEASURE_H

#include "bake/judge/expose.h"
#include "bake/judge/reader.h"

/* Sums of one part under one lighting, in a common exposure: of the transport (is), of the blocks
 * (got). */
struct measure_sums {
	float is[3][PART_PIXELS], got[3][PART_PIXELS];
};

struct measure {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct measure_sums *sums; /* [parts] */
	double *bound;		   /* [parts]: largest |is - got| of any light */
	int room;		   /* parts that there is memory for */
	float *cell_most; /* [lights]: largest error of any pixel, as a multiple of that asked for */
	/* RMS and largest error of each sky, as multiples of those asked for. */
	double sky_rms[ENSEMBLE_SKIES_MAX], sky_most[ENSEMBLE_SKIES_MAX];
	/* The tile as a picture under one lighting: the pixels that any part lists. */
	struct measure_sums picture;
	int places;
	int place[PART_PIXELS];	 /* [y * BASIS_TILE + x]: of a pixel in the picture */
	float open[PART_PIXELS]; /* [places]: how much of it the object leaves uncovered */
};

void measure_free(struct measure *measure); /* zeroed is fine */

/* The largest error measured, of a sky or of anything, as a multiple of that asked for. */
double measure_worst_sky(const struct measure *measure);
double measure_worst(const struct measure *measure);

/* Measures the parts of a tile, each with its reader. -ENOMEM. */
int measure_tile(struct measure *measure, const struct part *parts,
		 const struct block_reader *readers, int count, const uint16_t *coverage,
		 struct ensemble_error *error);

#endif
