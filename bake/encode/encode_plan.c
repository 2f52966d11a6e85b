/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_plan.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

#include "bake/base/profile.h"
#include "hal/basis/basis_layout.h"

/* What a block costs a frame besides its bytes, in bytes: some 150 ns at 10 GB/s. */
#define BLOCK_COST 1500

int encode_plan_blocks(const struct encode_plan *plan, struct encode_plan_block *blocks)
{
	int count = 0;

	for (int colour = 0; colour < 2; colour++) {
		const int first = colour ? COLUMN_COLOUR8 : COLUMN_MONO8;
		const int end = colour ? COLUMN_FORMS : COLUMN_COLOUR8;
		int patterns = colour ? plan->colour_rank : plan->mono_rank;

		for (int form = first; form < end; form++) {
			if (!plan->columns[form])
				continue;
			blocks[count++] = (struct encode_plan_block){
				.mono = !colour,
				.patterns = patterns,
				.bits = column_most((enum column_form)form) == INT8_MAX ? 8 : 16,
				.form = (enum column_form)form,
				.columns = plan->columns[form],
			};
			patterns = 0;
		}
		if (patterns)
			blocks[count++] = (struct encode_plan_block){
				.mono = !colour, .patterns = patterns, .bits = 16};
	}
	return count;
}

uint32_t encode_plan_record_bytes(const struct encode_plan *plan,
				  const struct encode_plan_block *block)
{
	return block->bits == 8 ? (uint32_t)plan->column_bytes[block->form] : 0;
}

static void count_bytes(const struct search *s, const struct split *split, struct encode_plan *plan)
{
	struct encode_plan_block blocks[PLAN_BLOCKS_MAX];
	const int count = encode_plan_blocks(plan, blocks);

	plan->bytes = plan->pattern_bytes = 0;
	plan->blocks = count;
	for (int k = 0; k < count; k++) {
		const struct basis_block_entry entry = {
			.pixels = (uint16_t)split->part->kept,
			.channels = blocks[k].mono ? 1 : 3,
			.bits = (uint8_t)blocks[k].bits,
			.tinted = blocks[k].mono && split->tinted,
			.patterns = (uint16_t)blocks[k].patterns,
			.columns = (uint32_t)blocks[k].columns,
			.record_bytes = encode_plan_record_bytes(plan, &blocks[k]),
		};
		const struct basis_layout at = basis_layout(&entry, s->settings->coarse);

		plan->bytes += at.bytes;
		plan->pattern_bytes += at.light - at.pattern;
	}
}

/* U may come out as 0, not less: the quotient's sign is that of a shadow. */
static bool would_be_negative(const struct part *part, int light, const float *left)
{
	const float *value = part->value + (size_t)light * (size_t)part->rows;
	float least = 0, most = 0;

	if (part->kind != BASIS_KIND_U)
		return false;
	for (int r = 0; r < part->rows; r++) {
		least = smaller(least, value[r] - left[r]);
		most = larger(most, value[r]);
	}
	return least < -most / 254;
}

int search_light(const struct split *split, int light, float *left,
		 struct split_column column[LIGHT_COLUMNS_MAX])
{
	split_left(split, light, left);
	if (part_cell_holds(split->part, light, left) &&
	    !would_be_negative(split->part, light, left))
		return 0;
	return split_find_columns(split, light, left, column);
}

/* A light's columns go to its group. */
static void join_group(struct search *s, const struct part *part, int light,
		       const struct split_column *column, int columns)
{
	const int count = column_channels(column->form) * part->pixels;
	struct found_group *group;
	float *value, share;

	if (!part->share)
		return;
	group = &s->group[column_channels(column->form) == 3][s->settings->groups->of[light]];
	if (!group->columns) {
		*group = (struct found_group){
			.value = (size_t)s->found_groups++ * (size_t)part->rows, .number = -1};
		memset(s->group_value + group->value, 0, (size_t)count * sizeof(*value));
	}
	share = (float)part->share[light];
	value = s->group_value + group->value;
	group->columns++;
	group->reach += (double)(share * column->scale) * column_most(column->form);
	for (int n = 0; n < columns; n++)
		for (int k = 0; k < count; k++)
			value[k] += share * column[n].scale * (float)column[n].value[k];
}

