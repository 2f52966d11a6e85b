/* SPDX-License-Identifier: MIT */
/*
 * A stack of pictures of one size, one for each light, in linear light. They are read once into an
 * unnamed file, since they may be larger than memory, and mapped.
 */
#ifndef INLAY_BAKE_EXCHANGE_PICTURE_STACK_H
#define INLAY_BAKE_EXCHANGE_PICTURE_STACK_H

#include <stddef.h>

#include "bake/base/progress.h"
#include "hal/base/fault.h"
#include "hal/colour/transfer.h"

struct picture_stack {
	int width, height, count;
	float *value; /* [count][height][width][3] */
	size_t bytes;
};

struct picture_stack_settings {
	enum transfer transfer; /* of 8-bit pictures */
	double scale;		/* factor for the linear light */
	const int *place;	/* [count]: index in the stack of the k-th picture; NULL: k */
	const char *folder;	/* folder of the unnamed file */
};

/* Reads count pictures named by pattern, numbered from 0, or from 1 where there is no 0. -EINVAL: a
 * picture of another size than the first, or one too many; -ENOENT: one is missing. The fault names
 * the picture. */
int picture_stack_read(struct picture_stack *stack, const char *pattern, int count,
		       const struct picture_stack_settings *settings, struct progress *progress,
		       struct fault *fault);
void picture_stack_free(struct picture_stack *stack); /* idempotent; zeroed is fine */

static inline const float *picture_stack_at(const struct picture_stack *stack, int light, int x,
					    int y)
{
	return stack->value +
	       (((size_t)light * (size_t)stack->height + (size_t)y) * (size_t)stack->width +
		(size_t)x) *
		       3;
}

#endif
