/* SPDX-License-Identifier: MIT */
/* Measures the error that blocks make in the picture, against the transport that they were made
 * from. Private to the encoder. */
#ifndef INLAY_BAKE_JUDGE_MEASURE_H
#define INLAY_BAKE_JUDGE_MEASURE_H

#include "bake/judge/expose.h"
#include "bake/judge/reader.h"

/* Sums of one part under one lighting, in a common exposure. `truth` comes from the transport,
 * `decoded` from the decoded blocks. */
struct measure_sums {
	float truth[3][PART_PIXELS], decoded[3][PART_PIXELS];
};

struct measure {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct measure_sums *sums; /* [parts] */
	double *bound;		   /* [parts]: largest |truth - decoded| of any light */
	int room;		   /* number of parts that there is memory for */
	float *cell_most; /* [lights]: largest error of any pixel, as a multiple of the target */
	/* RMS and largest error of each sky, as multiples of the target. */
	double sky_rms[ENSEMBLE_SKIES_MAX], sky_most[ENSEMBLE_SKIES_MAX];
	/* The picture under one lighting has `places` pixels: those that any part lists. */
	struct measure_sums picture;
	int places;
	int place[PART_PIXELS];	 /* [y * BASIS_TILE + x]: index of a pixel in the picture */
	float open[PART_PIXELS]; /* [places]: share of a pixel that the object leaves uncovered */
};

void measure_free(struct measure *measure); /* zeroed is fine */

/* Returns the largest error under any sky, as a multiple of the target. */
double measure_worst_sky(const struct measure *measure);
/* Returns the largest error under any sky or any light alone, as a multiple of its target. */
double measure_worst(const struct measure *measure);

/* Measures the parts of a tile, each with its reader. -ENOMEM. */
int measure_tile(struct measure *measure, const struct part *parts,
		 const struct block_reader *readers, int count, const uint16_t *coverage,
		 struct ensemble_error *error);

#endif