static void find_columns(struct search *s, const struct split *split)
{
	const struct part *part = split->part;

	s->used_columns = s->found_groups = 0;
	for (int k = 0; k < 2; k++)
		memset(s->group[k], 0, (size_t)s->settings->groups->count * sizeof(*s->group[k]));
	for (int i = 0; i < s->settings->lights; i++) {
		float *left = s->column_left + (size_t)s->used_columns * (size_t)part->rows;
		struct split_column column[LIGHT_COLUMNS_MAX];
		const int columns = search_light(split, i, left, column);

		for (int n = 0; n < columns; n++)
			s->found[s->used_columns++] = (struct found_column){
				i, column[n].form,
				(double)column[n].scale * column_most(column[n].form),
				column[n].bytes, n > 0};
		if (columns)
			join_group(s, part, i, column, columns);
	}
}

void search_group(const struct search *s, const struct split *split, bool colour, int k,
		  struct split_column *column)
{
	const enum column_form narrow = colour ? COLUMN_COLOUR8 : COLUMN_MONO8;
	const enum column_form wide = colour ? COLUMN_COLOUR16 : COLUMN_MONO16;
	const struct found_group *group = &s->group[colour][k];
	/* What nearly all lights of a tile are off by together its groups have to put right. */
	const double reach = split->part->fine < 1 ? group->reach : 0;
	const float *value = s->group_value + group->value;

	column->form = split->wide[colour] ? wide : narrow;
	split_take_column(split, value, reach, column);
	if (column->form == narrow && (double)column->scale * INT8_MAX > FOUND_GROUP_NARROW) {
		column->form = wide;
		split_take_column(split, value, reach, column);
	}
}

/* Those of groups follow the lights'. Returns how many there are of both. */
static int find_groups(struct search *s, const struct split *split)
{
	const int groups = split->part->share ? s->settings->groups->count : 0;
	int count = s->used_columns;

	for (int colour = 0; colour < 2; colour++)
		for (int k = 0; k < groups; k++) {
			struct found_group *group = &s->group[colour][k];
			struct split_column column;

			if (group->columns < FOUND_GROUP_COLUMNS ||
			    group->reach < FOUND_GROUP_REACH)
				continue;
			search_group(s, split, colour, k, &column);
			group->number = count;
			s->found[count++] = (struct found_column){
				s->settings->lights + k, column.form,
				(double)column.scale * column_most(column.form), column.bytes,
				false};
		}
	return count;
}

static bool is_used(double cut, const float x[3], const struct found_column *column)
{
	const float most = larger(larger(fabsf(x[0]), fabsf(x[1])), fabsf(x[2]));

	return (double)most * column->reach >= cut;
}

/* How much of a light under a sky its column, and that of its group, put right: read gains what is
 * read for it. */
static void use_column(const struct search *s, const struct part *part, size_t sky,
		       const struct found_column *column, float used[3], double *read)
{
	const struct basis_groups *groups = s->settings->groups;
	const size_t n = (size_t)s->settings->lights, light = (size_t)column->number;
	const struct found_group *group = NULL;
	float x[3];

	for (size_t c = 0; c < 3; c++) {
		x[c] = part->sky_x[(sky * 3 + c) * n + light];
		used[c] = 0;
	}
	if (part->share)
		group = &s->group[column_channels(column->form) == 3][groups->of[light]];
	if (group && group->number >= 0) {
		const float *row = part->sky_even + sky * 3 * (size_t)groups->count +
				   groups->of[light];
		const float even[3] = {row[0], row[groups->count], row[2 * groups->count]};
		const struct found_column *all = &s->found[group->number];
		const bool in = is_used(part->group_cut, even, all);

		for (int c = 0; c < 3; c++) {
			const float common = (float)part->share[light] * even[c];

			x[c] -= common;
			used[c] = in ? common : 0;
		}
		*read += in && !column->second ? (double)all->bytes / group->columns : 0;
	}
	if (!is_used(part->column_cut, x, column))
		return;
	for (int c = 0; c < 3; c++)
		used[c] += x[c];
	*read += (double)column->bytes;
}

/* The skies' light on what patterns leave goes, as far as columns are used, to what these leave;
 * and from there, where there is a second one, to what that leaves. */
static double use_columns(struct search *s, const struct part *part)
{
	const size_t n = (size_t)s->settings->lights, most = (size_t)s->most_columns;
	const size_t skies = (size_t)s->settings->ensemble->tried;
	double read = 0;

	memcpy(s->sky_x, part->sky_x, skies * 3 * n * sizeof(*s->sky_x));
	for (size_t k = 0; k < skies; k++)
		for (size_t number = 0; number < (size_t)s->used_columns; number++) {
			const struct found_column *column = &s->found[number];
			float used[3];

			use_column(s, part, k, column, used, &read);
			for (size_t c = 0; c < 3; c++) {
				float *x = s->column_x + (k * 3 + c) * most + number;

				x[0] = used[c];
				x = column->second
					    ? x - 1
					    : s->sky_x + (k * 3 + c) * n + (size_t)column->number;
				*x -= used[c];
			}
		}
	return read / (double)skies;
}

