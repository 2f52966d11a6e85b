/* SPDX-License-Identifier: MIT */
#include "tests/support/bake/encode_promises.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* RMS and largest difference, in levels. */
struct promise_seen {
	double rms, most;
};

/* A light has one column, or two where strong light alone needs the second. */
#define PROMISE_COLUMNS_MAX 2

/* Place of a column, and its largest possible value per unit of X. */
struct promise_column {
	int block;
	uint32_t number;
	double reach;
};

double encode_promises_difference(const struct encode_rig *e, const struct encode_rig_part *part)
{
	const size_t n = (size_t)e->settings.lights;
	double most = 0;

	for (size_t k = 0; k < (size_t)part->samples.pixels * 3 * n; k++)
		most = fmax(most, fabs(part->is[k] - part->decoded[k]) /
					  encode_rig_unit(e, part->samples.kind, (int)(k % n)));
	return most;
}

/* Radiance of white ground under a lighting, radiance[3][lights], in the brightest channel. */
static double promise_white(const struct encode_rig *e, const double *radiance)
{
	double white = 0;

	for (int c = 0; c < 3; c++) {
		double sum = 0;

		for (int i = 0; i < e->settings.lights; i++)
			sum += radiance[c * e->settings.lights + i] *
			       ensemble_projected_sr(&e->light[i]) / M_PI;
		white = fmax(white, sum);
	}
	return white;
}

/*
 * sum over i of t_i L_i for one row of values[row][lights]. Kind V:
 *	sum over i of v_i u_i L_i / sum over i of u_i L_i
 */
static double promise_lit(const struct encode_rig *e, const struct encode_rig_part *part,
			  const double *values, int row, const double *radiance)
{
	const int n = e->settings.lights, c = row % 3;
	double sum = 0, all = 0;

	for (int i = 0; i < n; i++) {
		const double u = part->samples.kind == BASIS_KIND_V ? e->ground[c * n + i] : 1;
		const double x = u * radiance[c * n + i];

		sum += values[(size_t)row * (size_t)n + (size_t)i] * x;
		all += x;
	}
	return part->samples.kind == BASIS_KIND_V ? sum / all : sum;
}

/* Difference of truth and decoded values in levels, exposed as ensemble.h says: kind T over black,
 * kind V over its ground, or over white. */
static struct promise_seen promise_seen_under(const struct encode_rig *e,
					      const struct encode_rig_part *part,
					      const double *radiance, bool over_white)
{
	const int rows = part->samples.pixels * 3;
	double white = promise_white(e, radiance), square = 0;
	struct promise_seen seen = {0, 0};

	for (int r = 0; r < rows && part->samples.kind == BASIS_KIND_T; r++)
		white = fmax(white, promise_lit(e, part, part->is, r, radiance));
	for (int r = 0; r < rows; r++) {
		double is = promise_lit(e, part, part->is, r, radiance);
		double got = promise_lit(e, part, part->decoded, r, radiance), by;

		if (part->samples.kind == BASIS_KIND_V) {
			double ground = over_white ? white : 0;

			for (int i = 0; !over_white && i < e->settings.lights; i++)
				ground += e->ground[r % 3 * e->settings.lights + i] *
					  radiance[r % 3 * e->settings.lights + i];
			is = (1 - is) * ground;
			got = (1 - got) * ground;
		}
		by = fabs(encode_rig_level(is / white) - encode_rig_level(got / white));
		square += by * by;
		seen.most = fmax(seen.most, by);
	}
	seen.rms = sqrt(square / rows);
	return seen;
}

/* ---- promises ---- */

static void promise_cells(const struct encode_rig *e, const struct encode_rig_part *part,
			  double limit)
{
	const int n = e->settings.lights;
	double *radiance = calloc(3 * (size_t)n, sizeof(*radiance));

	assert_non_null(radiance);
	for (int i = 0; i < n; i++) {
		struct promise_seen seen;

		for (int c = 0; c < 3; c++)
			radiance[c * n + i] = 1;
		seen = promise_seen_under(e, part, radiance, false);
		if (seen.most > limit)
			fail_msg("cell %d of %d alone: %g levels, expected at most %g", i, n,
				 seen.most, limit);
		for (int c = 0; c < 3; c++)
			radiance[c * n + i] = 0;
	}
	free(radiance);
}

