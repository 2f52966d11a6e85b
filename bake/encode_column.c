/* A light's own columns: the cheapest that bring what patterns leave of it inside what may be left.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode_split.h"

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
/* A scale is a float, and what the compositor multiplies it by as well. */
#define REACH_ROUNDING 1e-6

/* What column->value, of one channel or three, leaves of wanted. */
static void leave_column(const struct split *split, bool mono, const float *wanted,
			 const struct split_column *column, float *left)
{
	const int pixels = split->part->pixels;

	for (int c = 0; c < split->part->channels; c++) {
		const int16_t *value = column->value + (mono ? 0 : c * pixels);
		const float *share = split->tint_share[c];

		for (int p = 0; p < pixels; p++) {
			const float is = column->scale * (float)value[p];

			left[c * pixels + p] = wanted[c * pixels + p] - (mono ? share[p] * is : is);
		}
	}
}

/* Multiples of unit, at most most. Where the scale is too small to be stored, it is 0, and so are
 * they. */
static void quantise(const float *from, int count, double scale, int most, int unit,
		     struct split_column *column)
{
	const bool nothing = !(scale >= (double)FLT_MIN);
	const float by = nothing ? 0 : (float)(1 / scale / unit), limit = (float)(most / unit);

	column->scale = nothing ? 0 : (float)scale;
	for (int k = 0; k < count; k++) {
		const float is = by * from[k];
		const float inside = is > limit ? limit : is < -limit ? -limit : is;

		column->value[k] = (int16_t)((int)(inside + ROUNDING - ROUNDING) * unit);
	}
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
	const size_t first = (size_t)light * (size_t)part->rows;

	b->count = mono ? pixels : part->rows;
	b->needed = 0;
	for (int c = 0; c < part->channels; c++)
		for (int p = 0; p < pixels; p++) {
			const int r = c * pixels + p, k = mono ? p : r;
			const float share = mono ? split->tint_share[c][p] : 1;
			const float per = share > DARKEST_TINT ? 1 / share : 1 / DARKEST_TINT;
			const float low = per *
					  (wanted[r] - spent * part->most_left[first + (size_t)r]);
			const float high =
				per * (wanted[r] - spent * part->least_left[first + (size_t)r]);
			const bool fresh = !mono || !c;

			b->least[k] = fresh || low > b->least[k] ? low : b->least[k];
			b->most[k] = fresh || high < b->most[k] ? high : b->most[k];
		}
	for (int k = 0; k < b->count; k++) {
		b->needed = b->least[k] > b->needed ? b->least[k] : b->needed;
		b->needed = -b->most[k] > b->needed ? -b->most[k] : b->needed;
	}
}

/* The nearest integers that lie between. False: somewhere there is none. */
static bool quantise_between(const struct between *b, const float *from, double scale, int most,
			     struct split_column *column)
{
	const float by = (float)(1 / scale), limit = (float)most;

