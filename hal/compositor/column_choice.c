/* SPDX-License-Identifier: MIT */
#include "hal/compositor/column_choice.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_lines.h"

/* The columns of a light are sorted into classes by reach, 16 for each power of two, and unsorted
 * within a class. So for a column b after a column a, reach(b) < reach(a) / CLASS_NEAR. */
#define CLASS_SHIFT 19
#define CLASSES (1 << (31 - CLASS_SHIFT))
#define CLASS_NEAR 0.9

static uint32_t column_place(const struct basis_block *b, int n)
{
	return b->bits == 8 ? b->record_at[n] : (uint32_t)n;
}

static uint32_t column_bytes(const struct basis_block *b, int n)
{
	if (b->bits != 8)
		return 0;
	return (uint32_t)basis_record_bytes(b->record + b->record_at[n],
					    basis_record_lines(b->pixels, b->channels));
}

static float column_reach(const struct block_plan *plan, int n)
{
	return plan->block->column_scale[n] * plan->reach;
}

/* Returns the class of a reach; class 0 is the farthest. Bits of non-negative floats have the order
 * of the numbers. */
static uint32_t reach_class(float reach)
{
	uint32_t bits;

	reach = fabsf(reach); /* -0 */
	memcpy(&bits, &reach, sizeof(bits));
	return CLASSES - 1 - (bits >> CLASS_SHIFT);
}

/* ---- creation ---- */

/* Numbers the blocks that take part. Returns the number of their columns. */
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

static bool choice_has_groups(const struct column_choice *choice, const struct block_plan *plan,
			      int count)
{
	for (int n = 0; n < count; n++)
		if (plan[n].choice == choice && plan[n].grouped)
			return true;
	return false;
}

/* Exclusive prefix sum: turns counts into first places. */
static void counts_to_places(uint32_t *counts, size_t count)
{
	uint32_t sum = 0;

	for (size_t k = 0; k < count; k++) {
		const uint32_t own = counts[k];

		counts[k] = sum;
		sum += own;
	}
}

/* A column with its light, for sorting. */
struct loose_column {
	struct light_column column;
	uint32_t light;
};

/* Returns the index in light_vector.sent of the light of a column: X of a light; X - q S if its
 * group has a column in these blocks, too; S of a group; X of a lamp. grouped: [groups]. */
static uint32_t column_source(const struct light_terms *terms, const bool *grouped, int number)
{
	const struct basis_groups *groups = &terms->groups;
	const int lights = terms->lights, lamp = number - lights - terms->coarse;
	const bool beside = number >= lights || (groups->count && grouped[groups->of[number]]);

	if (lamp >= 0)
		return (uint32_t)(light_terms_lamp(terms) + lamp);
	return (uint32_t)(beside ? light_beside(lights, number) : number);
}

/* Scratch memory for sorting. */
struct sorting {
	struct loose_column *loose;
	uint32_t *place; /* [CLASSES], then [lights + 1] */
	bool *grouped;	 /* [groups]: the current blocks have a column of this group */
};

static int sorting_create(struct sorting *s, size_t columns, size_t lights,
			  const struct basis_groups *groups)
{
	s->loose = malloc((columns + 1) * sizeof(*s->loose));
	s->place = malloc((lights > CLASSES ? lights : CLASSES) * sizeof(*s->place));
	s->grouped = calloc((size_t)groups->count + 1, sizeof(*s->grouped));
	return s->loose && s->place && s->grouped ? 0 : -ENOMEM;
}

static void sorting_free(struct sorting *s)
{
	free(s->loose);
	free(s->place);
	free(s->grouped);
}

/* Marks the groups that have columns in these blocks; they come last in each block. */
static void mark_groups(const struct block_plan *plan, int count, int lights, bool mark,
			bool *grouped)
{
	for (int k = 0; k < count; k++) {
		const struct basis_block *b = plan[k].block;

		for (int n = b->columns; n && plan[k].grouped && b->light[n - 1] >= lights; n--)
			grouped[b->light[n - 1] - lights] = mark;
	}
}

static void sort_block(const struct column_choice *choice, const struct block_plan *plan,
		       const struct light_terms *terms, struct sorting *s)
{
	const struct basis_block *b = plan->block;

	choice->block[1 + plan->number].reach = plan->reach;
	for (int n = 0; n < b->columns; n++)
		s->loose[s->place[reach_class(column_reach(plan, n))]++] =
			(struct loose_column){{b->column_scale[n], (uint32_t)plan->number,
					       column_place(b, n), column_bytes(b, n)},
					      column_source(terms, s->grouped, b->light[n])};
}