/* A lighting from outside the ensemble: a lamp, a sun or soft light in a random direction. */
static void promise_unseen_light(const struct encode_rig *e, struct chance *chance,
				 double *radiance)
{
	const int n = e->settings.lights, which = chance_int(chance, 0, 2);
	double to[3], tone[3];

	chance_direction(chance, 0.05, to);
	for (int c = 0; c < 3; c++)
		tone[c] = chance_real(chance, 0.2, 1);
	for (int i = 0; i < n; i++) {
		const double near = encode_rig_dot(e->light[i].direction, to);

		for (int c = 0; c < 3; c++)
			radiance[c * n + i] = which == 0 ? 0.05 + tone[c] * pow(fmax(near, 0), 40)
					      : which == 1
						      ? 0.3 + tone[c] * chance_real(chance, 0, 3)
						      : 0.2 * tone[c] + (near > 0.99 ? 300 : 0);
	}
}

static void promise_unseen(const struct encode_rig *e, const struct encode_rig_part *part,
			   int times, struct chance *chance)
{
	double *radiance = calloc(3 * (size_t)e->settings.lights, sizeof(*radiance));

	assert_non_null(radiance);
	for (int k = 0; k < times; k++) {
		struct promise_seen seen;

		promise_unseen_light(e, chance, radiance);
		seen = promise_seen_under(e, part, radiance, false);
		/* The encoder has not tried this light: its largest error may be half as large
		 * again. */
		if (seen.rms > e->settings.target.cell || seen.most > 1.5 * e->settings.target.max)
			fail_msg("unseen light %d: RMS %g, most %g levels", k, seen.rms, seen.most);
	}
	free(radiance);
}

static void promise_skies(const struct encode_rig *e, const struct encode_rig_part *part)
{
	const size_t n = (size_t)e->settings.lights;
	double *radiance = calloc(3 * n, sizeof(*radiance));

	assert_non_null(radiance);
	for (int s = 0; s < e->ensemble.skies; s++) {
		struct promise_seen seen;

		for (size_t k = 0; k < 3 * n; k++)
			radiance[k] = (double)e->ensemble.radiance[(size_t)s * 3 * n + k];
		seen = promise_seen_under(e, part, radiance, e->ensemble.strong[s]);
		if (seen.rms > e->settings.target.rms ||
		    seen.most > (e->ensemble.strong[s]
					 ? fmax(e->settings.target.max, e->settings.target.cell)
					 : e->settings.target.max))
			fail_msg("sky %d, kind %d, %d pixels, %d lights: RMS %g, most %g levels", s,
				 (int)part->samples.kind, part->samples.pixels, (int)n, seen.rms,
				 seen.most);
	}
	free(radiance);
}

void encode_promises_format(const struct encode_rig *e, const struct encode_result *result)
{
	for (int k = 0; k < result->shown_count; k++) {
		const struct basis_block_entry *b = &result->shown[k].entry;
		const struct encode_rig_arrays a = encode_rig_arrays_of(&result->shown[k],
									e->settings.coarse);

		expect_that(b->tile == 5 && b->pixels && b->patterns + b->columns > 0, "k=%d", k);
		expect_that(!k || result->shown[k - 1].entry.kind <= b->kind, "k=%d", k);
		expect_that(b->columns || b->bits == 16, "k=%d", k);
		expect_that(b->cut_share > 0 && b->cut_share <= 1 && !b->reserved, "k=%d", k);
		for (int p = 1; p < b->pixels; p++)
			expect_above(a.pixel[p], a.pixel[p - 1], "k=%d, p=%d", k, p);
		for (uint32_t n = 0; n < b->columns; n++) {
			expect_below(a.light[n],
				     e->settings.lights + (e->gather ? e->settings.coarse : 0),
				     "k=%d, n=%u", k, n);
			expect_that(!n || a.light[n] > a.light[n - 1], "k=%d, n=%u", k, n);
			expect_that(a.column_scale[n] >= 0 &&
					    (double)a.column_scale[n] *
							    (b->bits == 8 ? 127 : 32767) <=
						    BASIS_VALUE_MAX,
				    "k=%d, n=%u", k, n);
			for (int p = 0; p < (b->pixels + 63) / 64 * 64 && b->bits == 8; p++)
				for (size_t c = 0; c < b->channels; c++)
					expect_at_most(abs(encode_rig_byte(b, &a, (size_t)p, c, n)),
						       127 * (p < b->pixels),
						       "k=%d, n=%u, p=%d, c=%zu", k, n, p, c);
		}
		for (int j = 0; j < b->patterns; j++) {
			double sum = 0;

			for (int i = 0; i < a.stride; i++) {
				expect_that(a.pattern[j * a.stride + i] != -32768,
					    "k=%d, j=%d, i=%d", k, j, i);
				expect_that(i < e->settings.coarse ||
						    a.pattern[j * a.stride + i] == 0,
					    "k=%d, j=%d, i=%d", k, j, i);
				sum += abs(a.pattern[j * a.stride + i]);
			}
			expect_at_most((double)a.pattern_scale[j] * 32767 * sum, BASIS_VALUE_MAX,
				       "k=%d, j=%d", k, j);
		}
	}
}

