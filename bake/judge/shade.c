/* SPDX-License-Identifier: MIT */
#include "bake/judge/shade.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* There is a sun of each of these sizes, in multiples of the sky's light, in the cell that leaves
 * the object darkest, and in the one that makes the deepest shadow. */
static const double sizes[] = {3, 10};
#define SIZES ((int)(sizeof(sizes) / sizeof(*sizes)))
#define OWN (2 * SIZES)
_Static_assert(OWN <= ENSEMBLE_OWN_MAX, "there is room for the tile's own suns");

int shade_create(struct shade *shade, const struct encode_settings *settings)
{
	const struct ensemble *common = settings->ensemble;
	const size_t sky = 3 * (size_t)common->lights;

	*shade = (struct shade){.common = common, .skies = *common};
	shade->skies.skies += OWN;
	memset(shade->skies.strong + common->tried, 0, OWN * sizeof(*shade->skies.strong));
	memcpy(shade->skies.strong + common->tried + OWN, common->strong + common->tried,
	       (size_t)(common->skies - common->tried) * sizeof(*common->strong));
	shade->skies.radiance = calloc((size_t)shade->skies.skies * sky,
				       sizeof(*shade->skies.radiance));
	return shade->skies.radiance ? 0 : -ENOMEM;
}

void shade_free(struct shade *shade)
{
	ensemble_free(&shade->skies);
	*shade = (struct shade){.common = NULL};
}

/* Returns the light that leaves a part darkest: the sum of its values is least for an object (T),
 * and largest for a shadow (V, D), as these are what the object takes away. */
static int darkest_cell(const struct part *part, int lights)
{
	const double sign = part->kind == BASIS_KIND_T ? -1 : 1;
	double most = 0;
	int best = 0;

	for (int i = 0; i < lights; i++) {
		const float *value = part->value + (size_t)i * (size_t)part->rows;
		double sum = 0;

		for (int r = 0; r < part->rows; r++)
			sum += sign * (double)value[r];
		if (!i || sum > most) {
			most = sum;
			best = i;
		}
	}
	return best;
}

void shade_begin(struct shade *shade)
{
	const struct ensemble *const common = shade->common;
	const size_t sky = 3 * (size_t)common->lights, tried = (size_t)common->tried;
	float *const to = shade->skies.radiance;

	memcpy(to, common->radiance, tried * sky * sizeof(*to));
	memcpy(to + (tried + OWN) * sky, common->radiance + tried * sky,
	       ((size_t)common->skies - tried) * sky * sizeof(*to));
	memset(to + tried * sky, 0, OWN * sky * sizeof(*to));
	shade->skies.tried = common->tried + OWN;
	for (int s = 0; s < shade->skies.tried; s++)
		shade->tried[s] = s;
}

void shade_set(struct shade *shade, const struct encode_settings *settings,
	       const struct part *parts, int count)
{
	const size_t sky = 3 * (size_t)settings->lights;
	float *to = shade->skies.radiance + (size_t)shade->common->tried * sky;
	int object = -1, shadow = -1;

	for (int k = 0; k < count; k++)
		if (parts[k].kind == BASIS_KIND_T)
			object = darkest_cell(&parts[k], settings->lights);
		else if (parts[k].kind != BASIS_KIND_U)
			shadow = darkest_cell(&parts[k], settings->lights);
	object = object >= 0 ? object : shadow;
	shadow = shadow >= 0 ? shadow : object;
	for (int k = 0; k < OWN && object >= 0; k++)
		ensemble_sun(settings->light, settings->lights, k % 2 ? shadow : object,
			     sizes[k / 2], to + (size_t)k * sky);
}

void shade_try(struct shade *shade, int sky)
{
	shade->tried[shade->skies.tried++] = sky;
}
