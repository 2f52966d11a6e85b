/* SPDX-License-Identifier: MIT */
/*
 * From a tile's transport in floating point to the blocks of a basis file.
 *
 * For each kind the cheapest of nothing, patterns, patterns and columns, and columns alone is taken
 * that holds the error asked for; README.md says how. Every cut has a bound that holds for any
 * non-negative lighting, and what it does to real ones is measured against the transport as it came
 * (ensemble.h).
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_H
#define INLAY_BAKE_ENCODE_ENCODE_H

#include <stdbool.h>

#include "bake/encode/ensemble.h"
#include "hal/basis/basis_groups.h"
#include "hal/basis/basis_writer.h"

/* Transport of one kind for some pixels of a tile: t, v, d or u as basis_format.h defines them,
 * not yet divided by X's factors. It is direct + bounce. */
struct encode_samples {
	enum basis_kind kind;
	int ground; /* of kind V; else 0 */
	int pixels;
	const uint16_t *pixel; /* y * BASIS_TILE + x, ascending */
	int channels;	       /* of direct: 3, or 1 where all three are alike */
	const float *direct; /* [pixels][channels][lights]: light that met one surface. Of U >= 0 */
	const float *bounce; /* [pixels][3][lights]: light that met several; NULL: none */
};

/* What the shown layer may be off by, in 8-bit sRGB levels. */
struct encode_target {
	double rms, max; /* over the ensemble's skies, in each tile */
	double cell; /* under a single cell: a column is kept where leaving it out exceeds this */
};

struct encode_settings {
	int lights;
	const struct basis_light *light; /* [lights] */
	int grounds;
	const double *ground;		   /* [grounds][3][lights] */
	int coarse;			   /* K */
	const struct basis_coarse *gather; /* [lights]; NULL where coarse is lights */
	const struct basis_groups *groups; /* the encoder's own, of gather */
	const struct ensemble *ensemble;
	struct encode_target target;
	double column_cut; /* of struct basis_info_chunk */
	bool exact;	   /* make the exact layer too */
			   /* All of it must outlive the encoder. */
};

struct encode_result {
	/* Owned by the encoder; valid until the next call. */
	const struct basis_block_payload *shown, *exact;
	int shown_count, exact_count;
	double object_error, ratio_error; /* bounds, as in struct basis_info_chunk */
	struct ensemble_error error;	  /* measured on this tile's pixels */
};

/* One for each thread. -ENOMEM. */
struct encoder;
int encoder_create(struct encoder **encoder, const struct encode_settings *settings);

/*
 * A set of samples becomes some blocks, or none when nothing is left of it. D samples must be
 * followed by U samples of the same pixels. coverage: [BASIS_TILE * BASIS_TILE], 65535 = 1. -EDOM:
 * a value is not finite or beyond 1e30, or one of U negative; -EINVAL: D and U do not pair;
 * -ENOMEM.
 */
int encode_tile(struct encoder *encoder, int tile, const uint16_t *coverage,
		const struct encode_samples *samples, int count, struct encode_result *result);

void encoder_destroy(struct encoder *encoder); /* NULL is harmless */

#endif
