/* SPDX-License-Identifier: MIT */
/*
 * The encoder: turns a tile's light transport in floating point into the blocks of a basis file.
 *
 * Each kind of transport becomes a low-rank basis (patterns with coefficients) plus residual
 * columns for single lights; either may be absent. The encoder chooses the cheapest by estimates,
 * and repairs it until the decoded blocks hold the error asked for (README.md). The error of every
 * approximation is bounded for any non-negative lighting, and measured against the original
 * transport under the lightings of ensemble.h.
 */
#ifndef INLAY_BAKE_ENCODE_ENCODE_H
#define INLAY_BAKE_ENCODE_ENCODE_H

#include "bake/judge/ensemble.h"
#include "bake/judge/samples.h"
#include "hal/basis/basis_writer.h"

struct encode_result {
	/* Owned by the encoder; valid until the next call. */
	const struct basis_block_payload *shown, *exact;
	int shown_count, exact_count;
	double object_error, ratio_error; /* bounds, as in struct basis_info_chunk */
	struct ensemble_error error;	  /* measured on this tile's pixels */
};

/* A thread needs an encoder of its own. */
struct encoder;
/* -ENOMEM. */
int encoder_create(struct encoder **encoder, const struct encode_settings *settings);

/*
 * Encodes the samples of a tile. Each set becomes some blocks, or none if all of it is below the
 * error asked for. D samples must be followed by U samples of the same pixels. coverage [BASIS_TILE
 * * BASIS_TILE] is the object's, 65535 = 1. -EDOM: a value is not finite or beyond 1e30, or one of
 * U is negative; -EINVAL: D and U do not pair; -ENOMEM.
 */
int encode_tile(struct encoder *encoder, int tile, const uint16_t *coverage,
		const struct encode_samples *samples, int count, struct encode_result *result);

void encoder_destroy(struct encoder *encoder); /* NULL is harmless */

#endif