/* Sorts all columns by class. */
static void sort_by_class(const struct column_choice *choice, const struct block_plan *plan,
			  int count, const struct light_terms *terms, struct sorting *s)
{
	uint32_t *place = s->place;

	memset(place, 0, sizeof(*place) * CLASSES);
	for (int k = 0; k < count; k++)
		for (int n = 0; plan[k].choice == choice && n < plan[k].block->columns; n++)
			place[reach_class(column_reach(&plan[k], n))]++;
	counts_to_places(place, CLASSES);
	for (int k = 0, next; k < count; k = next) {
		for (next = k + 1; next < count && plan[next].follows;)
			next++;
		mark_groups(plan + k, next - k, terms->lights, true, s->grouped);
		for (int n = k; n < next; n++)
			if (plan[n].choice == choice)
				sort_block(choice, &plan[n], terms, s);
		mark_groups(plan + k, next - k, terms->lights, false, s->grouped);
	}
}

/* Sorts the columns by light, and lists the lights that have columns. */
static void sort_by_light(struct column_choice *choice, const struct sorting *s, uint32_t lights,
			  size_t columns)
{
	const struct loose_column *from = s->loose;
	struct light_columns *to = choice->light;
	uint32_t *place = s->place;

	memset(place, 0, sizeof(*place) * ((size_t)lights + 1));
	for (size_t k = 0; k < columns; k++) {
		const float reach = from[k].column.scale *
				    choice->block[1 + from[k].column.block].reach;
		float *most = &to[from[k].light].most;

		*most = reach > *most ? reach : *most;
		place[from[k].light]++;
	}
	counts_to_places(place, (size_t)lights + 1);
	for (uint32_t i = 0; i < lights; i++)
		if (place[i] < place[i + 1])
			to[choice->lights++] = (struct light_columns){i, place[i], to[i].most};
	to[choice->lights].first = place[lights];
	for (size_t k = 0; k < columns; k++)
		choice->column[place[from[k].light]++] = from[k].column;
}

int column_choice_create(struct column_choice *choice, struct block_plan *plan, int count,
			 enum basis_kind kind, int ground, const struct light_terms *terms)
{
	struct sorting sorting;
	int lights = terms->lights, ret = -ENOMEM;
	size_t columns, n;

	*choice = (struct column_choice){.lights = 0};
	columns = number_blocks(choice, plan, count, kind, ground);
	if (terms->lamps || choice_has_groups(choice, plan, count))
		lights = light_terms_lamp(terms) + terms->lamps;
	n = (size_t)lights + 1;
	choice->light = calloc(n, sizeof(*choice->light));
	choice->block = calloc((size_t)choice->blocks + 1, sizeof(*choice->block));
	choice->column = malloc((columns + 1) * sizeof(*choice->column));
	/* The largest size; pages that are never touched take no memory. */
	choice->chosen = malloc((columns + 1) * sizeof(*choice->chosen));
	if (sorting_create(&sorting, columns, n, &terms->groups) == 0 && choice->light &&
	    choice->block && choice->column && choice->chosen && columns <= UINT32_MAX) {
		sort_by_class(choice, plan, count, terms, &sorting);
		sort_by_light(choice, &sorting, (uint32_t)lights, columns);
		ret = 0;
	}
	sorting_free(&sorting);
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

/* ---- each frame ---- */

/* Prefetch LIST_LINES cache lines of the list of the light LISTS_AHEAD later: few columns of each
 * list are read, too few for the processor's own prefetcher. */
#define LISTS_AHEAD 4
#define LIST_LINES 3

static inline __attribute__((always_inline)) void fetch_list(const struct column_choice *choice,
							     int n)
{
	const char *list = (const char *)&choice->column[choice->light[n].first];

	for (int k = 0; k < LIST_LINES; k++)
		__builtin_prefetch(list + k * KERNEL_LINE_BYTES);
}

/*
 * Visits each column that counts, light by light, and increments the end of its block; `placing`
 * also stores the column there. Denormal reaches have no useful class, so they do not end a list.
 */
static inline __attribute__((always_inline)) void
choice_meet(const struct column_choice *choice, const struct light_sent *sent, bool placing)
{
	struct chosen_column *const chosen = choice->chosen;
	struct choosing_block *const block = choice->block + 1;

	for (int n = 0; n < choice->lights; n++) {
		const struct light_columns *light = &choice->light[n];
		const double strength = sent[light->light].strength;

		if (!placing && n + LISTS_AHEAD < choice->lights)
			fetch_list(choice, n + LISTS_AHEAD);
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
				chosen[b->end] = (struct chosen_column){of.place, light->light,
									of.bytes, of.scale};
			b->end += worth >= 1;
		}
	}
}

void column_choice_make(struct column_choice *choice, const struct light_vector *light)
{
	uint32_t sum = 0;

	for (int n = 0; n <= choice->blocks; n++)
		choice->block[n].end = 0;
	choice_meet(choice, light->sent, false);
	for (int n = 1; n <= choice->blocks; n++) {
		const uint32_t own = choice->block[n].end;

		choice->block[n].end = sum;
		sum += own;
	}
	choice_meet(choice, light->sent, true);
	choice->left_out = (int)(choice->light[choice->lights].first - sum);
}
