/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "tests/kernels/compare_parts.h"

const char *const kernel_function_names[FUNCTIONS] = {"sums16", "sums8",   "values16", "values8",
						      "split",	"project", "fold",     "tint",
						      "place",	"mix",	   "grain",    "divide"};

uint64_t compare_next(struct comparison *c) /* splitmix64 */
{
	uint64_t x = c->state += UINT64_C(0x9e3779b97f4a7c15);

	x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
	return x ^ x >> 31;
}

int compare_below(struct comparison *c, int n)
{
	return (int)(compare_next(c) % (uint64_t)n);
}

int compare_between(struct comparison *c, int low, int high)
{
	return low + compare_below(c, high - low + 1);
}

int64_t compare_spread(struct comparison *c, int bits)
{
	const int64_t x = (int64_t)(compare_next(c) >> 1 >> (63 - compare_below(c, bits + 1)));

	return compare_below(c, 2) ? x : -x;
}

int compare_value(struct comparison *c, enum filling filling, int i, int low, int high)
{
	switch (filling) {
	case LOWEST:
		return low;
	case HIGHEST:
		return high;
	case EXTREMES:
		return compare_below(c, 2) ? low : high;
	case ALTERNATING:
		return i % 2 ? low : high;
	case ZEROS:
		return 0;
	default:
		return compare_between(c, low, high);
	}
}

void compare_fill16(struct comparison *c, void *to, int count, int low, int high)
{
	const enum filling filling = (enum filling)compare_below(c, FILLINGS);
	int16_t *x = to;

	for (int i = 0; i < count; i++)
		x[i] = (int16_t)compare_value(c, filling, i, low, high);
}

struct comparison *comparison_create(uint64_t seed)
{
	struct comparison *c = NULL;

	if (posix_memalign((void **)&c, 64, sizeof(*c)) != 0)
		exit(1);
	memset(c, 0, sizeof(*c));
	c->state = seed;
	guarded_create(&c->lines, (size_t)ROWS * STRIDE_MAX * 2);
	guarded_create(&c->line, WEIGHTS_LONG * sizeof(uint32_t));
	guarded_create(&c->weight, (size_t)WEIGHTS_LONG * 3 * KERNEL_DIGITS * sizeof(int16_t));
	for (int k = 0; k < 3; k++) {
		for (int d = 0; d < KERNEL_DIGITS; d++)
			guarded_create(&c->digit[k][d], STRIDE_MAX * sizeof(int16_t));
		for (int i = 0; i < 2; i++)
			guarded_create(&c->sum[i][k], (KERNEL_LINE8 + 8) * sizeof(int64_t));
		guarded_create(&c->object[k], WEIGHTS * KERNEL_WEIGHT * sizeof(int64_t));
		guarded_create(&c->taken[k], MIXED * sizeof(int32_t));
	}
	for (int i = 0; i < 2; i++)
		guarded_create(&c->out[i], 8192);
	guarded_create(&c->coverage, MIXED * sizeof(uint16_t));
	guarded_create(&c->background, MIXED * 4);
	for (int from = 0; from < TRANSFER_COUNT; from++) {
		for (int to = 0; to < TRANSFER_COUNT; to++)
			kernel_curves_fill(&c->curves[from][to],
					   &(struct transfer_curve){.named = (enum transfer)from},
					   &(struct transfer_curve){.named = (enum transfer)to});
	}
	return c;
}

void comparison_free(struct comparison *c)
{
	guarded_free(&c->lines);
	guarded_free(&c->line);
	guarded_free(&c->weight);
	for (int k = 0; k < 3; k++) {
		for (int d = 0; d < KERNEL_DIGITS; d++)
			guarded_free(&c->digit[k][d]);
		for (int i = 0; i < 2; i++)
			guarded_free(&c->sum[i][k]);
		guarded_free(&c->object[k]);
		guarded_free(&c->taken[k]);
	}
	for (int i = 0; i < 2; i++)
		guarded_free(&c->out[i]);
	guarded_free(&c->coverage);
	guarded_free(&c->background);
	free(c);
}

static bool one_round(struct comparison *c, enum kernel_function function,
		      const struct kernels *tables[2], char *why)
{
	switch (function) {
	case SUMS16:
		return compare_sums(c, false, tables, why);
	case SUMS8:
		return compare_sums(c, true, tables, why);
	case VALUES16:
		return compare_values(c, false, tables, why);
	case VALUES8:
		return compare_values(c, true, tables, why);
	case SPLIT:
		return compare_split(c, tables, why);
	case PROJECT:
		return compare_project(c, tables, why);
	case FOLD:
		return compare_fold(c, tables, why);
	case TINT:
		return compare_tint(c, tables, why);
	case PLACE:
		return compare_place(c, tables, why);
	case MIX:
		return compare_mix(c, tables, why);
	case GRAIN:
		return compare_grain(c, tables, why);
	default:
		return compare_divide(c, tables, why);
	}
}

bool comparison_run(struct comparison *c, enum kernel_function function, int rounds,
		    const struct kernels *truth, const struct kernels *other, char why[256])
{
	const struct kernels *tables[2] = {truth, other};

	for (c->round = 0; c->round < rounds; c->round++) {
		strcpy(why, "it wrote before its output");
		if (!one_round(c, function, tables, why))
			return false;
	}
	return true;
}
