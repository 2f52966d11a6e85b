/* SPDX-License-Identifier: MIT */
#include "bake/sky/sky_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/sky/fine_list.h"
#include "hal/base/output.h"
#include "hal/optics/vec.h"

#define WORTH 0.0005 /* rad by which a part must lessen how far light is moved */
#define MARGIN 0.5   /* radius of a part, in cells: light at a border needs both sides */

struct sky_step {
	int cell, level;
};

struct sky_choice {
	const struct sky_need *need;
	int *level;	       /* [cell]: chosen */
	struct sky_step *step; /* [cells * SKY_LEVELS]: the best first */
};

/* Finds the cell and level that are worth the most for each light. Returns the cell; -1: none is
 * worth it. */
static int choice_best(const struct sky_choice *choice, int *level)
{
	double most = 0;
	int best = -1;

	for (int i = 0; i < choice->need->level[0].count; i++)
		for (int l = choice->level[i] + 1; l < choice->need->levels; l++) {
			const double gain = choice->need->moved[i][choice->level[i]] -
					    choice->need->moved[i][l];
			const double lights = ldexp(1, 2 * l) - ldexp(1, 2 * choice->level[i]);

			if (gain < WORTH || gain / lights <= most)
				continue;
			most = gain / lights;
			best = i;
			*level = l;
		}
	return best;
}

/* The middle of the light of a cell, which is in the cell. */
static void cell_middle(const struct sky_need *need, int cell, double middle[3])
{
	const struct dome *last = sky_need_pieces(need);

	middle[0] = middle[1] = middle[2] = 0;
	for (int i = 0; i < last->count; i++)
		for (int k = 0; k < 3 && need->cell[0][i] == cell; k++)
			middle[k] += need->share[i] * last->direction[i][k];
	vec_normalize(middle);
}

static void list_parts(struct sky_parts *parts, const struct sky_choice *choice)
{
	parts->count = 0;
	for (int i = 0; i < choice->need->level[0].count; i++) {
		struct dome_fine *const part = &parts->part[parts->count];

		if (!choice->level[i])
			continue;
		part->frequency = choice->need->level[choice->level[i]].frequency;
		part->radius_rad = MARGIN * SKY_SPACING_RAD / part->frequency;
		cell_middle(choice->need, i, part->direction);
		parts->count++;
	}
}

/* Counts the lights of the dome that is chosen. Creating it takes most of the time. */
static int choice_count(struct sky_parts *parts, const struct sky_choice *choice, int *lights,
			struct fault *fault)
{
	const struct dome *base = &choice->need->level[0];
	struct dome dome;
	int err, wrong;

	list_parts(parts, choice);
	err = dome_create_fine(&dome, base->frequency, parts->part, parts->count, &wrong, fault);
	*lights = err ? 0 : dome.count;
	if (!err)
		dome_free(&dome);
	return err;
}

/* Makes the first steps of a choice. */
static void choice_take(struct sky_choice *choice, int steps)
{
	memset(choice->level, 0, (size_t)choice->need->level[0].count * sizeof(*choice->level));
	for (int k = 0; k < steps; k++)
		choice->level[choice->step[k].cell] = choice->step[k].level;
}

/* Divides cells, the best first, as long as the lights suffice. The steps do not depend on their
 * limit, so that halving finds the last one that fits. */
static int choice_run(struct sky_parts *parts, struct sky_choice *choice, int most,
		      struct fault *fault)
{
	int fits = 0, steps = 0, cell, level = 0, lights, err;

	for (; (cell = choice_best(choice, &level)) >= 0; steps++) {
		choice->level[cell] = level;
		choice->step[steps] = (struct sky_step){.cell = cell, .level = level};
	}
	for (int low = 0, high = steps, at = high; low <= high; at = (low + high) / 2) {
		choice_take(choice, at);
		err = choice_count(parts, choice, &lights, fault);
		if (err)
			return err;
		if (lights > most) {
			high = at - 1;
			continue;
		}
		low = at + 1;
		fits = at;
		parts->lights = lights;
	}
	choice_take(choice, fits);
	parts->limited = fits < steps;
	list_parts(parts, choice);
	return 0;
}

int sky_parts_choose(struct sky_parts *parts, const struct sky_need *need, int most,
		     struct fault *fault)
{
	const size_t cells = (size_t)need->level[0].count;
	struct sky_choice choice = {.need = need};
	int err = 0;

	*parts = (struct sky_parts){.lights = need->level[0].count};
	if (parts->lights > most)
		return fault_say(fault, -E2BIG,
				 "a dome of frequency %d alone has %d lights, more than %d",
				 need->level[0].frequency, parts->lights, most);
	parts->part = calloc(cells, sizeof(*parts->part));
	choice.level = calloc(cells, sizeof(*choice.level));
	choice.step = calloc(cells * SKY_LEVELS, sizeof(*choice.step));
	if (!parts->part || !choice.level || !choice.step)
		err = fault_say(fault, -ENOMEM, "not enough memory for the sky");
	if (!err)
		err = choice_run(parts, &choice, most, fault);
	free(choice.level);
	free(choice.step);
	if (err)
		sky_parts_free(parts);
	return err;
}

void sky_parts_free(struct sky_parts *parts)
{
	free(parts->part);
	*parts = (struct sky_parts){.count = 0};
}

int sky_parts_write(const struct sky_parts *parts, const struct sky_need *need, const char *what,
		    const char *path, struct fault *fault)
{
	struct output out;
	const int err = output_open(&out, path, fault);

	if (err)
		return err;
	fprintf(out.stream, "# %s: %d lights, with frequency %d elsewhere\n", what, parts->lights,
		need->level[0].frequency);
	for (int k = 0; k < parts->count; k++)
		fine_list_write(out.stream, &parts->part[k]);
	return output_commit(&out, fault);
}
