/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_choose.h"

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/profile.h"
#include "bake/encode/encode_column.h"
#include "bake/encode/encode_limit.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

/* The ranks that are tried. */
static const int ranks[] = {0, 1, 2, 4, 6, 8, 12, 16, 24, 32, RANK_MOST};
#define RANKS ((int)(sizeof(ranks) / sizeof(*ranks)))
#define FIRST_RANK 4
/* A second scan tries so many steps of the list to either side. */
#define NEAR 2
/* How much more a byte that a frame reads counts than one of the file. */
#define READ_WEIGHT 2
/* What a block costs a frame besides its bytes, in bytes: some 150 ns at 10 GB/s. */
#define BLOCK_COST 1500
/* Bytes of a column besides its lines. */
#define COLUMN_BYTES 22
/* Lines whose values are at most so many times their limits are mostly absent; of half bytes. */
#define LINE_ABSENT 0.6F
#define LINE_HALF 5
/* So many times its limit half a step of 8 bits mostly still does, as few values come near it. */
#define STEP_FINE 1
/* A column of one channel mostly does where it leaves so much of the limits. */
#define MONO_LEAVES 0.9F
/* The least share of the cut that is tried. */
#define LEAST_SHARE (1.0 / 4096)
#define SHARE_STEP 0.7
/* A share of the cut at which no column is read that could be left out. */
#define NEVER 1e38
/* Change of linear light over which the steepness of levels is taken. */
#define LIGHT_STEP 0.001F
/* Values side by side, as compilers do not take a maximum apart. */
#define LANES 8

int choose_create(struct choose *s, const struct encode_settings *settings,
		  const struct levels *levels)
{
	const size_t n = (size_t)settings->lights, skies = (size_t)settings->ensemble->skies;

	*s = (struct choose){.settings = settings, .levels = levels};
	s->column = calloc(n, sizeof(*s->column));
	s->use = calloc(skies * n, sizeof(*s->use));
	for (int k = 0; k < 2; k++)
		s->group[k] = calloc((size_t)settings->groups->count + 1, sizeof(*s->group[k]));
	s->sky_value = calloc(skies * PART_ROWS, sizeof(*s->sky_value));
	s->sky_left = calloc(skies * PART_ROWS, sizeof(*s->sky_left));
	s->sky_gain = calloc(skies * PART_ROWS, sizeof(*s->sky_gain));
	s->mono_sky = calloc(skies * 3 * RANK_MOST, sizeof(*s->mono_sky));
	s->colour_sky = calloc(skies * 3 * RANK_MOST, sizeof(*s->colour_sky));
	return s->column && s->use && s->group[0] && s->group[1] && s->sky_value && s->sky_left &&
			       s->sky_gain && s->mono_sky && s->colour_sky
		       ? 0
		       : -ENOMEM;
}

void choose_free(struct choose *s)
{
	free(s->column);
	free(s->use);
	free(s->group[0]);
	free(s->group[1]);
	free(s->sky_value);
	free(s->sky_left);
	free(s->sky_gain);
	free(s->mono_sky);
	free(s->colour_sky);
	*s = (struct choose){.settings = NULL};
}

/* ---- skies ---- */

/* Largest magnitude of left times tight. */
static float line_miss(const float *left, const float *tight, int count)
{
	const int whole = count / LANES * LANES;
	float lane[LANES] = {0}, most = 0;

	for (int k = 0; k < whole; k += LANES)
		for (int n = 0; n < LANES; n++)
			lane[n] = larger(lane[n], fabsf(left[k + n] * tight[k + n]));
	for (int k = whole; k < count; k++)
		most = larger(most, fabsf(left[k] * tight[k]));
	for (int n = 0; n < LANES; n++)
		most = larger(most, lane[n]);
	return most;
}

/* The skies' light on the values. */
static void sum_values(struct choose *s, const struct fit *fit)
{
	const struct part *part = fit->part;
	const int n = s->settings->lights, skies = s->settings->ensemble->tried;

	for (int c = 0; c < 3; c++)
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, part->pixels, n, 1,
			    part->sky_x + (size_t)c * (size_t)n, 3 * n,
			    part->value + (part->channels == 3 ? c * part->pixels : 0), part->rows,
			    0, s->sky_value + c * part->pixels, 3 * part->pixels);
}

static void sum_patterns(const struct choose *s, const struct part *part,
			 const struct rank_patterns *patterns, float *sum)
{
	const int n = s->settings->lights;

	cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, 3 * s->settings->ensemble->tried,
		    patterns->count, n, 1, part->sky_x, n, patterns->at_light, n, 0, sum,
		    RANK_MOST);
}

