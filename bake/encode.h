/*
 * From a tile's transport in floating point to the blocks of a basis file.
 *
 * Every cut has a bound that holds for any non-negative lighting; encode_tile() returns the largest
 * it made, and the bake declares the largest of all tiles. The proofs are in hal/basis/README.md.
 */
#ifndef INLAY_BAKE_ENCODE_H
#define INLAY_BAKE_ENCODE_H

#include "hal/basis/basis_writer.h"

/* Transport of one kind for some pixels of a tile. */
struct encode_samples {
	enum basis_kind kind;
	int ground; /* of kind V; else 0 */
	int pixels;
	const uint16_t *pixel; /* y * BASIS_TILE + x, ascending */
	const float *value;    /* [pixels][3][lights]; of kind U not negative */
};

struct encode_settings {
	int lights;
	int grounds;
	const double *ground; /* [grounds][3][lights]; for totals of V. Must outlive the encoder. */
	double ratio_cut; /* V: a light leaves the list when it is nowhere further than this from
			     0 or, where that makes the block smaller, from what the lights not
			     listed share (the rest). Likewise pixels that are this near to 0
			     leave, and channels closer together than this share a row. T, D, U:
			     only what is 0 after quantisation leaves, and only equal channels
			     share a row. */
};

struct encode_result {
	struct basis_block_payload *blocks; /* owned by the encoder; valid until the next call */
	int count;
	double object_error, ratio_error; /* bounds, as in struct basis_info_chunk */
};

/* One for each thread. -ENOMEM. */
struct encoder;
int encoder_create(struct encoder **encoder, const struct encode_settings *settings);

/*
 * A set of samples becomes one block, or none when nothing is left of it. D samples must be
 * followed by U samples of the same pixels: they keep and drop pixels together. -EDOM: a value is
 * not finite or beyond 1e30, or one of U negative; -EINVAL: D and U do not pair; -ENOMEM.
 */
int encode_tile(struct encoder *encoder, int tile, const struct encode_samples *samples, int count,
		struct encode_result *result);

void encoder_destroy(struct encoder *encoder); /* NULL is harmless */

#endif
