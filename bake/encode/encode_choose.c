/* SPDX-License-Identifier: MIT */

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode/encode_parts.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

/* What halving a constant marked "Tuned" changes stands in README.md, "Constants". */

/* These ranks are tried: each is 1.3 to 2 times the one before it. */
static const int ranks[] = {0, 1, 2, 4, 6, 8, 12, 16, 24, 32, RANK_MOST};
#define RANKS ((int)(sizeof(ranks) / sizeof(*ranks)))
/* Both ranks begin here; all others are tried after it. */
#define FIRST_RANK 4
/* The second scan tries this many ranks of the list to either side of the best. Tuned. */
#define NEAR 2
/* A plan that costs less than this many bytes has no column. */
#define LEAST_COST 1
#define PANELS (PART_PIXELS / BASIS_LINE8)
/* A byte that a frame reads costs as much as this many bytes of the file. Tuned. */
#define READ_WEIGHT 2
/* A column has this many bytes besides its lines: light, scale, place, and codes of lines. */
#define COLUMN_BYTES 22
/* Estimates of what columns_find() makes of a line, whose largest value is `miss` times its limit:
 * up to LINE_ABSENT the line is mostly absent, up to LINE_HALF it mostly has half bytes. Tuned. */
#define LINE_ABSENT 0.6F
#define LINE_HALF 5
/* A column of one channel mostly suffices if its residual fills at most this share of the
 * limits. Tuned. */
#define MONO_LEAVES 0.9F
/* Shares of the cut are lowered by SHARE_STEP at a time, down to LEAST_SHARE. Tuned. */
#define LEAST_SHARE (1.0 / 4096)
#define SHARE_STEP 0.7
/* At this share of the cut no column is read that may be left out: no `use` is as large. */
#define NEVER 1e38
/* The slope of levels is the difference quotient over this step of linear light: three levels in
 * black, where a level is 1 / (12.92 * 255), and less elsewhere. */
#define LIGHT_STEP 0.001F

int choose_create(struct choose *s, const struct encode_settings *settings,
		  const struct levels *levels)
{
	const size_t n = (size_t)settings->lights, skies = (size_t)settings->ensemble->skies;

	*s = (struct choose){.settings = settings, .levels = levels};
	s->column = calloc(n, sizeof(*s->column));
	s->use = calloc(skies * n, sizeof(*s->use));
	for (int k = 0; k < 2; k++)
		s->group[k] = calloc((size_t)settings->groups->count + 1, sizeof(*s->group[k]));
	s->gain = calloc(skies * PART_ROWS, sizeof(*s->gain));
	s->mono_sky = calloc(skies * 3 * RANK_MOST, sizeof(*s->mono_sky));
	s->colour_sky = calloc(skies * 3 * RANK_MOST, sizeof(*s->colour_sky));
	return s->column && s->use && s->group[0] && s->group[1] && s->gain && s->mono_sky &&
			       s->colour_sky
		       ? 0
		       : -ENOMEM;
}

void choose_free(struct choose *s)
{
	free(s->column);
	free(s->use);
	free(s->group[0]);
	free(s->group[1]);
	free(s->gain);
	free(s->mono_sky);
	free(s->colour_sky);
	*s = (struct choose){.settings = NULL};
}

/* ---- columns ---- */

/* Returns the largest residual of a line as a multiple of its limit: max |left| tight. */
static float line_miss(const float *left, const float *tight, int count)
{
	float both[PART_ROWS];

	for (int k = 0; k < count; k++)
		both[k] = left[k] * tight[k];
	return part_magnitude(both, count);
}

/* A line of a column: the rows first..first + count - 1, of one channel in one panel. */
struct part_line {
	int first, count;
};

static struct part_line line_at(const struct part *part, int channel, int panel)
{
	const int p = panel * BASIS_LINE8, rest = part->pixels - p;

	return (struct part_line){channel * part->pixels + p,
				  rest < BASIS_LINE8 ? rest : BASIS_LINE8};
}

/* Estimates the bytes of a line whose largest residual is `miss` times its limit. */
static float line_estimate(float miss)
{
	return miss <= LINE_ABSENT ? 0 : miss <= LINE_HALF ? BASIS_LINE_HALF : BASIS_LINE8;
}

