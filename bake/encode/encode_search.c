/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_search.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const int ranks[] = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, RANK_MOST};
#define RANKS ((int)(sizeof(ranks) / sizeof(*ranks)))
/* How often the two ranks are improved in turn, and from where. */
#define TURNS 2
#define FIRST_RANK 4
/* Ranks in a row that are worse than the best before a search gives up. */
#define PATIENCE 4
/* How often patterns are found again. */
#define ROUNDS 10
/* Three channels without a tint are tried where one light in so many has a hue of its own. */
#define HUE_SHARE 16
/* Shares of what may be left that short lines are tried with. */
#define SPENT_TRIED 3

int search_create(struct search *s, const struct encode_settings *settings,
		  const struct levels *levels)
{
	const size_t skies = (size_t)settings->ensemble->skies;

	*s = (struct search){.settings = settings, .levels = levels, .target = settings->target};
	s->most_columns = LIGHT_COLUMNS_MAX * settings->lights;
	s->column_x = calloc(skies * 3 * (size_t)s->most_columns, sizeof(*s->column_x));
	s->found = calloc((size_t)(s->most_columns + 2 * settings->groups->count),
			  sizeof(*s->found));
	for (int k = 0; k < 2; k++)
		s->group[k] = calloc((size_t)settings->groups->count + 1, sizeof(*s->group[k]));
	s->sky_x = calloc(skies * 3 * (size_t)settings->lights, sizeof(*s->sky_x));
	s->sky_sum = calloc(skies * PART_ROWS, sizeof(*s->sky_sum));
	s->sky_mono = calloc(skies * PART_PIXELS, sizeof(*s->sky_mono));
	s->weight = calloc((size_t)settings->lights, sizeof(*s->weight));
	s->next_weight = calloc((size_t)settings->lights, sizeof(*s->next_weight));
	s->miss = calloc((size_t)settings->lights, sizeof(*s->miss));
	return s->found && s->group[0] && s->group[1] && s->column_x && s->sky_x && s->sky_sum &&
			       s->sky_mono && s->weight && s->next_weight && s->miss
		       ? 0
		       : -ENOMEM;
}

void search_free(struct search *s)
{
	free(s->sky_x);
	free(s->column_x);
	free(s->column_left);
	free(s->group_value);
	free(s->found);
	free(s->group[0]);
	free(s->group[1]);
	free(s->sky_sum);
	free(s->sky_mono);
	free(s->weight);
	free(s->next_weight);
	free(s->miss);
	*s = (struct search){.settings = NULL};
}

static int search_reserve(struct search *s, const struct part *part)
{
	const size_t wanted = (size_t)s->most_columns * (size_t)part->rows;

	if (wanted <= s->left_room)
		return 0;
	free(s->column_left);
	free(s->group_value);
	s->left_room = 0;
	s->column_left = malloc(wanted * sizeof(*s->column_left));
	s->group_value = malloc(wanted * sizeof(*s->group_value));
	if (!s->column_left || !s->group_value)
		return -ENOMEM;
	s->left_room = wanted;
	return 0;
}

/* ---- ranks ---- */

static void try_rank(struct search *s, struct split *split, bool mono, int rank,
		     const struct encode_plan *best, struct encode_plan *plan)
{
	*plan = *best;
	encode_plan_evaluate(s, split, mono ? rank : best->mono_rank,
			     mono ? best->colour_rank : rank, best, plan);
}

/* Improves one of the two ranks, from first upwards. */
static void search_scan(struct search *s, struct split *split, bool mono, int first,
			struct encode_plan *best)
{
	const int found = mono ? split->mono_patterns.count : split->colour_patterns.count;
	int worse = 0;

	for (int k = 0; k < RANKS && worse < PATIENCE; k++) {
		struct encode_plan plan;

		if (ranks[k] < first)
			continue;
		try_rank(s, split, mono, ranks[k], best, &plan);
		if (encode_plan_better(&plan, best)) {
			*best = plan;
			worse = 0;
		} else if (best->excess <= 1 && encode_plan_cost(&plan) > encode_plan_cost(best)) {
			worse++;
		}
		if (ranks[k] >= found)
			break;
	}
}

