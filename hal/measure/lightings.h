/* SPDX-License-Identifier: MIT */
/*
 * Lightings to try a basis under: built-in ones, files of lights, panoramas. All but files are
 * exposed as a camera would be.
 */
#ifndef INLAY_HAL_MEASURE_LIGHTINGS_H
#define INLAY_HAL_MEASURE_LIGHTINGS_H

#include "hal/base/fault.h"
#include "hal/basis/basis.h"
#include "hal/optics/dome.h"

/* One or, of a kind, several, whose worst counts. */
struct lighting {
	char name[64];
	int members;
	float (*radiance)[3]; /* [members][lights] */
};

struct lightings {
	struct lighting *item;
	int count;
};

void lightings_free(struct lightings *lightings); /* idempotent; zeroed is fine */

/* One member of a lighting: [lights]. */
const float (*lighting_member(const struct lighting *lighting, const struct basis *basis,
			      int member))[3];

/* The dome whose lights the basis's are. -ENOTSUP: of none. */
int lightings_dome(struct dome *dome, const struct basis *basis, struct fault *fault);

/* Each adds to the list. Fine failures leave what was there. */

/* Overcast (CIE), a low sun that no bake has tried, single cells (cells of them, spread over the
 * sky), random. White ground, or with single cells what is brightest of it and the object, has
 * radiance 1. */
int lightings_add_built_in(struct lightings *lightings, const struct basis *basis, int cells,
			   struct fault *fault);

int lightings_add_file(struct lightings *lightings, const struct basis *basis, const char *path,
		       struct fault *fault);

/* The mean of an equirectangular picture over each light, white ground having radiance 0.6.
 * -EINVAL: the picture is not of linear light; -ENOTSUP: the basis's lights are no dome's. */
int lightings_add_panorama(struct lightings *lightings, const struct basis *basis, const char *path,
			   struct fault *fault);

/*
 * Makes some lights brighter, by a part of their own and by a little of the mean, so that dark ones
 * change too: a frame next to the one of these lights. Which ones moves on from turn to turn;
 * changed: 0..lights.
 */
void lighting_change(float (*radiance)[3], int lights, int changed, int turn);

#endif
