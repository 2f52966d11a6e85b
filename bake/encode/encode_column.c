/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_column.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode/encode_limit.h"

/* Added to a number below 2^22 and taken away again, it leaves the nearest integer. */
#define ROUNDING 0x1.8p23F
/* A channel that is tinted darker is as good as black. */
#define DARKEST_TINT 1e-9F
/* The largest value of a line of half bytes. */
#define HALF_MOST 7.0F
/* So many values are tried at a time: scales that do not do are mostly found out by the first. */
#define TRIED_VALUES 32
/* A scale is a float, and what the compositor multiplies it by as well. */
#define REACH_ROUNDING 1e-6
#define REACH_LIMIT (0.9995 * BASIS_VALUE_MAX)
/* A light alone is nearly all of the ground's, less what e of compositor.h adds: of light that is
 * dim, but not a thousand times dimmer than white, not so much. */
#define ALONE 1.01
/* Largest reach of a group's column of 8 bits, times the share of the cut: beyond it rounding would
 * exceed a quarter of the block's cut. */
#define GROUP_NARROW 1.0
#define LIGHT_COLUMNS_MAX 2

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

/* Largest magnitude. */
static double largest_of(const float *from, int count)
{
	return (double)part_magnitude(from, count);
}

/* What each value of a column has to lie between, so that its residual keeps its limits; and where
 * it should be. */
struct bounds {
	int count;
	float from[PART_ROWS], least[PART_ROWS], most[PART_ROWS];
	float needed[PART_ROWS]; /* magnitude of the value between that is nearest to 0 */
};

/* share: of the limits. A column of one channel has to do for all three, tinted. */
static void bounds_find(struct bounds *b, const struct fit *fit, int light, int channels,
			float share, const float *left)
{
	const struct part *part = fit->part;
	const int pixels = part->pixels;
	const bool mono = channels < part->channels;
	const size_t first = (size_t)light * (size_t)part->rows;
	const float *least_left = part->least_left + first, *most_left = part->most_left + first;

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

/* The integers that lie between, nearest to where they should be, none beyond limit. False:
 * somewhere there is none; the value is then the nearest. No branch depends on a value, so that
 * compilers make vectors of it. */
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

static bool column_round(struct column *column, const struct bounds *b, double scale)
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

/* What the column leaves of from. */
static void column_leave(const struct column *column, const struct fit *fit, const float *from,
			 float *left)
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

/* Multiples of the line's own unit that lie between. */
static bool line_shorten(struct column *column, const struct bounds *b, int first, int count,
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

static uint8_t line_code(struct column *column, const struct bounds *b, int first, int count)
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
static void column_shorten(struct column *column, const struct bounds *b, int pixels)
{
	for (int c = 0; c < column->channels; c++)
		for (int p = 0; p < pixels; p += BASIS_LINE8) {
			const int count = pixels - p < BASIS_LINE8 ? pixels - p : BASIS_LINE8;

			column->code[p / BASIS_LINE8 * column->channels + c] =
				line_code(column, b, c * pixels + p, count);
		}
}

static void column_measure(struct column *column, int pixels)
{
	if (column->bits == 8)
		column->bytes = basis_record_bytes(column->code,
						   basis_record_lines(pixels, column->channels));
	else
		column->bytes = (size_t)(basis_panels16(pixels) * column->channels) * BASIS_ALIGN;
}

/* Takes the values nearest to from that keep the limits; left becomes what they leave. False: the
 * column's bits are too few. */
static bool column_take(struct column *column, const struct fit *fit, double reach,
			float short_share, const float *from, float *left)
{
	const struct part *part = fit->part;
	struct bounds b;
	double scale;

	bounds_find(&b, fit, column->number, column->channels, 1, from);
	scale = fmax(reach, (double)part_largest(b.needed, b.count)) / column_most(column->bits);
	if (scale < (double)FLT_MIN || !column_round(column, &b, scale))
		return false;
	column_leave(column, fit, from, left);
	if (!part_cell_holds(part, column->number, left))
		return false;
	/* U may not become negative, which the limits of residuals do not ensure */
	if (column->bits == 8 && part->kind != BASIS_KIND_U) {
		bounds_find(&b, fit, column->number, column->channels, short_share, from);
		column_shorten(column, &b, part->pixels);
		column_leave(column, fit, from, left);
	}
	column_measure(column, part->pixels);
	return true;
}

/* As short as it can be without a loss. */
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

/* To nearest. reach: of the largest value that can be stored. */
static void column_nearest(struct column *column, const float *from, int count, double reach)
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

static double reach_for(const struct fit *fit, int light, const float *left)
{
	const struct part *part = fit->part;
	const double largest = largest_of(left, part->rows);
	const double reach = fmax(largest / (double)part->light_share[light],
				  ALONE * fit->cut_share * part->column_cut);

	/* a larger value would be refused itself */
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

/* The nearest column of 8 bits, or of 16, whatever it leaves. */
static void column_take_nearest(struct column *column, const struct fit *fit, double reach,
				const float *from, float *left)
{
	const int pixels = fit->part->pixels, count = column->channels * pixels;
	float one[PART_ROWS];
	const float *value = from;

	if (column->channels < fit->part->channels) {
		fit_untint(fit, from, one);
		value = one;
	}
	column_nearest(column, value, count, fmax(reach, largest_of(value, count)));
	column_leave(column, fit, from, left);
	column_measure(column, pixels);
}

/* What the first column leaves takes a second one, which only strong light needs. */
static bool take_second(struct columns *columns, const struct fit *fit, int light, int channels,
			int bits, float short_share, const float *left)
{
	const double reach = reach_for(fit, light, left);
	struct column *column = columns_add(columns, light, channels, bits, true);
	float rest[PART_ROWS];

	if (column_take(column, fit, reach, short_share, left, rest))
		return true;
	if (bits == 16)
		column_take_nearest(column, fit, reach, left, rest);
	else
		columns->count--;
	return false;
}

/* In order of cost: 8 bits, twice 8 bits, each of one channel before three; 16 bits; twice. Lights
 * that shine along the ground need the last: what the object sends there is many times what they
 * do, and its shadow is as dark as any. */
static void light_columns(struct columns *columns, const struct fit *fit, int light,
			  float short_share)
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
		if (column_take(column, fit, reach, short_share, from, left))
			return;
		column_take_nearest(column, fit, reach, from, left);
		if (part->column_cut > 0 &&
		    take_second(columns, fit, light, channels, 8, short_share, left))
			return;
		columns->count--;
	}
	column = columns_add(columns, light, part->channels, 16, false);
	if (column_take(column, fit, reach, 0, from, left))
		return;
	column_take_nearest(column, fit, reach, from, left);
	if (!take_second(columns, fit, light, part->channels, 8, short_share, left))
		take_second(columns, fit, light, part->channels, 16, 0, left);
}

/* ---- the columns of groups ---- */

/* Sums the columns of a group's lights, times their shares. Returns how many lights have some. */
static int group_sum(const struct columns *columns, int lights, const struct fit *fit, int channels,
		     int group, float *value, double *reach)
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
		by = (float)part->share[column->number] * column->scale;
		found += !column->second;
		*reach += column->second ? 0 : (double)by * column_most(column->bits);
		for (int r = 0; r < count; r++)
			value[r] += by * (float)column->value[r];
	}
	return found;
}

