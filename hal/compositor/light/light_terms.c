/* SPDX-License-Identifier: MIT */
#include "hal/compositor/light/light_terms.h"

#include <errno.h>
#include <stdlib.h>

static double sum_in_parts(const double *value, int count)
{
	double part[LIGHT_PARTS] = {0};
	const int whole = count / LIGHT_PARTS * LIGHT_PARTS;

	for (int i = 0; i < count; i++)
		part[i < whole ? i % LIGHT_PARTS : 0] += value[i];
	return light_parts(part[0], part[1], part[2], part[3]);
}

/* Transposes P, from columns to rows: counting sort, filled from the end. */
static void turn_around(struct light_terms *t)
{
	const struct basis_coarse *gather = t->basis->coarse;

	for (int i = 0; i < t->lights; i++) {
		for (int j = 0; j < 3; j++)
			t->first[gather[i].index[j]] += gather[i].weight[j] > 0;
	}
	for (int k = 1; k <= t->coarse; k++)
		t->first[k] += t->first[k - 1];
	for (int i = t->lights - 1; i >= 0; i--) {
		for (int j = 0; j < 3; j++) {
			uint32_t *at = &t->first[gather[i].index[j]];

			if (!gather[i].weight[j])
				continue;
			--*at;
			t->light[*at] = (uint16_t)i;
			t->weight[*at] = gather[i].weight[j];
		}
	}
}

static int create_gather(struct light_terms *t)
{
	const size_t places = 3 * (size_t)t->lights;

	if (!t->basis->coarse)
		return 0;
	t->first = calloc((size_t)t->coarse + 1, sizeof(*t->first));
	t->light = calloc(places, sizeof(*t->light));
	t->weight = calloc(places, sizeof(*t->weight));
	if (!t->first || !t->light || !t->weight)
		return -ENOMEM;
	turn_around(t);
	return 0;
}

/* Computes q for each ground, and for T. */
static int create_shares(struct light_terms *t)
{
	const size_t n = (size_t)t->lights, grounds = t->basis->info.grounds;
	double *weight;

	if (basis_groups_create(&t->groups, t->basis->coarse, t->lights, t->coarse) < 0)
		return -ENOMEM;
	if (!t->groups.count)
		return 0;
	t->share = calloc((grounds + 1) * n, sizeof(*t->share));
	weight = calloc(n, sizeof(*weight));
	for (size_t g = 0; t->share && weight && g < grounds; g++) {
		for (size_t i = 0; i < n; i++)
			weight[i] = basis_ground(t->basis, (int)g, 0)[i] +
				    basis_ground(t->basis, (int)g, 1)[i] +
				    basis_ground(t->basis, (int)g, 2)[i];
		basis_groups_share(&t->groups, weight, t->share + g * n);
	}
	if (t->share && weight)
		basis_groups_share(&t->groups, t->solid_angle, t->share + grounds * n);
	free(weight);
	return t->share && weight ? 0 : -ENOMEM;
}

int light_terms_create(struct light_terms *t, const struct basis *basis)
{
	const int n = (int)basis->info.lights, grounds = (int)basis->info.grounds;

	*t = (struct light_terms){.basis = basis, .lights = n, .coarse = (int)basis->info.coarse};
	t->solid_angle = calloc((size_t)n, sizeof(*t->solid_angle));
	t->ground_sum = calloc((size_t)grounds + 1, sizeof(*t->ground_sum));
	if (!t->solid_angle || !t->ground_sum || create_gather(t) < 0) {
		light_terms_free(t);
		return -ENOMEM;
	}
	for (int i = 0; i < n; i++)
		t->solid_angle[i] = basis->lights[i].solid_angle_sr;
	if (create_shares(t) < 0) {
		light_terms_free(t);
		return -ENOMEM;
	}
	for (int g = 0; g < grounds; g++) {
		for (int c = 0; c < 3; c++)
			t->ground_sum[g][c] = sum_in_parts(basis_ground(basis, g, c), n);
	}
	return 0;
}

void light_terms_free(struct light_terms *t)
{
	free(t->solid_angle);
	free(t->ground_sum);
	basis_groups_free(&t->groups);
	free(t->share);
	free(t->first);
	free(t->light);
	free(t->weight);
	*t = (struct light_terms){0};
}
