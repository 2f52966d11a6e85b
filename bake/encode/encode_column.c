/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_column.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode/encode_expose.h"

/* Added to a number below 2^22 and taken away again, it leaves the nearest integer. */
#define ROUNDING 0x1.8p23F
/* Scales that are tried for 8 bits: the finest, and some coarser ones that may happen to round
 * every value well enough. */
#define SCALES 16
#define SCALE_STEP 0.01
/* Columns of 16 bits are rounded to multiples of a power of two, the largest that does: lower bits
 * that nobody needs are noise, which does not pack. */
#define COARSEST_BITS 7
/* A channel that is tinted darker is as good as black. */
#define DARKEST_TINT 1e-9F
/* The largest value of a line of half bytes. */
#define HALF_MOST 7.0F
/* So many pixels are tried at a time. */
#define TRIED_PIXELS 32
/* A scale is a float, and what the compositor multiplies it by as well. */
#define REACH_ROUNDING 1e-6

/* What column->value, of one channel or three, leaves of some pixels of one channel of wanted. */
static void leave_channel(const struct split *split, bool mono, int channel, int from, int to,
			  const float *wanted, const struct split_column *column, float *left)
{
	const size_t first = (size_t)(channel * split->part->pixels);
	const int16_t *value = column->value + (mono ? 0 : first);
	const float *share = split->tint_share[channel];

	for (int p = from; p < to; p++) {
		const float is = column->scale * (float)value[p];

		left[first + p] = wanted[first + p] - (mono ? share[p] * is : is);
	}
}

static void leave_column(const struct split *split, bool mono, const float *wanted,
			 const struct split_column *column, float *left)
{
	for (int c = 0; c < split->part->channels; c++)
		leave_channel(split, mono, c, 0, split->part->pixels, wanted, column, left);
}

/* How values become integers: multiples of unit, at most most. Where the scale is too small to be
 * stored, it is 0, and so are they. */
struct steps {
	float scale, by, limit;
	int unit;
};

static struct steps steps_of(double scale, int most, int unit)
{
	const bool nothing = !(scale >= (double)FLT_MIN);

	return (struct steps){
		.scale = nothing ? 0 : (float)scale,
		.by = nothing ? 0 : (float)(1 / scale / unit),
		.limit = (float)(most / unit),
		.unit = unit,
	};
}

static void column_quantise(const struct steps *steps, const float *from, int count, int16_t *value)
{
	const float by = steps->by, limit = steps->limit;

	for (int k = 0; k < count; k++) {
		const float is = by * from[k];
		const float inside = is > limit ? limit : is < -limit ? -limit : is;

		value[k] = (int16_t)((int)(inside + ROUNDING - ROUNDING) * steps->unit);
	}
}

/* To nearest; left becomes what that leaves. */
static void take_steps(const struct split *split, bool mono, const struct steps *steps,
		       const float *wanted, const float *from, float *left,
		       struct split_column *column)
{
	const int pixels = split->part->pixels;

	column->scale = steps->scale;
	column_quantise(steps, from, mono ? pixels : split->part->rows, column->value);
	leave_column(split, mono, wanted, column, left);
}

/* The same, a few pixels at a time, as long as what it leaves may be left: steps that do not do are
 * mostly found out by the first. */
static bool try_steps(const struct split *split, bool mono, int light, const struct steps *steps,
		      const float *wanted, const float *from, float *left,
		      struct split_column *column)
{
	const struct part *part = split->part;
	const int pixels = part->pixels;

	column->scale = steps->scale;
	for (int p = 0; p < pixels; p += TRIED_PIXELS) {
		const int end = p + TRIED_PIXELS < pixels ? p + TRIED_PIXELS : pixels;

		for (int c = 0; c < part->channels; c++) {
			const int at = mono ? p : c * pixels + p;

			if (!mono || !c)
				column_quantise(steps, from + at, end - p, column->value + at);
			leave_channel(split, mono, c, p, end, wanted, column, left);
			if (!part_pixels_hold(part, light, c, p, end, left))
				return false;
		}
	}
	return true;
}

/* Between what each value of a column has to be, so that what it leaves may be left. */
struct between {
	int count;
	float least[PART_ROWS], most[PART_ROWS];
	float needed; /* no column does that does not reach so far */
};

