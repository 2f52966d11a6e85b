/* SPDX-License-Identifier: MIT */
/*
 * Light transport from other sources (pictures of other renderers, the thesis's files) to a basis
 * file, by the encoder of inlay-bake render.
 */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_H
#define INLAY_BAKE_EXCHANGE_IMPORT_H

#include <stdbool.h>

#include "bake/encode/encode.h"
#include "bake/tiles/assembly.h"
#include "hal/base/fault.h"
#include "hal/optics/dome.h"

#define IMPORT_PIXELS (BASIS_TILE * BASIS_TILE)

/*
 * Transport of the pixels of a tile; pixel p is y * BASIS_TILE + x. Values are radiances per unit
 * of a light's radiance: [pixels][3][lights], lights in the dome's order.
 */
struct import_tile {
	int x, y, width, height; /* in the picture */
	float coverage[IMPORT_PIXELS];
	bool receiver[IMPORT_PIXELS]; /* a real surface is seen, at least in part */
	float *object;		      /* light of the object, times coverage */
	float *with, *without;	      /* light of the real surface, with and without the object */
};

struct import_source {
	int width, height;
	const struct dome *dome;
	/* u of all receivers, [3][lights], where the ground is flat and lit alike everywhere. NULL:
	 * each receiver has its own u. */
	const double *ground;
	const char *provenance; /* lines for the file's provenance */
	/* Fills in a tile. Called by several threads at once. */
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

/* Encodes the source into a basis file. On failure no file is written, and *report is not set. */
int import_run(const struct import_source *source, const struct import_settings *settings,
	       const char *path, struct assembly_report *report, struct fault *fault);

#endif