/* The same from where it is, downwards, else upwards. */
static void search_climb(struct search *s, struct split *split, bool mono, struct encode_plan *best)
{
	const int found = mono ? split->mono_patterns.count : split->colour_patterns.count;
	const int from = mono ? best->mono_rank : best->colour_rank;
	bool moved = false;

	for (int step = -1; step <= 1 && !moved; step += 2) {
		int k = 0;

		while (k + 1 < RANKS && ranks[k] < from)
			k++;
		for (k += step; k >= 0 && k < RANKS && (step < 0 || ranks[k] <= found); k += step) {
			struct encode_plan plan;

			try_rank(s, split, mono, ranks[k], best, &plan);
			if (!encode_plan_better(&plan, best))
				break;
			*best = plan;
			moved = true;
		}
	}
}

static void scan_both(struct search *s, struct split *split, int first, struct encode_plan *own)
{
	for (int turn = 0; turn < TURNS; turn++) {
		const struct encode_plan before = *own;

		if (split->colour)
			search_scan(s, split, false, first, own);
		if (split->mono)
			search_scan(s, split, true, first, own);
		if (!encode_plan_better(own, &before) || !split->colour || !split->mono)
			break;
	}
}

static bool wants_more(const struct split *split, const struct encode_plan *plan)
{
	return (split->mono && plan->mono_rank >= RANK_FEW) ||
	       (split->colour && plan->colour_rank >= RANK_FEW) || plan->excess > 1;
}

static int search_way(struct search *s, struct split *split, const struct part *part,
		      enum split_way way, struct encode_plan *best)
{
	struct encode_plan own = {.most = RANK_FEW};
	int err = split_part(split, s->settings, part, way);

	if (!err)
		err = split_find(split, s->settings, part->weight, own.most);
	if (err)
		return err;
	encode_plan_evaluate(s, split, split->mono ? FIRST_RANK : 0, split->colour ? FIRST_RANK : 0,
			     NULL, &own);
	scan_both(s, split, 0, &own);
	if (wants_more(split, &own)) {
		own.most = RANK_MOST;
		err = split_find(split, s->settings, part->weight, own.most);
		if (err)
			return err;
		encode_plan_evaluate(s, split, own.mono_rank, own.colour_rank, NULL, &own);
		scan_both(s, split, own.excess > 1 ? 0 : RANK_FEW, &own);
	}
	if (encode_plan_better(&own, best))
		*best = own;
	return 0;
}

/* A tint does not do where many lights need columns of three channels. */
static bool hue_varies(const struct search *s, const struct encode_plan *best)
{
	const int coloured = best->columns[COLUMN_COLOUR8] + best->columns[COLUMN_COLOUR16];

	return best->excess > 1 || coloured * HUE_SHARE > s->settings->lights;
}

/* ---- lights that have columns anyway ---- */

/* How far the split's patterns miss each light. False: they miss none. */
static bool find_misses(struct search *s, const struct split *split)
{
	bool any = false;

	for (int i = 0; i < s->settings->lights; i++) {
		float left[PART_ROWS];

		split_left(split, i, left);
		s->miss[i] = part_cell_share(split->part, i, left);
		any |= s->miss[i] > 1;
	}
	return any;
}

/* Patterns for other weights, and ranks near the best plan's. */
static int find_again(struct search *s, struct split *split, const struct encode_plan *best,
		      struct encode_plan *plan)
{
	int err = split_find(split, s->settings, s->next_weight, best->most);

	if (err)
		return err;
	*plan = *best;
	encode_plan_evaluate(s, split, best->mono_rank, best->colour_rank, NULL, plan);
	if (split->colour)
		search_climb(s, split, false, plan);
	if (split->mono)
		search_climb(s, split, true, plan);
	return 0;
}

/* How lights count next, by how far they are missed. Those that are missed by far have columns
 * anyway, and patterns need not be spent on them; later those that are nearly met, or just so,
 * count more than those that are met well. */
static const struct reweighing {
	float far, far_by, near, near_by, well, well_by;
} reweighings[] = {
	{6, 0.05F, FLT_MAX, 1, 0, 1},
	{3, 0.01F, FLT_MAX, 1, 0, 1},
	{2.5F, 0.67F, 0.8F, 1.5F, 0.4F, 0.7F},
	{1.75F, 0.67F, 0.8F, 1.5F, 0.4F, 0.7F},
};
#define REWEIGHINGS ((int)(sizeof(reweighings) / sizeof(*reweighings)))

static float reweigh(const struct reweighing *by, float miss)
{
	return miss > by->far	 ? by->far_by
	       : miss > by->near ? by->near_by
	       : miss < by->well ? by->well_by
				 : 1;
}