/* spent: the share of what may be left. Of one channel: what does for all three, tinted. */
static void find_between(const struct split *split, bool mono, int light, float spent,
			 const float *wanted, struct between *b)
{
	const struct part *part = split->part;
	const int pixels = part->pixels;

	b->count = mono ? pixels : part->rows;
	for (int c = 0; c < part->channels; c++) {
		const size_t row = (size_t)(c * pixels);
		const size_t first = (size_t)light * (size_t)part->rows + row;
		const float *least_left = part->least_left + first;
		const float *most_left = part->most_left + first;
		const float *own = wanted + row, *tint = split->tint_share[c];
		float *least = b->least + (mono ? 0 : row), *most = b->most + (mono ? 0 : row);
		const bool again = mono && c;

		for (int p = 0; p < pixels; p++) {
			const float share = mono ? tint[p] : 1;
			const float per = 1 / larger(share, DARKEST_TINT);
			const float low = per * (own[p] - spent * most_left[p]);
			const float high = per * (own[p] - spent * least_left[p]);

			least[p] = again ? larger(low, least[p]) : low;
			most[p] = again ? smaller(high, most[p]) : high;
		}
	}
	b->needed = larger(part_largest(b->least, b->count, 1),
			   part_largest(b->most, b->count, -1));
}

/* The nearest integers that lie between, none beyond limit. False: somewhere there is none. No
 * branch depends on a value, so that compilers make vectors of it. */
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

static bool quantise_between(const struct between *b, const float *from, double scale, int most,
			     struct split_column *column)
{
	const float by = (float)(1 / scale);
	bool fine = scale >= (double)FLT_MIN;

	column->scale = (float)scale;
	for (int k = 0; fine && k < b->count; k += TRIED_PIXELS) {
		const int count = k + TRIED_PIXELS < b->count ? TRIED_PIXELS : b->count - k;

		fine = round_between(b->least + k, b->most + k, from + k, count, by, (float)most,
				     column->value + k);
	}
	return fine;
}

/* Rounded to what is nearest, some values may be off by more than they may, although others that
 * the form has would not be. */
static bool try_between(const struct split *split, bool mono, int light, double reach,
			const float *wanted, const float *from, float *left,
			struct split_column *column)
{
	const int most = column_most(column->form);
	struct between b;

	find_between(split, mono, light, 1, wanted, &b);
	for (int k = 0; k < SCALES; k++) {
		const double scale = fmax(reach, (double)b.needed) / most * (1 + SCALE_STEP * k);

		if (!quantise_between(&b, from, scale, most, column))
			continue;
		leave_column(split, mono, wanted, column, left);
		if (part_cell_holds(split->part, light, left))
			return true;
	}
	return false;
}

/* ---- how short a column of 8 bits may be ---- */

/* Some of a column's values, those of one line: where they are, and what they may be. */
struct shortened {
	int count;
	int place[BASIS_LINE8];
	float least[BASIS_LINE8], most[BASIS_LINE8], from[BASIS_LINE8];
};

static void add_value(struct shortened *line, const struct between *b, const float *from, int place)
{
	const int n = line->count++;

	line->place[n] = place;
	line->least[n] = b->least[place];
	line->most[n] = b->most[place];
	line->from[n] = from[place];
}

/* Multiples of the line's own unit that lie between, as near as may be. False: somewhere there is
 * none. */
static bool shorten_by(const struct shortened *line, int factor, struct split_column *column)
{
	const float by = 1 / (column->scale * (float)factor);
	int16_t value[BASIS_LINE8];

	if (!round_between(line->least, line->most, line->from, line->count, by, HALF_MOST, value))
		return false;
	for (int n = 0; n < line->count; n++)
		column->value[line->place[n]] = (int16_t)(value[n] * factor);
	return true;
}

static uint8_t shorten_line(const struct shortened *line, struct split_column *column)
{
	const float needed = larger(part_largest(line->least, line->count, 1),
				    part_largest(line->most, line->count, -1));

	if (!(needed > 0)) {
		for (int n = 0; n < line->count; n++)
			column->value[line->place[n]] = 0;
		return 0;
	}
	for (int factor = 1; factor <= BASIS_LINE_FACTOR_MAX; factor++)
		if (column->scale * (float)factor * HALF_MOST >= needed &&
		    shorten_by(line, factor, column))
			return (uint8_t)factor;
	return BASIS_LINE_WHOLE;
}

