/* SPDX-License-Identifier: MIT */
/*
 * Pictures of every light as a source of import (thesis 2.2.4): objects and ground, ground alone,
 * and which pixels are the object's.
 */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_PICTURES_H
#define INLAY_BAKE_EXCHANGE_IMPORT_PICTURES_H

#include <stddef.h>

#include "bake/base/progress.h"
#include "bake/exchange/import.h"
#include "hal/base/fault.h"
#include "hal/colour/transfer.h"

/*
 * A stack of pictures of one size, one for each light, in linear light. They are read once into an
 * unnamed file, since they may be larger than memory, and mapped.
 */

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

enum import_receivers {
	RECEIVERS_AUTO, /* flat where the pictures show it */
	RECEIVERS_FLAT, /* level ground, lit alike everywhere */
	RECEIVERS_OWN,	/* each pixel by itself */
};

extern const char *const import_receivers_names[]; /* "auto", "flat", "own", NULL */

struct import_pictures_settings {
	const char *object, *ground, *alone; /* patterns; alone may be NULL */
	/* one of them; of a mask, pixels at least half bright are objects */
	const char *coverage, *mask;
	const char *folder;	/* for unnamed temporary files */
	enum transfer transfer; /* of 8-bit pictures */
	double scale;		/* factor that brings the pictures to lights of radiance 1 */
	enum import_receivers receivers;
	bool quiet;
};

struct import_pictures {
	/* alone: the object over black; empty: its light in edge pixels is estimated from the
	 * ground beside. */
	struct picture_stack with, without, alone;
	float *coverage;    /* [height][width] */
	uint8_t *is_ground; /* [height][width]: a real surface is there, seen or hidden */
	double *ground;	    /* [3][lights], where it is flat */
	bool flat;
	const struct dome *dome;
};

/*
 * Reads and judges the pictures. place[k]: light of the k-th picture. -EINVAL: sizes or numbers
 * that do not match, or what import_judge() finds; the fault names it.
 */
int import_pictures_read(struct import_pictures *pictures, const struct dome *dome,
			 const int *place, const struct import_pictures_settings *settings,
			 struct fault *fault);
void import_pictures_free(struct import_pictures *pictures); /* idempotent; zeroed is fine */

/* fill() of struct import_source; context is a struct import_pictures. */
void import_pictures_fill(const void *context, struct import_tile *tile);

/*
 * Sets pictures->flat and pictures->ground. -EINVAL, and the fault says what to look at:
 *     - pictures of ground and objects are interchanged, or the coverage is inverted, as far as the
 *       ground gets brighter by it;
 *     - pictures of the objects alone show more than the objects;
 *     - flat ground does not have the light that cells of radiance 1 give;
 *     - pictures resemble those of distant lights more than those of neighbours.
 */
int import_judge(struct import_pictures *pictures, const struct import_pictures_settings *settings,
		 struct fault *fault);

#endif
