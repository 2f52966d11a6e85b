/* SPDX-License-Identifier: MIT */

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode/encode_parts.h"

/* Added to a number below 2^22 and taken away again, it leaves the nearest integer. */
#define ROUNDING 0x1.8p23F
/* A channel that is tinted darker counts as black: tints are multiples of 2^-15. */
#define DARKEST_TINT 1e-9F
/* The largest value of 4 bits. */
#define HALF_MOST 7.0F
/* Values are rounded this many at a time, as the first few mostly show that a scale is too coarse.
 * It changes time only. */
#define TRIED_VALUES 32
/* Reaches are larger by this, so that the compositor's product of two floats, each rounded by
 * 2^-24, is not below the true reach. */
#define REACH_ROUNDING 1e-6
#define REACH_LIMIT (0.9995 * BASIS_VALUE_MAX)
/* Under a single light X = 1 - O(e), e of compositor.h. 1 % covers lights down to 1/1000 of
 * white. */
#define ALONE 1.01
/* A group's column that reaches further than this, times the share of the cut, has 16 bits: with 8
 * bits rounding would exceed a quarter of the block's cut. */
#define GROUP_NARROW 1.0
#define LIGHT_COLUMNS_MAX 2
/* Residuals of short lines may fill this share of their limits. Tuned (README.md, "Constants"). */
#define SHORT_SHARE 0.9F

int columns_create(struct columns *columns, const struct encode_settings *settings)
{
	const size_t groups = (size_t)settings->groups->count;

	*columns = (struct columns){.room = LIGHT_COLUMNS_MAX * settings->lights + 2 * (int)groups};
	columns->column = calloc((size_t)columns->room, sizeof(*columns->column));
	columns->value = calloc((size_t)columns->room * PART_ROWS, sizeof(*columns->value));
	return columns->column && columns->value ? 0 : -ENOMEM;
}

void columns_free(struct columns *columns)
{
	free(columns->column);
	free(columns->value);
	*columns = (struct columns){.count = 0};
}

/* ---- one column ---- */

static double largest_magnitude(const float *from, int count)
{
	return (double)part_magnitude(from, count);
}

/* For each value of a column: the value `from` that leaves no residual, and the interval
 * least..most that leaves a residual within its limits. */
struct column_bounds {
	int count;
	float from[PART_ROWS], least[PART_ROWS], most[PART_ROWS];
	float needed
		[PART_ROWS]; /* smallest magnitude in the interval; negative if 0 is inside it */
};

/* Finds the bounds of a column whose residual may fill `share` of its limits. The interval of a
 * column of one channel is the intersection of three, as its values are multiplied by three
 * tints. */
static void bounds_find(struct column_bounds *b, const struct low_rank *fit, int light,
			int channels, float share, const float *left)
{
	const struct part *part = fit->part;
	const int pixels = part->pixels;
	const bool mono = channels < part->channels;
	const size_t first = (size_t)light * (size_t)part->rows;
	const float *least_left = part->limit.least + first, *most_left = part->limit.most + first;

	b->count = channels * pixels;
	if (mono)
		fit_untint(fit, left, b->from);
	else
		memcpy(b->from, left, (size_t)b->count * sizeof(*left));
	for (int r = 0; r < part->rows; r++) {
		const int c = r / pixels, p = r % pixels, to = mono ? p : r;
		const float per = mono ? 1 / larger(fit->tint_share[c][p], DARKEST_TINT) : 1;
		const float low = per * (left[r] - share * most_left[r]);
		const float high = per * (left[r] - share * least_left[r]);

		b->least[to] = mono && c ? larger(low, b->least[to]) : low;
		b->most[to] = mono && c ? smaller(high, b->most[to]) : high;
	}
	for (int r = 0; r < b->count; r++)
		b->needed[r] = larger(b->least[r], -b->most[r]);
}

/* Finds, for each value, the integer in by * least..by * most and -limit..limit that is nearest to
 * by * from. Returns false if there is none for some value, which then takes the nearest. No branch
 * depends on a value, so that compilers make vectors of it. */