	if (!(scale >= (double)FLT_MIN))
		return false;
	column->scale = (float)scale;
	for (int k = 0; k < b->count; k++) {
		const float low = by * b->least[k] > -limit ? by * b->least[k] : -limit;
		const float high = by * b->most[k] < limit ? by * b->most[k] : limit;
		const float best = by * from[k];
		const float inside = best < low ? low : best > high ? high : best;
		float is = (inside > limit ? limit : inside) + ROUNDING - ROUNDING;

		is += is < low ? 1 : is > high ? -1 : 0;
		if (!(is >= low && is <= high))
			return false;
		column->value[k] = (int16_t)is;
	}
	return true;
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

/* Some of a column's values: those of one line. */
struct shortened {
	int count;
	int place[BASIS_LINE8]; /* in struct between */
};

/* Multiples of the line's own unit that lie between, as near as may be; 0 where none does. */
static bool shorten_by(const struct between *b, const struct shortened *line, const float *from,
		       int factor, struct split_column *column)
{
	const float by = 1 / (column->scale * (float)factor);
	int16_t value[BASIS_LINE8];

	for (int n = 0; n < line->count; n++) {
		const int k = line->place[n];
		const float low = fmaxf(by * b->least[k], -HALF_MOST);
		const float high = fminf(by * b->most[k], HALF_MOST);
		float is = fminf(fmaxf(by * from[k], low), high) + ROUNDING - ROUNDING;

		is += is < low ? 1 : is > high ? -1 : 0;
		if (!(is >= low && is <= high))
			return false;
		value[n] = (int16_t)((int)is * factor);
	}
	for (int n = 0; n < line->count; n++)
		column->value[line->place[n]] = value[n];
	return true;
}

static uint8_t shorten_line(const struct between *b, const struct shortened *line,
			    const float *from, struct split_column *column)
{
	float needed = 0;

	for (int n = 0; n < line->count; n++) {
		needed = fmaxf(needed, b->least[line->place[n]]);
		needed = fmaxf(needed, -b->most[line->place[n]]);
	}
	if (!(needed > 0)) {
		for (int n = 0; n < line->count; n++)
			column->value[line->place[n]] = 0;
		return 0;
	}
	for (int factor = 1; factor <= BASIS_LINE_FACTOR_MAX; factor++)
		if (column->scale * (float)factor * HALF_MOST >= needed &&
		    shorten_by(b, line, from, factor, column))
			return (uint8_t)factor;
	return BASIS_LINE_WHOLE;
}

/* Stores each line of a column that does as shortly as what it leaves may be. from: what it stands
 * for, of one channel or three. */
static void shorten(const struct split *split, bool mono, int light, const float *wanted,
		    const float *from, float *left, struct split_column *column)
{
	const struct part *part = split->part;
	const int channels = mono ? 1 : 3, panels = basis_panels8(part->kept);
	const struct split_column whole = *column;
	struct between b;

	memset(column->code, BASIS_LINE_WHOLE, sizeof(column->code));
	/* Of light that may not be negative 0 is not always right where it is near enough. */
	if (part->kind == BASIS_KIND_U || !(split->spent > 0) || !(column->scale > 0))
		return;
	find_between(split, mono, light, split->spent, wanted, &b);
	for (int c = 0; c < channels; c++)
		for (int p = 0, panel = 0; panel < panels; panel++) {
			struct shortened line = {.count = 0};

			for (; p < part->pixels && line.count < BASIS_LINE8; p++)
				if (part->keep[p])
					line.place[line.count++] = c * part->pixels + p;
			column->code[panel * channels + c] = shorten_line(&b, &line, from, column);
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

/* Whether a column of this form that reaches so far does for wanted; left becomes what it leaves.
 */
static bool try_form(const struct split *split, enum column_form form, int light, double reach,
		     const float *wanted, float *left, struct split_column *column)
{
	const int pixels = split->part->pixels, most = column_most(form);
	const bool mono = column_channels(form) == 1, narrow = most == INT8_MAX;
	const int count = mono ? pixels : split->part->rows;
	float one[PART_PIXELS];
	const float *from = in_channels(split, mono, wanted, one);
	double largest = reach;
	bool found = false;

	for (int k = 0; k < count; k++)
		largest = fmax(largest, (double)fabsf(from[k]));
	column->form = form;
	for (int k = 0; !found && k < (narrow ? SCALES : COARSEST_BITS + 1); k++) {
		const int unit = narrow ? 1 : 1 << (COARSEST_BITS - k);
		const double wider = narrow ? 1 + SCALE_STEP * k : 1;

		quantise(from, count, largest / (most / unit * unit) * wider, most, unit, column);
		leave_column(split, mono, wanted, column, left);
		found = part_cell_holds(split->part, light, left);
	}
	if (!found && narrow)
		found = try_between(split, mono, light, reach, wanted, from, left, column);
	if (found && narrow)
		shorten(split, mono, light, wanted, from, left, column);
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
	double largest = reach;

	for (int k = 0; k < count; k++)
		largest = fmax(largest, (double)fabsf(from[k]));
	quantise(from, count, largest / most, most, 1, column);
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

static bool try_two(const struct split *split, bool mono, int light, double reach,
		    const float *wanted, float *left, struct split_column *column)
{
	const enum column_form first = mono ? COLUMN_MONO8 : COLUMN_COLOUR8;
	const enum column_form second = mono ? COLUMN_MONO_REST : COLUMN_COLOUR_REST;
	float *rest = left + split->part->rows;
	double farther;

	take_nearest(split, first, reach, wanted, left, &column[0]);
	farther = reach_for(split, light, left);
	if (try_form(split, second, light, farther, left, rest, &column[1]))
		return true;
	take_nearest(split, second, farther, left, rest, &column[1]);
	return false;
}

int split_find_columns(const struct split *split, int light, float *left,
		       struct split_column column[LIGHT_COLUMNS_MAX])
{
	const double reach = reach_for(split, light, left);
	float wanted[PART_ROWS];
	int count = 0;

	memcpy(wanted, left, (size_t)split->part->rows * sizeof(*left));
	/* By what they cost. */
	for (int channels = 1; channels <= 3; channels += 2) {
		const bool mono = channels == 1;
		const enum column_form narrow = mono ? COLUMN_MONO8 : COLUMN_COLOUR8;
		const enum column_form wide = mono ? COLUMN_MONO16 : COLUMN_COLOUR16;

		if (mono ? !split->mono : !split->colour)
			continue;
		if (!split->wide[!mono] &&
		    try_form(split, narrow, light, reach, wanted, left, column))
			return 1;
		count = split->whole[!mono] ? 1 : 2;
		if (count == 1 ? try_form(split, wide, light, reach, wanted, left, column)
			       : try_two(split, mono, light, reach, wanted, left, column))
			break;
	}
	return count;
}