static void subtract_patterns(struct choose *s, const struct part *part, const float *rows,
			      const float *sum, int rank)
{
	const int skies = s->settings->ensemble->tried;

	for (int c = 0; c < 3 && rank; c++)
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, part->pixels, rank,
			    -1, sum + (size_t)c * RANK_MOST, 3 * RANK_MOST,
			    rows + (part->channels == 3 ? c * part->pixels : 0), part->rows, 1,
			    s->sky_left + c * part->pixels, 3 * part->pixels);
}

static float largest_of_three(const float x[3])
{
	return larger(larger(fabsf(x[0]), fabsf(x[1])), fabsf(x[2]));
}

/* What a light's column, and that of its group, put right under a sky, and at which share of the
 * cuts they are read. */
static struct estimate_use find_use(const struct choose *s, const struct part *part, size_t sky,
				    const struct estimate_column *column)
{
	const struct basis_groups *groups = s->settings->groups;
	const size_t n = (size_t)s->settings->lights, light = (size_t)column->light;
	const float *x = part->sky_x + sky * 3 * n + light;
	struct estimate_use use = {.own = {x[0], x[n], x[2 * n]}};
	const struct estimate_group *group = NULL;

	if (part->share)
		group = &s->group[column->mono][groups->of[light]];
	if (group && group->columns >= COLUMN_GROUP_LIGHTS) {
		const float *row = part->sky_even + sky * 3 * (size_t)groups->count +
				   groups->of[light];
		const float even[3] = {row[0], row[groups->count], row[2 * groups->count]};

		for (int c = 0; c < 3; c++) {
			use.common[c] = (float)part->share[light] * even[c];
			use.own[c] -= use.common[c];
		}
		use.group_share = largest_of_three(even) * group->reach / (float)part->group_cut;
		use.group_bytes = group->bytes / (float)(group->columns * group->columns);
	}
	use.share = part->column_cut > 0
			    ? largest_of_three(use.own) * column->reach / (float)part->column_cut
			    : 1;
	return use;
}

static void find_uses(struct choose *s, const struct part *part)
{
	const int skies = s->settings->ensemble->tried;

	for (int k = 0; k < skies; k++)
		for (int j = 0; j < s->columns; j++)
			s->use[k * s->settings->lights + j] = find_use(s, part, (size_t)k,
								       &s->column[j]);
}

/* sum[c] -= by[c] * left, for each channel. */
static void subtract_left(const struct fit *fit, int light, const float by[3], float *sum)
{
	const int pixels = fit->part->pixels;

	for (int c = 0; c < 3; c++) {
		const float *from = fit_left(fit, light) +
				    (fit->part->channels == 3 ? c * pixels : 0);

		for (int p = 0; p < pixels && by[c] != 0; p++)
			sum[c * pixels + p] -= by[c] * from[p];
	}
}

/* Adds what columns put right that are read at this share of the cuts, and were not before. Returns
 * the mean of the bytes that are read. */
static double use_columns(struct choose *s, const struct fit *fit, double before, double cut_share)
{
	const int skies = s->settings->ensemble->tried;
	const float was = (float)before, is = (float)cut_share;
	double read = 0;

	for (int k = 0; k < skies; k++)
		for (int j = 0; j < s->columns; j++) {
			const struct estimate_use *use = &s->use[k * s->settings->lights + j];
			const bool own = use->share >= is, group = use->group_share >= is;
			const bool more = own && use->share < was;
			const bool more_group = group && use->group_share < was;
			float by[3];

			read += (double)((own ? s->column[j].bytes : 0) +
					 (group ? use->group_bytes : 0));
			if (!more && !more_group)
				continue;
			for (int c = 0; c < 3; c++)
				by[c] = (more ? use->own[c] : 0) +
					(more_group ? use->common[c] : 0);
			subtract_left(fit, s->column[j].light, by,
				      s->sky_left + k * 3 * fit->part->pixels);
		}
	return read / skies;
}

/* How many levels a pixel changes by per unit of the sum of X times left. */
static void find_gains(struct choose *s, const struct part *part)
{
	const int pixels = part->pixels;

	for (int k = 0; k < 3 * s->settings->ensemble->tried; k++)
		for (int p = 0; p < pixels; p++) {
			const float slope = part->sky_slope[k / 3][k % 3];
			const float is = part->sky_offset[k / 3][k % 3] +
					 slope * part->sky_base[k * pixels + p];
			const float steepness = levels_at(s->levels, is + LIGHT_STEP / 2) -
						levels_at(s->levels, is - LIGHT_STEP / 2);

			s->sky_gain[k * pixels + p] = fabsf(slope) * steepness / LIGHT_STEP;
		}
}