/* Tells whether a column of one channel suffices: its residual is within the limits. */
static bool mono_suffices(const struct low_rank *fit, const float *left, const float *tight)
{
	const struct part *part = fit->part;
	const int pixels = part->pixels;
	float one[PART_PIXELS], rest[PART_ROWS];

	if (!fit->mono || part->channels == 1)
		return fit->mono;
	fit_untint(fit, left, one);
	for (int c = 0; c < 3; c++)
		for (int p = 0; p < pixels; p++)
			rest[c * pixels + p] = left[c * pixels + p] -
					       fit->tint_share[c][p] * one[p];
	return line_miss(rest, tight, part->rows) <= MONO_LEAVES;
}

/* Estimates the bytes of a column of 8 bits, and of a second one if the steps of the first are too
 * coarse for the limits. miss: line_miss() of each channel and panel. */
static float estimate_bytes(const struct part *part, const float *left, const float *tight,
			    const struct estimate_column *column, float (*miss)[PANELS])
{
	const float half_step = column->reach / (2 * INT8_MAX);
	const int channels = column->mono ? 1 : part->channels;
	float first = COLUMN_BYTES, nearest = COLUMN_BYTES, second = COLUMN_BYTES;
	float most = 0;

	for (int k = 0; k < basis_panels8(part->pixels); k++)
		for (int c = 0; c < channels; c++) {
			float own = 0, rest = 0, steps = 0;

			/* A column of one channel has to satisfy the limits of all three. */
			for (int d = c; d < (column->mono ? part->channels : c + 1); d++) {
				const struct part_line at = line_at(part, d, k);

				own = larger(own, miss[d][k]);
				rest = larger(rest,
					      half_step * part_largest(tight + at.first, at.count));
				steps = larger(steps, part_magnitude(left + at.first, at.count) /
							      half_step);
			}
			most = larger(most, rest);
			first += line_estimate(own);
			second += line_estimate(rest);
			nearest += steps < 1 ? 0 : steps < 15 ? BASIS_LINE_HALF : BASIS_LINE8;
		}
	/* Half a step of 8 bits may be as large as the limit. */
	return most > 1 ? nearest + second : first;
}

/* Estimates the bytes of a light's column, or returns 0 if it needs none. */
static float estimate_light(const struct low_rank *fit, int light, struct estimate_column *column)
{
	const struct part *part = fit->part;
	const size_t first = (size_t)light * (size_t)part->rows;
	const float *left = fit->left + first, *tight = part->limit.tight + first;
	float miss[3][PANELS], most = 0;

	for (int c = 0; c < part->channels; c++)
		for (int k = 0; k < basis_panels8(part->pixels); k++) {
			const struct part_line at = line_at(part, c, k);

			miss[c][k] = line_miss(left + at.first, tight + at.first, at.count);
			most = larger(most, miss[c][k]);
		}
	if (most <= 1)
		return 0;
	column->reach = part_magnitude(left, part->rows);
	column->mono = mono_suffices(fit, left, tight);
	return estimate_bytes(part, left, tight, column, miss);
}

static double pattern_bytes(const struct choose *s, const struct part *part, bool mono, int rank)
{
	const struct basis_block_entry entry = {
		.pixels = (uint16_t)part->pixels,
		.channels = mono ? 1 : 3,
		.bits = 16,
		.patterns = (uint16_t)rank,
	};
	const struct basis_layout at = basis_layout(&entry, s->settings->coarse);

	return rank ? (double)(at.light - at.pattern) : 0;
}

/* Estimates the cost of a fit but for the columns that frames read, and lists its columns. It stops
 * where the cost reaches `bound`. */
static double estimate_cost(struct choose *s, struct low_rank *fit, double bound)
{
	double cost = (1 + READ_WEIGHT) * (pattern_bytes(s, fit->part, true, fit->mono_rank) +
					   pattern_bytes(s, fit->part, false, fit->colour_rank));

	s->columns = 0;
	for (int i = 0; i < s->settings->lights && cost < bound; i++) {
		struct estimate_column *column = &s->column[s->columns];

		column->light = i;
		column->bytes = estimate_light(fit, i, column);
		s->columns += column->bytes > 0;
		cost += (double)column->bytes;
	}
	return cost;
}

