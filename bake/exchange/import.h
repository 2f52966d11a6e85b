/* SPDX-License-Identifier: MIT */
/*
 * Light transport from elsewhere (pictures of other renderers, the thesis's files) to a basis file:
 * through the same encoder as our own.
 */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_H
#define INLAY_BAKE_EXCHANGE_IMPORT_H

#include <stdbool.h>

#include "bake/encode/encode.h"
#include "hal/base/fault.h"
#include "hal/optics/dome.h"

#define IMPORT_PIXELS (BASIS_TILE * BASIS_TILE)

/*
 * What is known of the pixels of a tile: pixel p is y * BASIS_TILE + x. Values are radiances per
 * unit of the light's; row (p * 3 + channel) holds those of all lights, in the dome's order.
 */
struct import_tile {
	int x, y, width, height; /* in the picture */
	float coverage[IMPORT_PIXELS];
	bool receiver[IMPORT_PIXELS]; /* a real surface is seen, at least in part */
	float *object;		      /* of the object alone, times coverage */
	float *with, *without;	      /* of the real surface, with the object and without it */
};

struct import_source {
	int width, height;
	const struct dome *dome;
	/* Flat ground, lit alike everywhere: [3][lights], u of all receivers. NULL: each has its
	 * own. */
	const double *ground;
	const char *provenance; /* lines about where it comes from */
	/* Fills in a tile. Several threads may ask at once. */
	void (*fill)(const void *context, struct import_tile *tile);
	const void *context;
};

struct import_settings {
	struct encode_target target; /* max 0: twice rms */
	double column_cut;
	int coarse; /* frequency of the coarse dome; 0: chosen */
	bool exact;
	int threads; /* 0: one for each processor */
	bool quiet;
};

/* Nothing is written on failure. */
int import_run(const struct import_source *source, const struct import_settings *settings,
	       const char *path, struct fault *fault);

#endif
