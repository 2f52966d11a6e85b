/* SPDX-License-Identifier: MIT */
/*
 * Chooses the parts of a dome that are finer, by what the sky needs (sky_need.h). A cell of the
 * base dome is divided where that lessens m by enough, and those cells come first where it does so
 * by the most for each light.
 */
#ifndef INLAY_BAKE_SKY_SKY_PARTS_H
#define INLAY_BAKE_SKY_SKY_PARTS_H

#include <stdbool.h>

#include "bake/sky/sky_need.h"

struct sky_parts {
	struct dome_fine *part; /* [count]: one for each cell that is divided, around its light */
	int count;
	int lights;   /* of a dome with these parts */
	bool limited; /* with more lights it would be finer */
};

/* Chooses parts of a dome of at most `most` lights. 0; -E2BIG: the dome alone has more; -ENOMEM. */
int sky_parts_choose(struct sky_parts *parts, const struct sky_need *need, int most,
		     struct fault *fault);
void sky_parts_free(struct sky_parts *parts); /* idempotent; zeroed is fine */

/* Writes their list as a whole file. what: where the light is from, for the remark in its first
 * line. Errors of output_open(). */
int sky_parts_write(const struct sky_parts *parts, const struct sky_need *need, const char *what,
		    const char *path, struct fault *fault);

#endif
