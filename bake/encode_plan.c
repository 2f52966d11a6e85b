/* What a plan costs, and whether it holds. */
#include <cblas.h>
#include <math.h>
#include <string.h>

#include "bake/encode_search.h"
#include "hal/basis/basis_layout.h"

/* What a block costs a frame besides its bytes, in bytes: some 150 ns at 10 GB/s. */
#define BLOCK_COST 1500

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

uint32_t plan_record_bytes(const struct plan *plan, const struct plan_block *block)
{
	return block->bits == 8 ? (uint32_t)plan->column_bytes[block->form] : 0;
}

static void count_bytes(const struct search *s, const struct split *split, struct plan *plan)
{
	struct plan_block blocks[PLAN_BLOCKS_MAX];
	const int count = plan_blocks(plan, blocks);

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
			.record_bytes = plan_record_bytes(plan, &blocks[k]),
		};
		const struct basis_layout at = basis_layout(&entry, s->settings->coarse);

		plan->bytes += at.bytes;
		plan->pattern_bytes += at.light - at.pattern;
	}
}

/* The skies' light on what patterns leave goes, where the column is used, to what the column
 * leaves; size: of what it changes by at most, per unit of X. Under how many skies it is used. */
static int use_column(struct search *s, const struct part *part, int light, double size,
		      const float *left)
{
	const size_t n = (size_t)s->settings->lights, number = (size_t)s->used_columns++;
	const double cut = part->column_cut;
	int used = 0;

	memcpy(s->column_left + number * (size_t)part->rows, left,
	       (size_t)part->rows * sizeof(*left));
	for (size_t k = 0; k < (size_t)s->settings->ensemble->tried; k++) {
		const float *x = part->sky_x + k * 3 * n + (size_t)light;
		const double most = (double)fmaxf(fmaxf(x[0], x[n]), x[2 * n]);

		used += most * size >= cut;
		for (size_t c = 0; c < 3; c++) {
			s->column_x[(k * 3 + c) * n + number] = 0;
			if (most * size < cut)
				continue;
			s->column_x[(k * 3 + c) * n + number] = x[c * n];
			s->sky_x[(k * 3 + c) * n + (size_t)light] = 0;
		}
	}
	return used;
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

static void choose_columns(struct search *s, const struct split *split, struct plan *plan)
{
	const struct part *part = split->part;
	const int n = s->settings->lights;
	const size_t rows = (size_t)s->settings->ensemble->tried * 3;
	float left[PART_ROWS];

	memcpy(s->sky_x, part->sky_x, rows * (size_t)n * sizeof(*s->sky_x));
	memset(plan->columns, 0, sizeof(plan->columns));
	memset(plan->column_bytes, 0, sizeof(plan->column_bytes));
	plan->read = 0;
	s->used_columns = 0;
	for (int i = 0; i < n; i++) {
		struct split_column column;
		int used;

		search_column(split, i, left, &column);
		plan->columns[column.form]++;
		if (column.form == COLUMN_NONE)
			continue;
		plan->column_bytes[column.form] += column.bytes;
		used = use_column(s, part, i, (double)column.scale * column_most(column.form),
				  left);
		plan->read += used * (double)column.bytes / s->settings->ensemble->tried;
	}
}

/* What the skies' light makes of what is left. */
static void sum_left(struct search *s, const struct split *split)
{
	const struct part *part = split->part;
	const int n = s->settings->lights, skies = s->settings->ensemble->tried;
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
				fabsf(level_of(s->levels, is) - level_of(s->levels, is - by));

			square += (double)(levels * levels);
			if (levels > worst * part->sky_share[p])
				worst = levels / part->sky_share[p];
		}
		worst_square = fmax(worst_square, square);
	}
	return fmax(sqrt(worst_square / (3 * part->pixels)) / s->target.rms,
		    (double)worst / s->target.max);
}

double plan_cost(const struct plan *plan)
{
	return (double)plan->bytes + (double)plan->pattern_bytes + plan->read +
	       BLOCK_COST * plan->blocks;
}

bool plan_better(const struct plan *a, const struct plan *b)
{
	if ((a->excess <= 1) != (b->excess <= 1))
		return a->excess <= 1;
	return a->excess <= 1 ? plan_cost(a) < plan_cost(b) : a->excess < b->excess;
}

void plan_evaluate(struct search *s, struct split *split, int mono_rank, int colour_rank,
		   const struct plan *best, struct plan *plan)
{
	split_set_ranks(split, s->settings->lights, mono_rank, colour_rank);
	plan->way = split->way;
	plan->wide[0] = split->wide[0];
	plan->wide[1] = split->wide[1];
	plan->mono_rank = split->mono ? split->mono_rank : 0;
	plan->colour_rank = split->colour ? split->colour_rank : 0;
	choose_columns(s, split, plan);
	count_bytes(s, split, plan);
	/* The skies take longest, and do not matter where it is dearer anyway. */
	plan->excess = INFINITY;
	if (!best || best->excess > 1 || plan_cost(plan) < plan_cost(best))
		plan->excess = excess_of(s, split);
}
