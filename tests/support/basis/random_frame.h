/* SPDX-License-Identifier: MIT */
/* What the compositor needs for one frame of a basis: a random background and random light. */
#ifndef INLAY_TESTS_SUPPORT_BASIS_RANDOM_FRAME_H
#define INLAY_TESTS_SUPPORT_BASIS_RANDOM_FRAME_H

#include "hal/compositor/compositor.h"
#include "tests/support/basis/synthetic_basis.h"

struct random_frame {
	struct light_selection lights;
	struct compositor *compositor;
	struct picture picture;	   /* the background */
	struct backdrop backdrop;  /* the same picture, as the compositor takes it */
	uint8_t *background, *out; /* [height][stride]; every byte of out is 0x5a */
	size_t stride, bytes;	   /* a row has one pixel more than the basis is wide */
};

/* The frame has the basis's size. basis and pool are borrowed and must outlive the frame. Free it
 * with random_frame_end(). */
void random_frame_begin(struct random_frame *f, const struct basis *basis, struct pool *pool,
			struct chance *chance);
void random_frame_end(struct random_frame *f);

/* Composites the frame into f->out and fails the test where that fails. */
void random_frame_run(struct random_frame *f, int pose);

#endif