/* Sums the columns of each group's lights. */
static void find_groups(struct choose *s, const struct part *part)
{
	const struct basis_groups *groups = s->settings->groups;

	for (int k = 0; k < 2 && part->sky.share; k++)
		memset(s->group[k], 0, (size_t)groups->count * sizeof(*s->group[k]));
	for (int j = 0; j < s->columns && part->sky.share; j++) {
		const struct estimate_column *column = &s->column[j];
		struct estimate_group *group = &s->group[column->mono][groups->of[column->light]];

		group->columns++;
		group->reach += (float)part->sky.share[column->light] * column->reach;
		group->bytes += column->bytes;
	}
}

/* ---- skies ---- */

static float largest_of_three(const float x[3])
{
	return larger(larger(fabsf(x[0]), fabsf(x[1])), fabsf(x[2]));
}

/* Returns the group whose column would hold part of this one, or NULL if there is none. */
static const struct estimate_group *group_of(const struct choose *s, const struct part *part,
					     const struct estimate_column *column)
{
	const struct basis_groups *groups = s->settings->groups;
	const struct estimate_group *group;

	if (!part->sky.share)
		return NULL;
	group = &s->group[column->mono][groups->of[column->light]];
	return group->columns >= COLUMN_GROUP_LIGHTS ? group : NULL;
}

/* Computes a column's light under a sky: even = S of its group, 0 without one, and own = X - q
 * S. */
static void column_light(const struct choose *s, const struct part *part, int sky,
			 const struct estimate_column *column, float own[3], float even[3])
{
	const struct basis_groups *groups = s->settings->groups;
	const bool grouped = group_of(s, part, column);

	for (int c = 0; c < 3; c++) {
		const int row = sky * 3 + c;

		even[c] = grouped ? part->sky.even[row * groups->count + groups->of[column->light]]
				  : 0;
		own[c] = part->sky.x[row * s->settings->lights + column->light];
		own[c] -= grouped ? (float)part->sky.share[column->light] * even[c] : 0;
	}
}

/* Computes at which shares of the cut each column is read under each sky. */
static void find_uses(struct choose *s, const struct part *part)
{
	for (int t = 0; t < s->shade->skies.tried; t++)
		for (int j = 0; j < s->columns; j++) {
			const struct estimate_column *column = &s->column[j];
			const struct estimate_group *group = group_of(s, part, column);
			struct estimate_use *use = &s->use[t * s->settings->lights + j];
			float own[3], even[3];

			column_light(s, part, s->shade->tried[t], column, own, even);
			use->own = part->limit.column_cut > 0
					   ? largest_of_three(own) * column->reach /
						     (float)part->limit.column_cut
					   : 1;
			use->group = group ? largest_of_three(even) * group->reach /
						     (float)part->limit.group_cut
					   : 0;
		}
}

/* Returns the bytes of columns that a frame reads at this share of the cut, in the mean over the
 * skies. The column of a group of n lights counts as a mean column of theirs, 1 / n of it with each
 * of them. */
static double read_bytes(const struct choose *s, const struct part *part, double cut_share)
{
	const float is = (float)cut_share;
	double read = 0;

	for (int t = 0; t < s->shade->skies.tried; t++)
		for (int j = 0; j < s->columns; j++) {
			const struct estimate_use *use = &s->use[t * s->settings->lights + j];

			if (use->own >= is)
				read += (double)s->column[j].bytes;
			if (use->group >= is) {
				const struct estimate_group *group = group_of(s, part,
									      &s->column[j]);

				read += (double)(group->bytes /
						 (float)(group->columns * group->columns));
			}
		}
	return read / s->shade->skies.tried;
}

/* sum[c] -= by[c] * row, for each channel. */
static void subtract_row(const struct part *part, const float *row, const float by[3], float *sum)
{
	const int pixels = part->pixels;

	for (int c = 0; c < 3; c++) {
		const float *from = row + (part->channels == 3 ? c * pixels : 0);

		for (int p = 0; p < pixels; p++)
			sum[c * pixels + p] -= by[c] * from[p];
	}
}

static void subtract_patterns(const struct part *part, const float *rows, int rank,
			      const float (*light)[RANK_MOST], float *sum)
{
	for (int j = 0; j < rank; j++)
		subtract_row(part, rows + j * part->rows,
			     (float[]){light[0][j], light[1][j], light[2][j]}, sum);
}

/* Subtracts the columns that become active when the share of the cut falls from `before` to
 * `cut_share`. */