static bool round_between(const float *restrict least, const float *restrict most,
			  const float *restrict from, int count, float by, float limit,
			  int16_t *restrict value)
{
	int beyond = 0;

	for (int k = 0; k < count; k++) {
		const float low = larger(by * least[k], -limit);
		const float high = smaller(by * most[k], limit);
		const float inside = larger(smaller(larger(by * from[k], low), high), -limit);
		const float near = inside + ROUNDING - ROUNDING;
		const float up = near < low ? 1.0F : 0.0F, down = near > high ? 1.0F : 0.0F;
		const float is = near + (up - down);
		const int below = is >= low ? 0 : 1, above = is <= high ? 0 : 1;

		beyond |= below | above;
		value[k] = (int16_t)(int)is;
	}
	return !beyond;
}

static bool column_round(struct column *column, const struct column_bounds *b, double scale)
{
	const float by = (float)(1 / scale), limit = (float)column_most(column->bits);

	column->scale = (float)scale;
	for (int k = 0; k < b->count; k += TRIED_VALUES) {
		const int count = k + TRIED_VALUES < b->count ? TRIED_VALUES : b->count - k;

		if (!round_between(b->least + k, b->most + k, b->from + k, count, by, limit,
				   column->value + k))
			return false;
	}
	return true;
}

/* left = from less the column's values, times the tint if it has one channel. */
static void column_subtract(const struct column *column, const struct low_rank *fit,
			    const float *from, float *left)
{
	const struct part *part = fit->part;
	const int pixels = part->pixels;
	const bool mono = column->channels < part->channels;

	for (int c = 0; c < part->channels; c++)
		for (int p = 0; p < pixels; p++) {
			const int r = c * pixels + p;
			const float is = column->scale * (float)column->value[mono ? p : r];

			left[r] = from[r] - (mono ? fit->tint_share[c][p] * is : is);
		}
}

/* Rounds a line to 4-bit multiples of `factor` steps within its bounds. Returns false, and changes
 * nothing, if there are none. */
static bool line_shorten(struct column *column, const struct column_bounds *b, int first, int count,
			 int factor)
{
	const float by = 1 / (column->scale * (float)factor);
	int16_t value[BASIS_LINE8];

	if (!round_between(b->least + first, b->most + first, b->from + first, count, by, HALF_MOST,
			   value))
		return false;
	for (int k = 0; k < count; k++)
		column->value[first + k] = (int16_t)(value[k] * factor);
	return true;
}

/* Rounds a line to the least factor that keeps its bounds; returns its code (basis_lines.h). */
static uint8_t line_code(struct column *column, const struct column_bounds *b, int first, int count)
{
	const float needed = part_largest(b->needed + first, count) / (column->scale * HALF_MOST);

	if (!(needed > 0)) {
		memset(column->value + first, 0, (size_t)count * sizeof(*column->value));
		return 0;
	}
	for (int factor = (int)ceilf(needed); factor <= BASIS_LINE_FACTOR_MAX; factor++)
		if (line_shorten(column, b, first, count, factor))
			return (uint8_t)factor;
	return BASIS_LINE_WHOLE;
}

/* Stores each line of a column of 8 bits as shortly as the bounds allow. */
static void column_shorten(struct column *column, const struct column_bounds *b, int pixels)
{
	for (int c = 0; c < column->channels; c++)
		for (int p = 0; p < pixels; p += BASIS_LINE8) {
			const int count = pixels - p < BASIS_LINE8 ? pixels - p : BASIS_LINE8;

			column->code[p / BASIS_LINE8 * column->channels + c] =
				line_code(column, b, c * pixels + p, count);
		}
}

/* Computes the column's bytes. */
static void column_measure(struct column *column, int pixels)
{
	if (column->bits == 8)
		column->bytes = basis_record_bytes(column->code,
						   basis_record_lines(pixels, column->channels));
	else
		column->bytes = (size_t)(basis_panels16(pixels) * column->channels) * BASIS_ALIGN;
}

/* Quantises a column: the values nearest to `from` whose residual, which goes to left, keeps its
 * limits. Returns false if the column has too few bits for that. */