/* A group's column has 8 bits, whatever its lights need, as its light is never large
 * (BASIS_GROUP_MOST); 16 where it reaches beyond GROUP_NARROW, as that of a mirror does, or
 * where the block's cut is fine. */
static void group_column(struct columns *columns, int lights, const struct fit *fit, int channels,
			 int group)
{
	const struct part *part = fit->part;
	const int count = channels * part->pixels;
	float value[PART_ROWS];
	struct column *column;
	double reach, largest;

	if (group_sum(columns, lights, fit, channels, group, value, &reach) < COLUMN_GROUP_LIGHTS ||
	    reach < fit->cut_share * COLUMN_GROUP_REACH)
		return;
	largest = largest_of(value, count);
	/* What nearly all lights of a tile are off by together its groups have to put right. */
	if (fit->cut_share < 1)
		largest = fmin(fmax(largest, reach), REACH_LIMIT);
	column = columns_add(columns, fit->settings->lights + group, channels,
			     largest > fit->cut_share * GROUP_NARROW ? 16 : 8, false);
	column_nearest(column, value, count, largest);
	column_measure(column, part->pixels);
}

void columns_find(struct columns *columns, const struct fit *fit, float short_share)
{
	const int groups = fit->part->share ? fit->settings->groups->count : 0;
	int lights;

	columns->count = 0;
	for (int i = 0; i < fit->settings->lights; i++)
		light_columns(columns, fit, i, short_share);
	lights = columns->count;
	for (int group = 0; group < groups; group++)
		for (int channels = 1; channels <= 3; channels += 2)
			group_column(columns, lights, fit, channels, group);
}
