#include "hal/compositor/column_choice.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_lines.h"

/* Columns of a light lie in classes by what they reach, 16 for each power of two, and in a class as
 * they come. So none that follows one reaches farther by as much as 1 / CLASS_NEAR. */
#define CLASS_SHIFT 19
#define CLASSES (1 << (31 - CLASS_SHIFT))
#define CLASS_NEAR 0.9

static uint32_t place_of(const struct basis_block *b, int n)
{
	return b->bits == 8 ? b->record_at[n] : (uint32_t)n;
}

static uint32_t bytes_of(const struct basis_block *b, int n)
{
	if (b->bits != 8)
		return 0;
	return (uint32_t)basis_record_bytes(b->record + b->record_at[n],
					    basis_record_lines(b->pixels, b->channels));
}

static float reach_of(const struct block_plan *plan, int n)
{
	return plan->block->column_scale[n] * plan->reach;
}

/* The farthest first. Of floats without a sign the bits ascend like the numbers. */
static uint32_t class_of(float reach)
{
	uint32_t bits;

	reach = fabsf(reach); /* -0 */
	memcpy(&bits, &reach, sizeof(bits));
	return CLASSES - 1 - (bits >> CLASS_SHIFT);
}

/* ---- once ---- */

/* Blocks that choose get their numbers. Returns how many columns they have. */
static size_t number_blocks(struct column_choice *choice, struct block_plan *plan, int count,
			    enum basis_kind kind, int ground)
{
	size_t columns = 0;

	for (int n = 0; n < count; n++) {
		const struct basis_block *b = plan[n].block;

		if (b->kind != kind || b->ground != ground || !b->columns)
			continue;
		plan[n].choice = choice;
		plan[n].number = choice->blocks++;
		columns += (size_t)b->columns;
	}
	return columns;
}

/* Counts become places. */
static void add_up(uint32_t *counts, size_t count)
{
	uint32_t sum = 0;

	for (size_t k = 0; k < count; k++) {
		const uint32_t own = counts[k];

		counts[k] = sum;
		sum += own;
	}
}

/* A column and the light whose it is, while they are sorted. */
struct loose_column {
	struct light_column column;
	uint32_t light;
};

/* All columns by classes. place: [CLASSES]. */
static void sort_by_class(const struct column_choice *choice, const struct block_plan *plan,
			  int count, uint32_t *place, struct loose_column *to)
{
	memset(place, 0, sizeof(*place) * CLASSES);
	for (int k = 0; k < count; k++)
		for (int n = 0; plan[k].choice == choice && n < plan[k].block->columns; n++)
			place[class_of(reach_of(&plan[k], n))]++;
	add_up(place, CLASSES);
	for (int k = 0; k < count; k++) {
		const struct basis_block *b = plan[k].block;

		if (plan[k].choice != choice)
			continue;
		choice->block[1 + plan[k].number].reach = plan[k].reach;
		for (int n = 0; n < b->columns; n++)
			to[place[class_of(reach_of(&plan[k], n))]++] =
				(struct loose_column){{b->column_scale[n], (uint32_t)plan[k].number,
						       place_of(b, n), bytes_of(b, n)},
						      b->light[n]};
	}
}

/* And these by lights. place: [lights + 1]. */
static void sort_by_light(const struct column_choice *choice, const struct loose_column *from,
			  size_t columns, uint32_t *place)
{
	memset(place, 0, sizeof(*place) * ((size_t)choice->lights + 1));
	for (size_t k = 0; k < columns; k++) {
		const float reach = from[k].column.scale *
				    choice->block[1 + from[k].column.block].reach;
		struct light_columns *light = &choice->light[from[k].light];

		light->most = reach > light->most ? reach : light->most;
		place[from[k].light]++;
	}
	add_up(place, (size_t)choice->lights + 1);
	for (int i = 0; i <= choice->lights; i++)
		choice->light[i].first = place[i];
	for (size_t k = 0; k < columns; k++)
		choice->column[place[from[k].light]++] = from[k].column;
}

