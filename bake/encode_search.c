#include "bake/encode_search.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"

static const int ranks[] = {0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, RANK_MOST};
#define RANKS ((int)(sizeof(ranks) / sizeof(*ranks)))
/* How often the two ranks are improved in turn, and from where. */
#define TURNS 2
#define FIRST_RANK 4
/* Ranks in a row that are worse than the best before a search gives up. */
#define PATIENCE 4
/* Three channels without a tint are tried where one light in so many has a hue of its own. */
#define HUE_SHARE 16

int search_create(struct search *s, const struct encode_settings *settings,
		  const struct levels *levels)
{
	const size_t skies = (size_t)settings->ensemble->skies;

	*s = (struct search){.settings = settings, .levels = levels, .target = settings->target};
	s->column_x = calloc(skies * 3 * (size_t)settings->lights, sizeof(*s->column_x));
	s->sky_x = calloc(skies * 3 * (size_t)settings->lights, sizeof(*s->sky_x));
	s->sky_sum = calloc(skies * PART_ROWS, sizeof(*s->sky_sum));
	s->sky_mono = calloc(skies * PART_PIXELS, sizeof(*s->sky_mono));
	return s->column_x && s->sky_x && s->sky_sum && s->sky_mono ? 0 : -ENOMEM;
}

void search_free(struct search *s)
{
	free(s->sky_x);
	free(s->column_x);
	free(s->column_left);
	free(s->sky_sum);
	free(s->sky_mono);
	*s = (struct search){.settings = NULL};
}

int plan_blocks(const struct plan *plan, struct plan_block *blocks)
{
	int count = 0;

	for (int colour = 0; colour < 2; colour++) {
		const enum column_form narrow = colour ? COLUMN_COLOUR8 : COLUMN_MONO8;
		const enum column_form wide = colour ? COLUMN_COLOUR16 : COLUMN_MONO16;
		struct plan_block first = {.mono = !colour, .bits = 16, .form = COLUMN_NONE};

		first.patterns = colour ? plan->colour_rank : plan->mono_rank;
		first.columns = plan->columns[narrow] ? plan->columns[narrow] : plan->columns[wide];
		if (first.columns)
			first.form = plan->columns[narrow] ? narrow : wide;
		if (first.form == narrow)
			first.bits = 8;
		if (first.patterns || first.columns)
			blocks[count++] = first;
		if (plan->columns[narrow] && plan->columns[wide])
			blocks[count++] = (struct plan_block){.mono = !colour,
							      .bits = 16,
							      .form = wide,
							      .columns = plan->columns[wide]};
	}
	return count;
}

static void count_bytes(const struct search *s, const struct split *split, struct plan *plan)
{
	struct plan_block blocks[PLAN_BLOCKS_MAX];
	const int count = plan_blocks(plan, blocks);

	plan->bytes = plan->pattern_bytes = 0;
	for (int k = 0; k < count; k++) {
		const struct basis_block_entry entry = {
			.pixels = (uint16_t)split->part->kept,
			.channels = blocks[k].mono ? 1 : 3,
			.bits = (uint8_t)blocks[k].bits,
			.tinted = blocks[k].mono && split->tinted,
			.patterns = (uint16_t)blocks[k].patterns,
			.columns = (uint32_t)blocks[k].columns,
		};
		const struct basis_layout at = basis_layout(&entry, s->settings->coarse);

		plan->bytes += at.bytes;
		plan->pattern_bytes += at.light - at.pattern;
	}
}

/* The skies' light on what patterns leave goes, where the column is used, to what the column
 * leaves; size: of what it changes by at most, per unit of X. */
static void use_column(struct search *s, const struct part *part, int light, double size,
		       const float *left)
{
	const size_t n = (size_t)s->settings->lights, number = (size_t)s->used_columns++;
	const double cut = part_column_cut(part, s->settings);

	memcpy(s->column_left + number * (size_t)part->rows, left,
	       (size_t)part->rows * sizeof(*left));
	for (size_t k = 0; k < (size_t)s->settings->ensemble->skies; k++) {
		const float *x = part->sky_x + k * 3 * n + (size_t)light;
		const double most = (double)fmaxf(fmaxf(x[0], x[n]), x[2 * n]);

		for (size_t c = 0; c < 3; c++) {
			s->column_x[(k * 3 + c) * n + number] = 0;
			if (most * size < cut)
				continue;
			s->column_x[(k * 3 + c) * n + number] = x[c * n];
			s->sky_x[(k * 3 + c) * n + (size_t)light] = 0;
		}
	}
}

/* U may come out as 0, not less: the quotient's sign is that of a shadow. */
static bool negative(const struct part *part, int light, const float *left)
{
	const float *value = part->value + (size_t)light * (size_t)part->rows;
	float least = 0, most = 0;

	if (part->kind != BASIS_KIND_U)
		return false;
	for (int r = 0; r < part->rows; r++) {
		least = fminf(least, value[r] - left[r]);
		most = fmaxf(most, value[r]);
	}
	return least < -most / 254;
}

void search_column(const struct split *split, int light, float *left, struct split_column *column)
{
	column->form = COLUMN_NONE;
	split_left(split, light, left);
	if (!part_cell_holds(split->part, light, left) || negative(split->part, light, left))
		split_find_column(split, light, left, column);
}

static int reserve(struct search *s, const struct part *part)
{
	const size_t wanted = (size_t)s->settings->lights * (size_t)part->rows;

	if (wanted <= s->left_room)
		return 0;
	free(s->column_left);
	s->left_room = 0;
	s->column_left = malloc(wanted * sizeof(*s->column_left));
	if (!s->column_left)
		return -ENOMEM;
	s->left_room = wanted;
	return 0;
}