/* Group of a light, and the light's weight in the group's mean, as basis_format.h defines them. */
static int promise_group(const struct encode_rig *e, int light)
{
	const struct basis_coarse *to = &e->gather[light];
	int most = 0;

	for (int k = 1; k < 3; k++)
		most = to->weight[k] > to->weight[most] ? k : most;
	return to->index[most];
}

static double promise_weight(const struct encode_rig *e, enum basis_kind kind, int light)
{
	const int n = e->settings.lights;

	return kind == BASIS_KIND_V
		       ? e->ground[light] + e->ground[n + light] + e->ground[2 * n + light]
		       : e->light[light].solid_angle_sr;
}

/* Whether block k shares its columns of groups with the block before it, as basis_format.h
 * defines. */
static bool promise_follows(const struct encode_rig *e, const struct encode_result *result, int k)
{
	const struct basis_block_payload *now = &result->shown[k], *before = now - (k > 0);
	const struct basis_block_entry *b = &now->entry, *a = &before->entry;

	return k && a->kind == b->kind && a->ground == b->ground && a->channels == b->channels &&
	       a->pixels == b->pixels &&
	       memcmp(encode_rig_arrays_of(before, e->settings.coarse).pixel,
		      encode_rig_arrays_of(now, e->settings.coarse).pixel,
		      b->pixels * sizeof(uint16_t)) == 0;
}

/* Adds to to_sum[pixels][channels] the weighted mean of the columns of a group's lights, in blocks
 * first to last. Returns the number of these columns. */
static int promise_members(const struct encode_rig *e, const struct encode_result *result,
			   int first, int last, int group, double *to_sum)
{
	double all = 0;
	int members = 0;

	for (int i = 0; i < e->settings.lights; i++)
		if (promise_group(e, i) == group)
			all += promise_weight(e, result->shown[first].entry.kind, i);
	for (int k = first; k <= last; k++) {
		const struct basis_block_entry *b = &result->shown[k].entry;
		const struct encode_rig_arrays a = encode_rig_arrays_of(&result->shown[k],
									e->settings.coarse);

		for (uint32_t n = 0; n < b->columns; n++) {
			if (a.light[n] >= e->settings.lights ||
			    promise_group(e, a.light[n]) != group)
				continue;
			members++;
			for (int r = 0; r < b->pixels * b->channels; r++)
				to_sum[r] += promise_weight(e, b->kind, a.light[n]) / all *
					     encode_rig_column(b, &a, r / b->channels,
							       r % b->channels, n);
		}
	}
	return members;
}

/* Checks that a group's column is the weighted mean of its lights' columns, to half of its scale.
 * Returns the largest rounding of any group, summed over its blocks; tinted blocks count twice. */
static double promise_groups(const struct encode_rig *e, const struct encode_result *result)
{
	double *rounded = calloc((size_t)e->settings.coarse, sizeof(*rounded)), most = 0;

	assert_non_null(rounded);
	for (int k = 0, first = 0; k < result->shown_count; k++) {
		const struct basis_block_entry *b = &result->shown[k].entry;
		const struct encode_rig_arrays a = encode_rig_arrays_of(&result->shown[k],
									e->settings.coarse);
		int last = k;

		first = promise_follows(e, result, k) ? first : k;
		while (last + 1 < result->shown_count && promise_follows(e, result, last + 1))
			last++;
		for (uint32_t n = 0; n < b->columns; n++) {
			const int group = a.light[n] - e->settings.lights;
			double is[3 * ENCODE_RIG_PIXELS_MAX] = {0};

			if (group < 0)
				continue;
			expect_at_least(promise_members(e, result, first, last, group, is), 2,
					"k=%d, n=%u", k, n);
			for (int r = 0; r < b->pixels * b->channels; r++) {
				is[r] -= encode_rig_column(b, &a, r / b->channels, r % b->channels,
							   n);
				/* 0.01: the encoder sums 16-bit columns in single precision */
				if (fabs(is[r]) > 0.51 * (double)a.column_scale[n] + 1e-9)
					fail_msg("group %d is off by %g of its scale", group,
						 is[r] / (double)a.column_scale[n]);
			}
			rounded[group] += (double)a.column_scale[n] * (b->tinted ? 1 : 0.5);
			most = fmax(most, rounded[group]);
		}
	}
	free(rounded);
	return most;
}

/* Finds a light's columns, that with the largest reach first: at the cut of the file, whatever the
 * blocks' shares of it are. Returns their number. */