static bool column_quantise(struct column *column, const struct low_rank *fit, double reach,
			    const float *from, float *left)
{
	const struct part *part = fit->part;
	struct column_bounds b;
	double scale;

	bounds_find(&b, fit, column->number, column->channels, 1, from);
	scale = fmax(reach, (double)part_largest(b.needed, b.count)) / column_most(column->bits);
	if (scale < (double)FLT_MIN || !column_round(column, &b, scale))
		return false;
	column_subtract(column, fit, from, left);
	if (!part_cell_holds(part, column->number, left))
		return false;
	/* U may not become negative, which the limits of residuals do not ensure. */
	if (column->bits == 8 && part->kind != BASIS_KIND_U) {
		bounds_find(&b, fit, column->number, column->channels, SHORT_SHARE, from);
		column_shorten(column, &b, part->pixels);
		column_subtract(column, fit, from, left);
	}
	column_measure(column, part->pixels);
	return true;
}

/* Sets the codes of a column's lines to the shortest that keep its values. */
static void shorten_exactly(struct column *column, int pixels)
{
	for (int c = 0; c < column->channels; c++)
		for (int p = 0; p < pixels; p += BASIS_LINE8) {
			const int count = pixels - p < BASIS_LINE8 ? pixels - p : BASIS_LINE8;
			int most = 0;

			for (int k = 0; k < count; k++)
				most = abs(column->value[c * pixels + p + k]) > most
					       ? abs(column->value[c * pixels + p + k])
					       : most;
			column->code[p / BASIS_LINE8 * column->channels + c] =
				!most			 ? 0
				: most <= (int)HALF_MOST ? 1
							 : BASIS_LINE_WHOLE;
		}
}

/* Rounds values to nearest; the largest value that can be stored is `reach`. */
static void column_round_nearest(struct column *column, const float *from, int count, double reach)
{
	const double scale = reach / column_most(column->bits);
	const double by = scale >= (double)FLT_MIN ? 1 / scale : 0;

	column->scale = by > 0 ? (float)scale : 0;
	for (int k = 0; k < count; k++) {
		const double is = fmin(fmax(by * (double)from[k], -column_most(column->bits)),
				       column_most(column->bits));

		column->value[k] = (int16_t)lrint(is);
	}
	if (column->bits == 8)
		shorten_exactly(column, count / column->channels);
}

/* ---- the columns of a light ---- */

/* Tells whether a U decoded without a column falls clearly below 0. It may come out as 0, but no
 * less, as the ratio 1 - d / u would change its sign. */
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

/* Returns the reach of a light's column. It is the largest value, and more if the light's limits
 * were narrowed, so that more frames read the column. It is at least ALONE times the cut, so that V
 * under a light alone always reads it. */
static double reach_for(const struct low_rank *fit, int light, const float *left)
{
	const struct part *part = fit->part;
	const double largest = largest_magnitude(left, part->rows);
	const double reach = fmax(largest / (double)part->limit.light_share[light],
				  ALONE * fit->cut_share * part->limit.column_cut);

	/* The quotient may exceed what the format allows; no value does (VALUE_MAX of part.c). */
	return fmin(reach, REACH_LIMIT) * (1 + REACH_ROUNDING);
}

static struct column *columns_add(struct columns *columns, int number, int channels, int bits,
				  bool second)
{
	struct column *column = &columns->column[columns->count];

	*column = (struct column){
		.number = number,
		.channels = channels,
		.bits = bits,
		.second = second,
		.value = columns->value + (size_t)columns->count * PART_ROWS,
	};
	memset(column->code, BASIS_LINE_WHOLE, sizeof(column->code));
	columns->count++;
	return column;
}

/* Quantises a column to nearest, whether or not its residual keeps the limits. */
static void column_quantise_nearest(struct column *column, const struct low_rank *fit, double reach,
				    const float *from, float *left)
{
	const int pixels = fit->part->pixels, count = column->channels * pixels;
	float one[PART_ROWS];
	const float *value = from;

	if (column->channels < fit->part->channels) {
		fit_untint(fit, from, one);
		value = one;
	}
	column_round_nearest(column, value, count, fmax(reach, largest_magnitude(value, count)));
	column_subtract(column, fit, from, left);
	column_measure(column, pixels);
}

/* Adds a second column for the residual of a light's first, which only strong light reads. Returns
 * whether the limits are kept. If they are not, a column of 16 bits stays, one of 8 is dropped. */
static bool add_second_column(struct columns *columns, const struct low_rank *fit, int light,
			      int channels, int bits, const float *left)
{
	const double reach = reach_for(fit, light, left);
	struct column *column = columns_add(columns, light, channels, bits, true);
	float rest[PART_ROWS];

	if (column_quantise(column, fit, reach, left, rest))
		return true;
	if (bits == 16)
		column_quantise_nearest(column, fit, reach, left, rest);
	else
		columns->count--;
	return false;
}