/* The largest error under a sky over that asked for. */
static double sky_excess(const struct choose *s, const struct part *part,
			 const struct encode_target *asked)
{
	const int rows = 3 * part->pixels;
	double worst_square = 0;
	float worst = 0;

	for (int k = 0; k < s->settings->ensemble->tried; k++) {
		const float *gain = s->sky_gain + k * rows, *left = s->sky_left + k * rows;
		float squares[LANES] = {0}, square = 0;

		for (int r = 0; r + LANES <= rows; r += LANES)
			for (int n = 0; n < LANES; n++) {
				const float by = gain[r + n] * left[r + n];

				squares[n] += by * by;
			}
		for (int r = rows / LANES * LANES; r < rows; r++)
			square += gain[r] * left[r] * gain[r] * left[r];
		for (int n = 0; n < LANES; n++)
			square += squares[n];
		worst = larger(worst, line_miss(left, gain, rows));
		worst_square = fmax(worst_square, (double)square);
	}
	return fmax(sqrt(worst_square / rows) / asked->rms, (double)worst / asked->max);
}

/* ---- columns ---- */

/* Bytes of a line whose values are so many times what they may be off by. */
static float line_estimate(float miss)
{
	return miss <= LINE_ABSENT ? 0 : miss <= LINE_HALF ? BASIS_LINE_HALF : BASIS_LINE8;
}

/* Whether a column of one channel does: what it leaves is within the limits. */
static bool is_mono(const struct fit *fit, const float *left, const float *tight)
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

/* Bytes of a column of 8 bits that reaches so far, and of a second one where steps are too coarse
 * for the limits. */
static float estimate_bytes(const struct fit *fit, const float *left, const float *tight, bool mono,
			    float reach, float miss[3][4])
{
	const struct part *part = fit->part;
	const int pixels = part->pixels, panels = basis_panels8(pixels);
	const float half_step = reach / (2 * INT8_MAX);
	float first = COLUMN_BYTES, nearest = COLUMN_BYTES, second = COLUMN_BYTES;
	bool coarse = false;

	for (int k = 0; k < panels; k++) {
		const int p = k * BASIS_LINE8;
		const int count = pixels - p < BASIS_LINE8 ? pixels - p : BASIS_LINE8;
		float all = 0, all_rest = 0, all_size = 0;

		for (int c = 0; c < part->channels; c++) {
			const float *from = left + c * pixels + p;
			const float rest = half_step *
					   part_largest(tight + c * pixels + p, count, 1);
			const float size = larger(part_largest(from, count, 1),
						  part_largest(from, count, -1)) /
					   half_step;

			coarse |= rest > STEP_FINE;
			all = larger(all, miss[c][k]);
			all_rest = larger(all_rest, rest);
			all_size = larger(all_size, size);
			if (mono && c < part->channels - 1)
				continue;
			first += line_estimate(mono ? all : miss[c][k]);
			second += line_estimate(mono ? all_rest : rest);
			nearest += (mono ? all_size : size) < 1	   ? 0
				   : (mono ? all_size : size) < 15 ? BASIS_LINE_HALF
								   : BASIS_LINE8;
		}
	}
	return coarse ? nearest + second : first;
}

/* Bytes of a light's column; 0: it needs none. */
static float estimate_light(const struct fit *fit, int light, struct estimate_column *column)
{
	const struct part *part = fit->part;
	const size_t first = (size_t)light * (size_t)part->rows;
	const float *left = fit->left + first, *tight = part->tight + first;
	const int pixels = part->pixels, panels = basis_panels8(pixels);
	float miss[3][4], most = 0;

	for (int c = 0; c < part->channels; c++)
		for (int k = 0; k < panels; k++) {
			const int p = k * BASIS_LINE8;

			miss[c][k] = line_miss(left + c * pixels + p, tight + c * pixels + p,
					       pixels - p < BASIS_LINE8 ? pixels - p : BASIS_LINE8);
			most = larger(most, miss[c][k]);
		}
	if (most <= 1)
		return 0;
	column->mono = is_mono(fit, left, tight);
	column->reach = larger(part_largest(left, part->rows, 1),
			       part_largest(left, part->rows, -1));
	return estimate_bytes(fit, left, tight, column->mono, column->reach, miss);
}

/* ---- ranks ---- */

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