static int promise_columns(const struct encode_rig *e, const struct encode_result *result,
			   int light, struct promise_column *column)
{
	int count = 0;

	for (int k = 0; k < result->shown_count; k++) {
		const struct encode_rig_arrays a = encode_rig_arrays_of(&result->shown[k],
									e->settings.coarse);

		for (uint32_t n = 0; n < result->shown[k].entry.columns; n++)
			if (a.light[n] == light) {
				const struct basis_block_entry *b = &result->shown[k].entry;
				const double reach = (double)a.column_scale[n] *
						     (b->bits == 8 ? 127 : 32767) /
						     (double)b->cut_share;

				expect_below(count, PROMISE_COLUMNS_MAX, "k=%d, n=%u", k, n);
				column[count++] = (struct promise_column){k, n, reach};
			}
	}
	if (count == 2 && column[0].reach < column[1].reach) {
		const struct promise_column first = column[1];

		column[1] = column[0];
		column[0] = first;
	}
	return count;
}

/* Subtracts a column from the light's decoded values. */
static void promise_take_column(const struct encode_rig *e, struct encode_rig_part *part,
				const struct encode_result *result, int light,
				const struct promise_column *column)
{
	const double unit = encode_rig_unit(e, part->samples.kind, light);
	const size_t n = (size_t)e->settings.lights;
	const struct basis_block_entry *b = &result->shown[column->block].entry;
	const struct encode_rig_arrays a = encode_rig_arrays_of(&result->shown[column->block],
								e->settings.coarse);

	for (int q = 0, own = 0; q < b->pixels; q++) {
		while (part->pixel[own] != a.pixel[q])
			own++;
		for (int c = 0; c < 3; c++)
			part->decoded[((size_t)own * 3 + (size_t)c) * n + (size_t)light] -=
				encode_rig_column(b, &a, q, b->channels == 3 ? c : 0,
						  column->number) *
				(b->tinted ? a.tint[c * b->pixels + q] / (double)BASIS_TINT_ONE
					   : 1) *
				unit;
	}
}

/* The largest error under one cell alone, so dim that a frame just leaves out a column of this
 * reach. */
static void promise_faded(const struct encode_rig *e, const struct encode_rig_part *part, int light,
			  double reach)
{
	const int n = e->settings.lights, rows = part->samples.pixels * 3;
	double white = ensemble_projected_sr(&e->light[light]) / M_PI, radiance, worst = 0;

	for (int r = 0; r < rows; r++)
		white = fmax(white, part->is[(size_t)r * (size_t)n + (size_t)light]);
	radiance = fmin(e->settings.column_cut / reach / e->light[light].solid_angle_sr, 1 / white);
	if (radiance * reach * e->light[light].solid_angle_sr > e->settings.column_cut * 1.001)
		return;
	for (int r = 0; r < rows; r++) {
		const size_t at = (size_t)r * (size_t)n + (size_t)light;

		worst = fmax(worst, fabs(encode_rig_level(radiance * part->is[at]) -
					 encode_rig_level(radiance * part->decoded[at])));
	}
	if (worst > e->settings.target.cell)
		fail_msg("cell %d of %d, faded until a column is left out: %g levels", light, n,
			 worst);
}

/* Subtracts each cell's columns from part->decoded and checks the cell after each. The column of
 * smallest reach goes first: of two columns, it is the one that strong light alone needs. */
static void promise_fading(const struct encode_rig *e, struct encode_rig_part *part,
			   const struct encode_result *result)
{
	for (int i = 0; i < e->settings.lights; i++) {
		struct promise_column column[PROMISE_COLUMNS_MAX];

		for (int k = promise_columns(e, result, i, column) - 1; k >= 0; k--) {
			promise_take_column(e, part, result, i, &column[k]);
			if (column[k].reach > 0)
				promise_faded(e, part, i, column[k].reach);
		}
	}
}

struct encode_result encode_promises_hold(struct encode_rig *e, struct encode_rig_part *part,
					  struct chance *chance)
{
	const struct encode_result result = encode_rig_run(e, &part, 1, false);
	const double bound = part->samples.kind == BASIS_KIND_T ? result.object_error
								: result.ratio_error;
	const double rounded = e->gather ? promise_groups(e, &result) : 0;
	const double is = encode_promises_difference(e, part) + rounded;

	encode_promises_format(e, &result);
	if (is > bound || is < 0.99 * bound - 1e-5)
		fail_msg("largest difference %g, declared %g", is, bound);
	promise_cells(e, part, e->settings.target.cell);
	promise_skies(e, part);
	if (chance)
		promise_unseen(e, part, 40, chance);
	assert_true(ensemble_sky_rms(&result.error) <= e->settings.target.rms);
	assert_true(result.error.cell_max <= e->settings.target.cell);
	if (part->samples.kind == BASIS_KIND_T)
		promise_fading(e, part, &result);
	return result;
}