static void subtract_columns(const struct choose *s, const struct low_rank *fit, int t,
			     double before, double cut_share, float *sum)
{
	const float was = (float)before, is = (float)cut_share;

	for (int j = 0; j < s->columns; j++) {
		const struct estimate_use *use = &s->use[t * s->settings->lights + j];
		const bool more = use->own >= is && use->own < was;
		const bool more_group = use->group >= is && use->group < was;
		const int light = s->column[j].light;
		float own[3], even[3], by[3];

		if (!more && !more_group)
			continue;
		column_light(s, fit->part, s->shade->tried[t], &s->column[j], own, even);
		for (int c = 0; c < 3; c++)
			by[c] = (more ? own[c] : 0) +
				(more_group ? (float)fit->part->sky.share[light] * even[c] : 0);
		subtract_row(fit->part, fit_left(fit, light), by, sum);
	}
}

/* Returns the larger of RMS and largest error under a sky, as multiples of those asked for.
 * left: sum over lights of X times the residual, [3][pixels]. */
static double sky_excess(const struct choose *s, const struct part *part, int t, const float *left)
{
	const int rows = 3 * part->pixels;
	const float *gain = s->gain + t * rows;
	const double most = s->asked.max * encode_sky_most(s->settings, s->shade->tried[t]) /
			    s->settings->target.max;
	float by[PART_ROWS], lane[PART_PIXELS] = {0};
	double square = 0;

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++) {
			const int r = c * part->pixels + p;

			by[r] = gain[r] * left[r];
			lane[p] += by[r] * by[r];
		}
	for (int p = 0; p < part->pixels; p++)
		square += (double)lane[p];
	return fmax(sqrt(square / rows) / s->asked.rms, (double)part_magnitude(by, rows) / most);
}

/* Lowers the plan's share of the cut until a sky holds; returns the sky's excess. Skies that held
 * at a larger share are not checked again: with a smaller one more columns are read, and the
 * finished blocks are measured anyway. */
static double sky_lower_cut(const struct choose *s, const struct low_rank *fit, int t,
			    double *cut_share)
{
	const struct part *part = fit->part;
	const int sky = s->shade->tried[t];
	float left[PART_ROWS];
	double excess;

	memcpy(left, part->sky.value + (size_t)sky * 3 * (size_t)part->pixels,
	       3 * (size_t)part->pixels * sizeof(*left));
	subtract_patterns(part, fit->tinted_rows, fit->mono_rank,
			  (const float(*)[RANK_MOST])s->mono_sky + t * 3, left);
	subtract_patterns(part, fit->colour_patterns.coefficient, fit->colour_rank,
			  (const float(*)[RANK_MOST])s->colour_sky + t * 3, left);
	subtract_columns(s, fit, t, NEVER, *cut_share, left);
	while ((excess = sky_excess(s, part, t, left)) > 1 && *cut_share > LEAST_SHARE &&
	       part->limit.column_cut > 0) {
		subtract_columns(s, fit, t, *cut_share, *cut_share * SHARE_STEP, left);
		*cut_share *= SHARE_STEP;
	}
	return excess;
}

/* ---- plans ---- */

/* Estimates a plan with these ranks. It is given up, with an infinite excess, once its cost reaches
 * `bound`, or once a sky does not hold while another plan does (bound is finite). */
static struct rank_plan plan_estimate(struct choose *s, struct low_rank *fit, int mono, int colour,
				      double bound)
{
	const struct part *part = fit->part;
	struct rank_plan e = {.excess = INFINITY, .cut_share = part->limit.cut_share};
	double cost, worst = 0;

	fit_set_ranks(fit, mono, colour);
	e.mono_rank = fit->mono_rank;
	e.colour_rank = fit->colour_rank;
	e.cost = cost = estimate_cost(s, fit, bound);
	if (cost >= bound)
		return e;
	find_groups(s, part);
	find_uses(s, part);
	e.cost = cost + READ_WEIGHT * read_bytes(s, part, e.cut_share);
	for (int k = 0; k < s->shade->skies.tried && e.cost < bound; k++) {
		const double before = e.cut_share;
		const int t = s->order[k];

		worst = fmax(worst, sky_lower_cut(s, fit, t, &e.cut_share));
		if (worst > 1 && bound < INFINITY)
			return e;
		if (e.cut_share < before) {
			memmove(s->order + 1, s->order, (size_t)k * sizeof(*s->order));
			s->order[0] = t;
			e.cost = cost + READ_WEIGHT * read_bytes(s, part, e.cut_share);
		}
	}
	if (e.cost < bound)
		e.excess = worst;
	return e;
}