static double estimate_cost(struct choose *s, struct fit *fit, double bound)
{
	const double patterns = pattern_bytes(s, fit->part, true, fit->mono_rank) +
				pattern_bytes(s, fit->part, false, fit->colour_rank);
	double cost = (1 + READ_WEIGHT) * patterns +
		      BLOCK_COST * ((fit->mono_rank > 0) + (fit->colour_rank > 0));

	profile_enter(PROFILE_COLUMNS);
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

/* The groups of the lights that have columns. */
static void find_groups(struct choose *s, const struct part *part)
{
	const struct basis_groups *groups = s->settings->groups;

	for (int k = 0; k < 2 && part->share; k++)
		memset(s->group[k], 0, (size_t)groups->count * sizeof(*s->group[k]));
	for (int j = 0; j < s->columns && part->share; j++) {
		const struct estimate_column *column = &s->column[j];
		struct estimate_group *group = &s->group[column->mono][groups->of[column->light]];

		group->columns++;
		group->reach += (float)part->share[column->light] * column->reach;
		group->bytes += column->bytes;
	}
}

static struct estimate estimate_ranks(struct choose *s, struct fit *fit, int mono, int colour,
				      const struct encode_target *asked, double bound)
{
	const struct part *part = fit->part;
	struct estimate e = {.excess = INFINITY};
	double read;

	profile_enter(PROFILE_BASIS);
	fit_set_ranks(fit, mono, colour);
	e.mono_rank = fit->mono_rank;
	e.colour_rank = fit->colour_rank;
	e.cost = estimate_cost(s, fit, bound);
	if (e.cost >= bound)
		return e;
	profile_enter(PROFILE_SKIES);
	memcpy(s->sky_left, s->sky_value,
	       (size_t)(s->settings->ensemble->tried * 3 * part->pixels) * sizeof(*s->sky_left));
	subtract_patterns(s, part, fit->tinted_rows, s->mono_sky, fit->mono_rank);
	subtract_patterns(s, part, fit->colour_patterns.coefficient, s->colour_sky,
			  fit->colour_rank);
	e.cut_share = part->cut_share;
	find_groups(s, part);
	find_uses(s, part);
	read = use_columns(s, fit, NEVER, e.cut_share);
	e.excess = sky_excess(s, part, asked);
	while (e.excess > 1 && e.cut_share > LEAST_SHARE && part->column_cut > 0) {
		read = use_columns(s, fit, e.cut_share, e.cut_share * SHARE_STEP);
		e.cut_share *= SHARE_STEP;
		e.excess = sky_excess(s, part, asked);
	}
	e.cost += READ_WEIGHT * read;
	return e;
}

static bool is_better(const struct estimate *a, const struct estimate *b)
{
	if ((a->excess <= 1) != (b->excess <= 1))
		return a->excess <= 1;
	return a->excess <= 1 ? a->cost < b->cost : a->excess < b->excess;
}

/* Improves one of the two ranks, within so many steps of the list. */
static void scan_rank(struct choose *s, struct fit *fit, bool mono, int steps,
		      const struct encode_target *asked, struct estimate *best)
{
	const int found = mono ? fit->mono_patterns.count : fit->colour_patterns.count;
	const struct estimate from = *best;
	const int is = mono ? from.mono_rank : from.colour_rank;
	int at = 0;

	while (at + 1 < RANKS && ranks[at] < is)
		at++;
	for (int k = at > steps ? at - steps : 0; k < RANKS && k <= at + steps; k++) {
		const double bound = best->excess <= 1 ? best->cost : INFINITY;
		struct estimate e;

		if ((1 + READ_WEIGHT) * pattern_bytes(s, fit->part, mono, ranks[k]) >= bound)
			break;
		if (ranks[k] != is) {
			e = estimate_ranks(s, fit, mono ? ranks[k] : from.mono_rank,
					   mono ? from.colour_rank : ranks[k], asked, bound);
			if (is_better(&e, best))
				*best = e;
		}
		if (ranks[k] >= found)
			break;
	}
}

/* The patterns, and the light of the skies on values and on patterns. */
static int find_patterns(struct choose *s, struct fit *fit)
{
	int err;

	profile_enter(PROFILE_BASIS);
	err = fit_find(fit);
	profile_enter(PROFILE_SKIES);
	sum_values(s, fit);
	find_gains(s, fit->part);
	if (!err && fit->mono)
		sum_patterns(s, fit->part, &fit->mono_patterns, s->mono_sky);
	if (!err && fit->colour)
		sum_patterns(s, fit->part, &fit->colour_patterns, s->colour_sky);
	return err;
}

int choose_ranks(struct choose *s, struct fit *fit, const struct encode_target *asked)
{
	struct estimate best;
	int err = find_patterns(s, fit), before;

	if (err)
		return err;
	best = estimate_ranks(s, fit, fit->mono ? FIRST_RANK : 0, fit->colour ? FIRST_RANK : 0,
			      asked, INFINITY);
	if (fit->colour)
		scan_rank(s, fit, false, RANKS, asked, &best);
	before = best.mono_rank;
	if (fit->mono)
		scan_rank(s, fit, true, RANKS, asked, &best);
	if (fit->mono && fit->colour && best.mono_rank != before) {
		scan_rank(s, fit, false, NEAR, asked, &best);
		scan_rank(s, fit, true, NEAR, asked, &best);
	}
	fit_set_ranks(fit, best.mono_rank, best.colour_rank);
	fit->cut_share = best.cut_share;
	fit->excess = best.excess;
	return 0;
}
