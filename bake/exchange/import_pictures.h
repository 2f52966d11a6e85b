/* SPDX-License-Identifier: MIT */
/*
 * Pictures of every light as a source of import (thesis 2.2.4): objects and ground, ground alone,
 * and which pixels are the object's.
 */
#ifndef INLAY_BAKE_EXCHANGE_IMPORT_PICTURES_H
#define INLAY_BAKE_EXCHANGE_IMPORT_PICTURES_H

#include "bake/exchange/import.h"
#include "bake/exchange/picture_stack.h"

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

#endif