/* Adds the first of these that keeps a light's limits, in order of cost: nothing; 8 bits; two of 8
 * bits, each of one channel before three; 16 bits; 16 and 8 bits; two of 16. Lights that shine
 * along the ground need the last: the object throws many times their own light on the ground, where
 * its shadow is as dark as any. */
static void light_columns(struct columns *columns, const struct low_rank *fit, int light)
{
	const struct part *part = fit->part;
	const float *from = fit_left(fit, light);
	struct column *column;
	float left[PART_ROWS];
	double reach;

	if (part_cell_holds(part, light, from) && !would_be_negative(part, light, from))
		return;
	reach = reach_for(fit, light, from);
	for (int channels = fit->mono ? 1 : 3; channels <= part->channels; channels += 2) {
		column = columns_add(columns, light, channels, 8, false);
		if (column_quantise(column, fit, reach, from, left))
			return;
		column_quantise_nearest(column, fit, reach, from, left);
		if (part->limit.column_cut > 0 &&
		    add_second_column(columns, fit, light, channels, 8, left))
			return;
		columns->count--;
	}
	column = columns_add(columns, light, part->channels, 16, false);
	if (column_quantise(column, fit, reach, from, left))
		return;
	column_quantise_nearest(column, fit, reach, from, left);
	if (!add_second_column(columns, fit, light, part->channels, 8, left))
		add_second_column(columns, fit, light, part->channels, 16, left);
}

/* ---- the columns of groups ---- */

/* value = sum of q_i column_i over a group's lights that have columns of `channels` channels.
 * Returns the number of these lights. */
static int group_sum(const struct columns *columns, int lights, const struct low_rank *fit,
		     int channels, int group, float *value, double *reach)
{
	const struct part *part = fit->part;
	const int count = channels * part->pixels;
	int found = 0;

	memset(value, 0, (size_t)count * sizeof(*value));
	*reach = 0;
	for (int k = 0; k < lights; k++) {
		const struct column *column = &columns->column[k];
		float by;

		if (fit->settings->groups->of[column->number] != group ||
		    column->channels != channels)
			continue;
		by = (float)part->sky.share[column->number] * column->scale;
		found += !column->second;
		*reach += column->second ? 0 : (double)by * column_most(column->bits);
		for (int r = 0; r < count; r++)
			value[r] += by * (float)column->value[r];
	}
	return found;
}

/* Adds the column of a group, if enough of its lights have columns and it would ever be read. 8
 * bits suffice mostly, as the group's light is never large (BASIS_GROUP_MOST). It has 16 if it
 * reaches beyond GROUP_NARROW, as a mirror's does, or if the block's cut is fine. */
static void group_column(struct columns *columns, int lights, const struct low_rank *fit,
			 int channels, int group)
{
	const struct part *part = fit->part;
	const int count = channels * part->pixels;
	float value[PART_ROWS];
	struct column *column;
	double reach, largest;

	if (group_sum(columns, lights, fit, channels, group, value, &reach) < COLUMN_GROUP_LIGHTS ||
	    reach < fit->cut_share * COLUMN_GROUP_REACH)
		return;
	largest = largest_magnitude(value, count);
	/* With a lowered cut, the group columns carry the error that most lights of a tile share,
	 * so they reach as far as their lights' columns together. */
	if (fit->cut_share < 1)
		largest = fmin(fmax(largest, reach), REACH_LIMIT);
	column = columns_add(columns, fit->settings->lights + group, channels,
			     largest > fit->cut_share * GROUP_NARROW ? 16 : 8, false);
	column_round_nearest(column, value, count, largest);
	column_measure(column, part->pixels);
}

void columns_find(struct columns *columns, const struct low_rank *fit)
{
	const int groups = fit->part->sky.share ? fit->settings->groups->count : 0;
	int lights;

	columns->count = 0;
	for (int i = 0; i < fit->settings->lights; i++)
		light_columns(columns, fit, i);
	lights = columns->count;
	for (int group = 0; group < groups; group++)
		for (int channels = 1; channels <= 3; channels += 2)
			group_column(columns, lights, fit, channels, group);
}