int column_choice_create(struct column_choice *choice, struct block_plan *plan, int count,
			 enum basis_kind kind, int ground, int lights)
{
	const size_t n = (size_t)lights + 1;
	struct loose_column *loose;
	uint32_t *place;
	size_t columns;
	int ret = -ENOMEM;

	*choice = (struct column_choice){.lights = lights};
	columns = number_blocks(choice, plan, count, kind, ground);
	loose = malloc((columns + 1) * sizeof(*loose));
	place = malloc((n > CLASSES ? n : CLASSES) * sizeof(*place));
	choice->light = calloc(n, sizeof(*choice->light));
	choice->block = calloc((size_t)choice->blocks + 1, sizeof(*choice->block));
	choice->column = malloc((columns + 1) * sizeof(*choice->column));
	/* As large as it can be needed; only what is used takes memory. */
	choice->chosen = malloc((columns + 1) * sizeof(*choice->chosen));
	if (loose && place && choice->light && choice->block && choice->column && choice->chosen &&
	    columns <= UINT32_MAX) {
		sort_by_class(choice, plan, count, place, loose);
		sort_by_light(choice, loose, columns, place);
		ret = 0;
	}
	free(loose);
	free(place);
	return ret;
}

void column_choice_free(struct column_choice *choice)
{
	free(choice->light);
	free(choice->block);
	free(choice->column);
	free(choice->chosen);
	*choice = (struct column_choice){.light = NULL};
}

/* ---- in each frame ---- */

/* Lists are long, and begin anew for each light before the processor has found out that it reads
 * one: of a light that comes so much later so many cache lines are asked for. */
#define LISTS_AHEAD 4
#define LIST_LINES 3

static inline __attribute__((always_inline)) void fetch_list(const struct column_choice *choice,
							     int light)
{
	const char *list = (const char *)&choice->column[choice->light[light].first];

	for (int k = 0; k < LIST_LINES; k++)
		__builtin_prefetch(list + k * KERNEL_LINE_BYTES);
}

/*
 * Meets each column that counts, light by light, so that those of a block come in their order: each
 * adds to its block's end, and is put there, if `placing`. What lies below the normal floats is in
 * no class by what it reaches.
 */
static inline __attribute__((always_inline)) void meet(const struct column_choice *choice,
						       const struct light_sent *sent, bool placing)
{
	struct chosen_column *const chosen = choice->chosen;
	struct choosing_block *const block = choice->block + 1;

	for (int i = 0; i < choice->lights; i++) {
		const struct light_columns *light = &choice->light[i];
		const double strength = sent[i].strength;

		if (!placing && i + LISTS_AHEAD < choice->lights)
			fetch_list(choice, i + LISTS_AHEAD);
		if (strength * (double)light->most < 1)
			continue;
		for (uint32_t k = light->first; k < light[1].first; k++) {
			const struct light_column of = choice->column[k];
			struct choosing_block *b = &block[of.block];
			const float reach = of.scale * b->reach;
			const double worth = strength * (double)reach;

			if (worth < CLASS_NEAR && reach >= FLT_MIN)
				break;
			if (placing && worth >= 1)
				chosen[b->end] = (struct chosen_column){
					of.place, (uint16_t)i, (uint16_t)of.bytes, of.scale};
			b->end += worth >= 1;
		}
	}
}

void column_choice_make(struct column_choice *choice, const struct light_vector *light)
{
	uint32_t sum = 0;

	for (int n = 0; n <= choice->blocks; n++)
		choice->block[n].end = 0;
	meet(choice, light->sent, false);
	for (int n = 1; n <= choice->blocks; n++) {
		const uint32_t own = choice->block[n].end;

		choice->block[n].end = sum;
		sum += own;
	}
	meet(choice, light->sent, true);
	choice->left_out = (int)(choice->light[choice->lights].first - sum);
}