/* Stores each line of a column that does as shortly as what it leaves may be. from: what it stands
 * for, of one channel or three. */
static void column_shorten(const struct split *split, bool mono, int light, const float *wanted,
			   const float *from, float *left, struct split_column *column)
{
	const struct part *part = split->part;
	const int channels = mono ? 1 : 3, panels = basis_panels8(part->kept);
	const struct split_column whole = *column;
	struct between b;

	memset(column->code, BASIS_LINE_WHOLE, sizeof(column->code));
	/* U may not become negative, which the limits of residuals do not ensure */
	if (part->kind == BASIS_KIND_U || !(split->spent > 0) || !(column->scale > 0))
		return;
	find_between(split, mono, light, split->spent, wanted, &b);
	for (int c = 0; c < channels; c++)
		for (int p = 0, panel = 0; panel < panels; panel++) {
			struct shortened line;

			for (line.count = 0; p < part->pixels && line.count < BASIS_LINE8; p++)
				if (part->keep[p])
					add_value(&line, &b, from, c * part->pixels + p);
			column->code[panel * channels + c] = shorten_line(&line, column);
		}
	leave_column(split, mono, wanted, column, left);
	if (part_cell_holds(part, light, left))
		return;
	*column = whole;
	memset(column->code, BASIS_LINE_WHOLE, sizeof(column->code));
	leave_column(split, mono, wanted, column, left);
}

static size_t column_bytes(const struct part *part, const struct split_column *column)
{
	const int channels = column_channels(column->form);

	if (column_most(column->form) == INT8_MAX)
		return basis_record_bytes(column->code, basis_record_lines(part->kept, channels));
	return (size_t)(basis_panels16(part->kept) * channels) * BASIS_ALIGN;
}

/* wanted, in as many channels as a column has. */
static const float *in_channels(const struct split *split, bool mono, const float *wanted,
				float *one)
{
	if (!mono || !split->colour)
		return wanted;
	split_untint(split, wanted, one);
	return one;
}

/* The largest magnitude, or reach if that is more. */
static double farthest_value(const float *from, int count, double reach)
{
	const float most = larger(part_largest(from, count, 1), part_largest(from, count, -1));

	return fmax(reach, (double)most);
}

/* Whether a column of this form that reaches so far does for wanted; left becomes what it leaves,
 * or, of 16 bits, what the finest leaves if none does. */
static bool try_form(const struct split *split, enum column_form form, int light, double reach,
		     const float *wanted, float *left, struct split_column *column)
{
	const int pixels = split->part->pixels, most = column_most(form);
	const bool mono = column_channels(form) == 1, narrow = most == INT8_MAX;
	const int count = mono ? pixels : split->part->rows;
	float one[PART_PIXELS];
	const float *from = in_channels(split, mono, wanted, one);
	const double largest = farthest_value(from, count, reach);
	struct steps steps;
	bool found = false;

	column->form = form;
	for (int k = 0; !found && k < (narrow ? SCALES : COARSEST_BITS + 1); k++) {
		const int unit = narrow ? 1 : 1 << (COARSEST_BITS - k);
		const double wider = narrow ? 1 + SCALE_STEP * k : 1;

		steps = steps_of(largest / (most / unit * unit) * wider, most, unit);
		found = try_steps(split, mono, light, &steps, wanted, from, left, column);
	}
	if (!found && narrow)
		found = try_between(split, mono, light, reach, wanted, from, left, column);
	else if (!found)
		take_steps(split, mono, &steps, wanted, from, left, column);
	if (found && narrow)
		column_shorten(split, mono, light, wanted, from, left, column);
	if (found || !narrow)
		column->bytes = column_bytes(split->part, column);
	return found;
}