/* Patterns again, for other weights, as long as that helps. */
static int search_refine(struct search *s, struct split *split, struct encode_plan *best)
{
	bool any = find_misses(s, split), stale = false;
	int how = 0, err = 0;

	for (int round = 0; round < ROUNDS && any && how < REWEIGHINGS && !err; round++) {
		float *weight = s->weight;
		struct encode_plan plan;

		for (int i = 0; i < s->settings->lights; i++)
			s->next_weight[i] = weight[i] * reweigh(&reweighings[how], s->miss[i]) +
					    FLT_EPSILON;
		err = find_again(s, split, best, &plan);
		stale = !err && !encode_plan_better(&plan, best);
		if (err || stale) {
			how++;
			continue;
		}
		*best = plan;
		s->weight = s->next_weight;
		s->next_weight = weight;
		split_set_ranks(split, s->settings->lights, plan.mono_rank, plan.colour_rank);
		any = find_misses(s, split);
	}
	return err || !stale ? err : split_find(split, s->settings, s->weight, best->most);
}

/* One flag of the split, if the plan is better with it. */
static void try_flag(struct search *s, struct split *split, bool *flag, struct encode_plan *best)
{
	struct encode_plan plan = *best;

	*flag = true;
	encode_plan_evaluate(s, split, best->mono_rank, best->colour_rank, best, &plan);
	*flag = encode_plan_better(&plan, best);
	if (*flag)
		*best = plan;
}

/* In weak light the first of two columns of 8 bits is all that is used: where lights are alike and
 * many, what these are off by adds up, and 16 bits may hold. And a few columns of 8 bits are not
 * worth a block apart from those of 16. */
static void search_widen(struct search *s, struct split *split, struct encode_plan *best)
{
	for (int k = 0; k < 2; k++) {
		const enum column_form narrow = k ? COLUMN_COLOUR8 : COLUMN_MONO8;
		const enum column_form rest = k ? COLUMN_COLOUR_REST : COLUMN_MONO_REST;
		const enum column_form wide = k ? COLUMN_COLOUR16 : COLUMN_MONO16;

		if (best->excess > 1 && best->columns[rest])
			try_flag(s, split, &split->whole[k], best);
		if (best->columns[narrow] && best->columns[wide])
			try_flag(s, split, &split->wide[k], best);
	}
}

/* How much short lines may use up: the more, the shorter they are; less where that does not hold.
 */
static void search_spend(struct search *s, struct split *split, struct encode_plan *best)
{
	static const float more[SPENT_TRIED] = {1, 0.8F, 0.65F},
			   less[SPENT_TRIED] = {0.35F, 0.2F, 0};
	const float *share = best->excess > 1 ? less : more;
	float found = split->spent;
	bool held = false;

	for (int k = 0; k < SPENT_TRIED && !held; k++) {
		struct encode_plan plan = *best;

		split->spent = share[k];
		encode_plan_evaluate(s, split, best->mono_rank, best->colour_rank, best, &plan);
		if (!encode_plan_better(&plan, best))
			continue;
		*best = plan;
		found = share[k];
		held = plan.excess <= 1;
	}
	split->spent = found;
}

int search_best(struct search *s, struct split *split, const struct part *part,
		struct encode_plan *best)
{
	int err = search_reserve(s, part);

	*best = (struct encode_plan){.excess = INFINITY};
	for (int way = 0; way < SPLIT_WAYS && !err; way++)
		if (split_possible(part, (enum split_way)way) &&
		    (way != SPLIT_PLAIN || hue_varies(s, best)))
			err = search_way(s, split, part, (enum split_way)way, best);
	memcpy(s->weight, part->weight, (size_t)s->settings->lights * sizeof(*s->weight));
	if (!err && split->way != best->way)
		err = split_part(split, s->settings, part, best->way);
	if (!err && split->most != best->most)
		err = split_find(split, s->settings, s->weight, best->most);
	if (err)
		return err;
	encode_plan_evaluate(s, split, best->mono_rank, best->colour_rank, NULL, best);
	err = search_refine(s, split, best);
	if (err)
		return err;
	search_widen(s, split, best);
	search_spend(s, split, best);
	encode_plan_evaluate(s, split, best->mono_rank, best->colour_rank, NULL, best);
	return 0;
}