static void choose_columns(struct search *s, const struct split *split, struct encode_plan *plan)
{
	int count;

	find_columns(s, split);
	count = find_groups(s, split);
	memset(plan->columns, 0, sizeof(plan->columns));
	memset(plan->column_bytes, 0, sizeof(plan->column_bytes));
	for (int k = 0; k < count; k++) {
		plan->columns[s->found[k].form]++;
		plan->column_bytes[s->found[k].form] += s->found[k].bytes;
	}
	plan->read = use_columns(s, split->part);
}

/* What the skies' light makes of what is left. */
static void sum_left(struct search *s, const struct split *split)
{
	const struct part *part = split->part;
	const int n = s->settings->lights, skies = s->settings->ensemble->tried;
	const int pixels = part->pixels, most = s->most_columns;

	for (int c = 0; c < 3; c++) {
		float *to = s->sky_sum + c * pixels;
		const float *x = s->sky_x + (size_t)c * (size_t)n;

		if (split->colour)
			cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, pixels, n, 1,
				    x, 3 * n, split->colour_left + c * pixels, 3 * pixels, 0, to,
				    3 * pixels);
		if (split->mono)
			cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, pixels, n, 1,
				    x, 3 * n, split->mono_left, pixels, 0, s->sky_mono, pixels);
		for (int k = 0; split->mono && k < skies; k++)
			for (int p = 0; p < pixels; p++) {
				const float by = split->tint_share[c][p] *
						 s->sky_mono[k * pixels + p];

				to[k * 3 * pixels + p] = split->colour ? to[k * 3 * pixels + p] + by
								       : by;
			}
		if (s->used_columns)
			cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, pixels,
				    s->used_columns, 1, s->column_x + (size_t)c * (size_t)most,
				    3 * most,
				    s->column_left + (part->channels == 3 ? c * pixels : 0),
				    part->rows, 1, to, 3 * pixels);
	}
}

static double excess_of(struct search *s, const struct split *split)
{
	const struct part *part = split->part;
	double worst_square = 0;
	float worst = 0;

	sum_left(s, split);
	for (int k = 0; k < s->settings->ensemble->tried; k++) {
		double square = 0;

		for (int r = 0; r < 3 * part->pixels; r++) {
			const int c = r / part->pixels, p = r % part->pixels;
			const int at = k * 3 * part->pixels + r;
			const float is = part->sky_offset[k][c] +
					 part->sky_slope[k][c] * part->sky_base[at];
			const float by = part->sky_slope[k][c] * s->sky_sum[at];
			const float levels =
				fabsf(levels_at(s->levels, is) - levels_at(s->levels, is - by));

			square += (double)(levels * levels);
			if (levels > worst * part->sky_share[p])
				worst = levels / part->sky_share[p];
		}
		worst_square = fmax(worst_square, square);
	}
	return fmax(sqrt(worst_square / (3 * part->pixels)) / s->target.rms,
		    (double)worst / s->target.max);
}

double encode_plan_cost(const struct encode_plan *plan)
{
	return (double)plan->bytes + (double)plan->pattern_bytes + plan->read +
	       BLOCK_COST * plan->blocks;
}

bool encode_plan_better(const struct encode_plan *a, const struct encode_plan *b)
{
	if ((a->excess <= 1) != (b->excess <= 1))
		return a->excess <= 1;
	return a->excess <= 1 ? encode_plan_cost(a) < encode_plan_cost(b) : a->excess < b->excess;
}

void encode_plan_evaluate(struct search *s, struct split *split, int mono_rank, int colour_rank,
			  const struct encode_plan *best, struct encode_plan *plan)
{
	profile_enter(PROFILE_BASIS);
	split_set_ranks(split, s->settings->lights, mono_rank, colour_rank);
	profile_enter(PROFILE_COLUMNS);
	plan->way = split->way;
	plan->mono_rank = split->mono ? split->mono_rank : 0;
	plan->colour_rank = split->colour ? split->colour_rank : 0;
	choose_columns(s, split, plan);
	count_bytes(s, split, plan);
	/* The skies take longest, and do not matter where it is dearer anyway. */
	profile_enter(PROFILE_SKIES);
	plan->excess = INFINITY;
	if (!best || best->excess > 1 || encode_plan_cost(plan) < encode_plan_cost(best))
		plan->excess = excess_of(s, split);
}
