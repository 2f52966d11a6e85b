/* SPDX-License-Identifier: MIT */
/*
 * A stack of pictures of one size, one for each light, in linear light: read once, kept in an
 * unnamed file (they may be more than memory holds) and mapped.
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
	double scale;		/* linear light is multiplied by it */
	const int *place;	/* [count]: where the k-th picture goes; NULL: as they come */
	const char *folder;	/* where there is room for the unnamed file */
};

/* Reads count pictures called pattern, numbered from 0, or from 1 where there is no 0. Another size
 * than the first picture's, one missing, one more than count: -EINVAL, -ENOENT, and the fault names
 * it. */
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