/* Among plans that hold, the cheaper one is better; else the one with less excess is. */
static bool plan_is_better(const struct rank_plan *a, const struct rank_plan *b)
{
	if ((a->excess <= 1) != (b->excess <= 1))
		return a->excess <= 1;
	return a->excess <= 1 ? a->cost < b->cost : a->excess < b->excess;
}

/* Replaces *best by better plans that differ from it in one of the two ranks, by at most `steps`
 * entries of the list. */
static void scan_rank(struct choose *s, struct low_rank *fit, bool mono, int steps,
		      struct rank_plan *best)
{
	const int found = mono ? fit->mono_patterns.count : fit->colour_patterns.count;
	const struct rank_plan from = *best;
	const int is = mono ? from.mono_rank : from.colour_rank;
	int at = 0;

	while (at + 1 < RANKS && ranks[at] < is)
		at++;
	for (int k = at > steps ? at - steps : 0; k < RANKS && k <= at + steps; k++) {
		const double bound = best->excess <= 1 ? best->cost : INFINITY;
		struct rank_plan e;

		if ((1 + READ_WEIGHT) * pattern_bytes(s, fit->part, mono, ranks[k]) >= bound)
			break;
		if (ranks[k] != is) {
			e = plan_estimate(s, fit, mono ? ranks[k] : from.mono_rank,
					  mono ? from.colour_rank : ranks[k], bound);
			if (plan_is_better(&e, best))
				*best = e;
		}
		if (ranks[k] >= found)
			break;
	}
}

/* Computes by how many levels each pixel changes per unit of the sum of X times residual. */
static void find_gains(struct choose *s, const struct part *part)
{
	const int pixels = part->pixels;

	for (int k = 0; k < 3 * s->shade->skies.tried; k++) {
		const int sky = s->shade->tried[k / 3], c = k % 3;
		const float slope = part->sky.slope[sky][c];
		const float *base = part->sky.base + (size_t)(sky * 3 + c) * (size_t)pixels;

		for (int p = 0; p < pixels; p++) {
			const float is = part->sky.offset[sky][c] + slope * base[p];
			const float steepness = levels_at(s->levels, is + LIGHT_STEP / 2) -
						levels_at(s->levels, is - LIGHT_STEP / 2);

			s->gain[k * pixels + p] = fabsf(slope) * steepness / LIGHT_STEP;
		}
	}
}

/* Computes y_j, the product of each tried sky's light and each pattern. */
static void sum_patterns(const struct choose *s, const struct part *part,
			 const struct rank_patterns *patterns, float *sum)
{
	const int n = s->settings->lights;

	for (int t = 0; t < s->shade->skies.tried && patterns->count; t++)
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, 3, patterns->count, n, 1,
			    part->sky.x + (size_t)s->shade->tried[t] * 3 * (size_t)n, n,
			    patterns->at_light, n, 0, sum + t * 3 * RANK_MOST, RANK_MOST);
}

int choose_ranks(struct choose *s, struct low_rank *fit, const struct shade *shade,
		 const struct encode_target *asked)
{
	struct rank_plan best;
	int err = 0, before;

	s->shade = shade;
	s->asked = *asked;
	for (int t = 0; t < shade->skies.tried; t++)
		s->order[t] = t;
	find_gains(s, fit->part);
	/* A part that is hardly seen needs neither patterns nor columns. */
	best = plan_estimate(s, fit, 0, 0, LEAST_COST);
	if (best.excess > 1) {
		if (!fit->found)
			err = fit_find(fit);
		if (err)
			return err;
		sum_patterns(s, fit->part, &fit->mono_patterns, s->mono_sky);
		sum_patterns(s, fit->part, &fit->colour_patterns, s->colour_sky);
		best = plan_estimate(s, fit, FIRST_RANK, FIRST_RANK, INFINITY);
		if (fit->colour)
			scan_rank(s, fit, false, RANKS, &best);
		before = best.mono_rank;
		if (fit->mono)
			scan_rank(s, fit, true, RANKS, &best);
		if (fit->mono && fit->colour && best.mono_rank != before) {
			scan_rank(s, fit, false, NEAR, &best);
			scan_rank(s, fit, true, NEAR, &best);
		}
	}
	fit_set_ranks(fit, best.mono_rank, best.colour_rank);
	fit->cut_share = best.cut_share;
	fit->excess = best.excess;
	return 0;
}