static void choose_columns(struct search *s, const struct split *split, struct plan *plan)
{
	const struct part *part = split->part;
	const int n = s->settings->lights;
	const size_t rows = (size_t)s->settings->ensemble->skies * 3;
	float left[PART_ROWS];

	memcpy(s->sky_x, part->sky_x, rows * (size_t)n * sizeof(*s->sky_x));
	memset(plan->columns, 0, sizeof(plan->columns));
	s->used_columns = 0;
	for (int i = 0; i < n; i++) {
		struct split_column column;

		search_column(split, i, left, &column);
		if (column.form != COLUMN_NONE)
			use_column(s, part, i, (double)column.scale * column_most(column.form),
				   left);
		plan->columns[column.form]++;
	}
}

/* What the skies' light makes of what is left. */
static void sum_left(struct search *s, const struct split *split)
{
	const struct part *part = split->part;
	const int n = s->settings->lights, skies = s->settings->ensemble->skies;
	const int pixels = part->pixels;

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
				    s->used_columns, 1, s->column_x + (size_t)c * (size_t)n, 3 * n,
				    s->column_left + (part->channels == 3 ? c * pixels : 0),
				    part->rows, 1, to, 3 * pixels);
	}
}

static double excess_of(struct search *s, const struct split *split)
{
	const struct part *part = split->part;
	double worst_square = 0, worst = 0;

	sum_left(s, split);
	for (int k = 0; k < s->settings->ensemble->skies; k++) {
		double square = 0;

		for (int r = 0; r < 3 * part->pixels; r++) {
			const int c = r / part->pixels, at = k * 3 * part->pixels + r;
			const float is = part->sky_offset[k][c] +
					 part->sky_slope[k][c] * part->sky_base[at];
			const float by = part->sky_slope[k][c] * s->sky_sum[at];
			const double levels = fabs(
				(double)(level_of(s->levels, is) - level_of(s->levels, is - by)));

			square += levels * levels;
			worst = fmax(worst, levels);
		}
		worst_square = fmax(worst_square, square);
	}
	return fmax(sqrt(worst_square / (3 * part->pixels)) / s->target.rms, worst / s->target.max);
}

static void evaluate(struct search *s, struct split *split, int mono_rank, int colour_rank,
		     struct plan *plan)
{
	split_set_ranks(split, s->settings->lights, mono_rank, colour_rank);
	plan->way = split->way;
	plan->mono_rank = split->mono ? split->mono_rank : 0;
	plan->colour_rank = split->colour ? split->colour_rank : 0;
	choose_columns(s, split, plan);
	count_bytes(s, split, plan);
	plan->excess = excess_of(s, split);
}

/* Patterns count twice: every frame reads them, and columns of bright lights alone. */
static double cost_of(const struct plan *plan)
{
	return (double)plan->bytes + (double)plan->pattern_bytes;
}

static bool better(const struct plan *a, const struct plan *b)
{
	if ((a->excess <= 1) != (b->excess <= 1))
		return a->excess <= 1;
	return a->excess <= 1 ? cost_of(a) < cost_of(b) : a->excess < b->excess;
}

/* Improves one of the two ranks. */
static void scan(struct search *s, struct split *split, bool mono, struct plan *best)
{
	const int other = mono ? best->colour_rank : best->mono_rank;
	int worse = 0;

	for (int k = 0; k < RANKS && worse < PATIENCE; k++) {
		struct plan plan;

		evaluate(s, split, mono ? ranks[k] : other, mono ? other : ranks[k], &plan);
		if (better(&plan, best)) {
			*best = plan;
			worse = 0;
		} else if (best->excess <= 1 && cost_of(&plan) > cost_of(best)) {
			worse++;
		}
		if (ranks[k] >= (mono ? split->mono_patterns.count : split->colour_patterns.count))
			break;
	}
}

static void search_split(struct search *s, struct split *split, struct plan *best)
{
	struct plan own;
	struct plan before;

	evaluate(s, split, split->mono ? FIRST_RANK : 0, split->colour ? FIRST_RANK : 0, &own);
	for (int turn = 0; turn < TURNS; turn++) {
		before = own;
		if (split->colour)
			scan(s, split, false, &own);
		if (split->mono)
			scan(s, split, true, &own);
		if (!better(&own, &before) || !split->colour || !split->mono)
			break;
	}
	if (better(&own, best))
		*best = own;
}

/* A tint does not do where many lights need columns of three channels. */
static bool hue_varies(const struct search *s, const struct plan *best)
{
	const int coloured = best->columns[COLUMN_COLOUR8] + best->columns[COLUMN_COLOUR16];

	return best->excess > 1 || coloured * HUE_SHARE > s->settings->lights;
}

int search_best(struct search *s, struct split *split, const struct part *part, struct plan *best)
{
	int err = reserve(s, part);

	if (!err)
		err = split_take(split, s->settings, part);
	if (err)
		return err;
	*best = (struct plan){.excess = INFINITY};
	for (int way = 0; way < SPLIT_WAYS; way++) {
		if (!split_possible(part, (enum split_way)way) ||
		    (way == SPLIT_PLAIN && !hue_varies(s, best)))
			continue;
		err = split_part(split, s->settings, (enum split_way)way);
		if (err)
			return err;
		search_split(s, split, best);
	}
	if (split->way != best->way) {
		err = split_part(split, s->settings, best->way);
		if (err)
			return err;
	}
	evaluate(s, split, best->mono_rank, best->colour_rank, best);
	return 0;
}
