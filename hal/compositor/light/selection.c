/* SPDX-License-Identifier: MIT */
#include "hal/compositor/light/selection.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/light/light_budget.h"

const char *const threshold_mode_names[] = {"ambient", "drop", NULL};

int light_selection_create(struct light_selection *selection, const struct basis *basis)
{
	const size_t n = basis->info.lights;

	*selection = (struct light_selection){.count = (int)n, .mirror_gain = {1, 1, 1}};
	selection->radiance = calloc(n, sizeof(*selection->radiance));
	selection->used = calloc(n, sizeof(*selection->used));
	selection->bound = calloc(n, sizeof(*selection->bound));
	selection->ground = calloc((size_t)basis->info.grounds + 1, sizeof(*selection->ground));
	if (!selection->radiance || !selection->used || !selection->bound || !selection->ground) {
		light_selection_free(selection);
		return -ENOMEM;
	}
	light_budget_grounds(basis, selection->ground);
	return 0;
}

void light_selection_free(struct light_selection *selection)
{
	free(selection->radiance);
	free(selection->used);
	free(selection->bound);
	free(selection->ground);
	*selection = (struct light_selection){0};
}

/* The bits of infinity. As unsigned integers, the bits of non-negative finite floats are smaller;
 * those of negative numbers, infinity and NaN are not. */
#define INFINITE UINT32_C(0x7f800000)

static void radiance_clean(double *restrict to, const float *restrict from, int count)
{
	for (int i = 0; i < count; i++) {
		uint32_t bits;
		float radiance;

		memcpy(&bits, &from[i], sizeof(bits));
		bits &= -(uint32_t)(bits < INFINITE);
		memcpy(&radiance, &bits, sizeof(radiance));
		to[i] = (double)radiance;
	}
}

static bool radiance_any(const double *radiance, int count)
{
	int k = 0;

	while (k < count && !(radiance[k] > 0))
		k++;
	return k < count;
}

static bool light_reaches(const double rgb[3], double least)
{
	const double warm = rgb[0] > rgb[1] ? rgb[0] : rgb[1];

	return (warm > rgb[2] ? warm : rgb[2]) >= least;
}

/* Sums over the dropped lights, by channels. */
struct dropped {
	double power[3]; /* w_i L_i */
	double lost[3];	 /* L_i peak_i */
};

static void use_bright(struct light_selection *selection, double threshold, double stays)
{
	for (int i = 0; i < selection->count; i++)
		selection->used[i] = light_reaches(selection->radiance[i],
						   selection->used[i] ? stays : threshold);
}

/* Sum of the bounds of the lights that are not used. */
static uint64_t sum_dropped(const struct light_selection *selection)
{
	uint64_t sum = 0;

	for (int i = 0; i < selection->count; i++)
		sum += selection->used[i] ? 0 : selection->bound[i];
	return sum;
}

static int count_dropped(const struct light_selection *selection)
{
	int count = 0;

	for (int i = 0; i < selection->count; i++)
		count += !selection->used[i];
	return count;
}

static void use_above(struct light_selection *selection, struct light_cut cut)
{
	for (int i = 0; i < selection->count; i++) {
		const bool at = selection->bound[i] == cut.bound;

		selection->used[i] = at ? cut.equal <= 0 : selection->bound[i] > cut.bound;
		cut.equal -= at;
	}
}

static void use_within_budget(struct light_selection *selection, bool again)
{
	const uint64_t room = (uint64_t)(fmin(selection->budget, 1) * (double)LIGHT_BUDGET_WHITE);
	struct light_cut cut;

	if (!again) {
		use_above(selection, light_budget_cut(selection->bound, selection->count, room));
		return;
	}
	cut = light_budget_cut(selection->bound, selection->count, room - room / 8);
	if (sum_dropped(selection) <= room && cut.count <= count_dropped(selection))
		return;
	use_above(selection,
		  light_budget_cut(selection->bound, selection->count, room - room / 16));
}

static struct dropped drop_unused(struct light_selection *selection, const struct basis *basis,
				  const float (*peak)[3])
{
	struct dropped all = {{0}, {0}};

	for (int i = 0; i < selection->count; i++) {
		double *rgb = selection->radiance[i];

		selection->used_count += selection->used[i];
		for (int c = 0; c < 3 && !selection->used[i]; c++) {
			all.power[c] += basis->lights[i].solid_angle_sr * rgb[c];
			all.lost[c] += rgb[c] * (double)peak[i][c];
			rgb[c] = 0;
		}
	}
	return all;
}

void light_selection_choose(struct light_selection *selection, const struct basis *basis, int pose,
			    const float (*radiance)[3], double threshold, enum threshold_mode mode,
			    double gain)
{
	const bool again = selection->lit && threshold == selection->threshold &&
			   mode == selection->mode && selection->budget == selection->last_budget;
	const double stays = again ? threshold - selection->band : threshold;
	const float(*peak)[3] = basis->poses[pose].peak;
	struct dropped dropped;

	selection->threshold = threshold;
	selection->mode = mode;
	selection->last_budget = selection->budget;
	selection->used_count = 0;
	radiance_clean(selection->radiance[0], radiance[0], 3 * selection->count);
	selection->lit = radiance_any(selection->radiance[0], 3 * selection->count);
	if (selection->budget > 0) {
		light_budget_bounds(basis, pose, (const double(*)[3])selection->ground,
				    (const double(*)[3])selection->radiance, mode, gain,
				    selection->bound);
		use_within_budget(selection, again);
	} else {
		use_bright(selection, threshold, stays);
	}
	dropped = drop_unused(selection, basis, peak);
	for (int c = 0; c < 3; c++) {
		const double ambient = mode == THRESHOLD_AMBIENT ? dropped.power[c] / (2 * M_PI)
								 : 0;
		const double added = ambient * (double)peak[selection->count][c];

		selection->ambient[c] = ambient;
		selection->dropped_error[c] = fmax(dropped.lost[c], added) * gain;
	}
}
