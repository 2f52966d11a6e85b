/* SPDX-License-Identifier: MIT */
/*
 * The encoder: turns a tile's light transport in floating point into the blocks of a basis file.
 *
 * Each kind of transport becomes a low-rank basis (patterns with coefficients) plus residual
 * columns for single lights; either may be absent. The encoder chooses by estimates what is
 * cheapest, and repairs it until the decoded blocks hold the error asked for (README.md). Every cut has a bound that holds for any non-negative
 * lighting, and its effect on the lightings of ensemble.h is measured against the original
 * transport.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_H
#define INLAY_BAKE_ENCODE_ENCODE_H

#include <stdbool.h>

#include "bake/encode/ensemble.h"
#include "hal/basis/basis_groups.h"
#include "hal/basis/basis_writer.h"

/* Transport of one kind for some pixels of a tile, direct + bounce: t, v, d or u of basis_format.h,
 * not yet divided by the factors of X. */
struct encode_samples {
	enum basis_kind kind;
	int ground; /* index of the ground, for kind V; else 0 */
	int pixels;
	const uint16_t *pixel; /* y * BASIS_TILE + x, ascending */
	int channels;	       /* of direct: 3, or 1 where all three are alike */
	const float *direct;   /* [pixels][channels][lights]: light of one surface; U: >= 0 */
	const float *bounce;   /* [pixels][3][lights]: light of several surfaces; NULL: none */
};

/* Largest error of the shown layer, in 8-bit sRGB levels. */
struct encode_target {
	double rms, max; /* under each sky of the ensemble, in each tile: RMS, and of any pixel */
	double cell;	 /* of any pixel under any single cell */
};

struct encode_settings {
	int lights;
	const struct basis_light *light; /* [lights] */
	int grounds;
	const double *ground;		   /* [grounds][3][lights] */
	int coarse;			   /* K */
	const struct basis_coarse *gather; /* [lights]; NULL where coarse is lights */
	const struct basis_groups *groups; /* set by the encoder, from gather */
	const struct ensemble *ensemble;
	struct encode_target target;
	double column_cut; /* of struct basis_info_chunk */
	bool exact;	   /* make the exact layer too */
			   /* All that is pointed to must outlive the encoder. */
};

struct encode_result {
	/* Owned by the encoder; valid until the next call. */
	const struct basis_block_payload *shown, *exact;
	int shown_count, exact_count;
	double object_error, ratio_error; /* bounds, as in struct basis_info_chunk */
	struct ensemble_error error;	  /* measured on this tile's pixels */
};

/* State of one thread. */
struct encoder;
/* -ENOMEM. */
int encoder_create(struct encoder **encoder, const struct encode_settings *settings);

/*
 * Encodes the samples of a tile. Each set becomes some blocks, or none when all of it is below the
 * error asked for. D samples must be followed by U samples of the same pixels. coverage:
 * [BASIS_TILE * BASIS_TILE], 65535 = 1. -EDOM: a value is not finite or beyond 1e30, or one of U is
 * negative; -EINVAL: D and U do not pair; -ENOMEM.
 */
int encode_tile(struct encoder *encoder, int tile, const uint16_t *coverage,
		const struct encode_samples *samples, int count, struct encode_result *result);

void encoder_destroy(struct encoder *encoder); /* NULL is harmless */

#endif
