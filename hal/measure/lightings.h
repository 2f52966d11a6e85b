/* SPDX-License-Identifier: MIT */
/*
 * Lightings for tests of a basis: built-in ones, files of lights, panoramas. All but files are
 * exposed like a camera would expose them.
 */
#ifndef INLAY_HAL_MEASURE_LIGHTINGS_H
#define INLAY_HAL_MEASURE_LIGHTINGS_H

#include "hal/base/fault.h"
#include "hal/basis/basis.h"
#include "hal/optics/dome.h"

/* One lighting, or several of one kind, of which the worst result counts. */
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

/* Returns one member of a lighting: [lights]. */
const float (*lighting_member(const struct lighting *lighting, const struct basis *basis,
			      int member))[3];

/* Copies a file's name without folders and extension. */
void lighting_name(const char *path, char *name, size_t room);

/* Creates the dome of the basis's lights; the caller frees it. -ENOTSUP: their nodes divide no sky;
 * -ENOMEM. */
int lightings_dome(struct dome *dome, const struct basis *basis, struct fault *fault);

/* Each function adds to the list. After a failure the earlier entries are still valid. */

/* Adds overcast (CIE), sun (low, at a place that no bake has tried), random, and single cells
 * (`cells` of them, spread over the sky). White ground has radiance 1; with single cells white
 * ground or the brightest spot of the object. -ENOMEM. */
int lightings_add_built_in(struct lightings *lightings, const struct basis *basis, int cells,
			   struct fault *fault);

/* Adds a file of lights (hal/lights/lights_file.h), unchanged. */
int lightings_add_file(struct lightings *lightings, const struct basis *basis, const char *path,
		       struct fault *fault);

/* Adds the mean of an equirectangular picture over each light, exposed so that white ground has
 * radiance 0.6. -EINVAL: the picture is not in linear light; -ENOTSUP: the basis's lights are no
 * dome's; -ENOMEM, errors of reading. */
int lightings_add_panorama(struct lightings *lightings, const struct basis *basis, const char *path,
			   struct fault *fault);

#endif