/* As short as it can be without a loss. */
static void shorten_exactly(const struct split *split, struct split_column *column)
{
	const struct part *part = split->part;
	const int channels = column_channels(column->form), panels = basis_panels8(part->kept);

	for (int c = 0; c < channels; c++)
		for (int p = 0, panel = 0; panel < panels; panel++) {
			int most = 0;

			for (int k = 0; p < part->pixels && k < BASIS_LINE8; p++) {
				const int value = column->value[c * part->pixels + p];

				if (!part->keep[p])
					continue;
				most = abs(value) > most ? abs(value) : most;
				k++;
			}
			column->code[panel * channels + c] = !most ? 0
							     : most <= (int)HALF_MOST
								     ? 1
								     : BASIS_LINE_WHOLE;
		}
}

void split_take_column(const struct split *split, const float *from, double reach,
		       struct split_column *column)
{
	const int count = column_channels(column->form) * split->part->pixels;
	const int most = column_most(column->form);
	const struct steps steps = steps_of(farthest_value(from, count, reach) / most, most, 1);

	column->scale = steps.scale;
	column_quantise(&steps, from, count, column->value);
	if (most == INT8_MAX)
		shorten_exactly(split, column);
	column->bytes = column_bytes(split->part, column);
}

/* ---- all that a light needs ---- */

static double reach_for(const struct split *split, int light, const float *left)
{
	return part_column_reach(split->part, light, left) * (1 + REACH_ROUNDING);
}

/* To nearest. */
static void take_nearest(const struct split *split, enum column_form form, double reach,
			 const float *wanted, float *left, struct split_column *column)
{
	const bool mono = column_channels(form) == 1;
	float one[PART_PIXELS];

	column->form = form;
	split_take_column(split, in_channels(split, mono, wanted, one), reach, column);
	leave_column(split, mono, wanted, column, left);
}

/* The second column, of what the first leaves: left [2][rows]. */
static bool try_rest(const struct split *split, bool mono, int light, float *left,
		     struct split_column *column)
{
	const enum column_form form = mono ? COLUMN_MONO_REST : COLUMN_COLOUR_REST;
	const double reach = reach_for(split, light, left);
	float *rest = left + split->part->rows;

	if (try_form(split, form, light, reach, left, rest, column))
		return true;
	take_nearest(split, form, reach, left, rest, column);
	return false;
}

static bool try_two(const struct split *split, bool mono, int light, double reach,
		    const float *wanted, float *left, struct split_column *column)
{
	take_nearest(split, mono ? COLUMN_MONO8 : COLUMN_COLOUR8, reach, wanted, left, column);
	return try_rest(split, mono, light, left, column + 1);
}

/* Lights that shine along the ground: what the object sends there is many times what they do, and
 * its shadow is as dark as any; or they hardly reach a tile whose patterns are made for others. */
static int take_widest(const struct split *split, bool mono, int light, double reach,
		       const float *wanted, float *left, struct split_column *column)
{
	if (try_form(split, mono ? COLUMN_MONO16 : COLUMN_COLOUR16, light, reach, wanted, left,
		     column))
		return 1;
	if (!try_rest(split, mono, light, left, column + 1))
		try_form(split, mono ? COLUMN_MONO_REST16 : COLUMN_COLOUR_REST16, light,
			 reach_for(split, light, left), left, left + split->part->rows, column + 1);
	return 2;
}

int split_find_columns(const struct split *split, int light, float *left,
		       struct split_column column[LIGHT_COLUMNS_MAX])
{
	const double reach = reach_for(split, light, left);
	float wanted[PART_ROWS];

	memcpy(wanted, left, (size_t)split->part->rows * sizeof(*left));
	/* in order of cost */
	for (int channels = 1; channels <= 3; channels += 2) {
		const bool mono = channels == 1;
		const enum column_form narrow = mono ? COLUMN_MONO8 : COLUMN_COLOUR8;
		const enum column_form wide = mono ? COLUMN_MONO16 : COLUMN_COLOUR16;

		if (mono ? !split->mono : !split->colour)
			continue;
		if (!split->wide[!mono] &&
		    try_form(split, narrow, light, reach, wanted, left, column))
			return 1;
		if (split->whole[!mono] ? try_form(split, wide, light, reach, wanted, left, column)
					: try_two(split, mono, light, reach, wanted, left, column))
			return split->whole[!mono] ? 1 : 2;
	}
	return take_widest(split, !split->colour, light, reach, wanted, left, column);
}
