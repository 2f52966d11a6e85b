/* SPDX-License-Identifier: MIT */
/* Private to compare*.c: inputs of the comparisons of single kernels, and the memory that they lie
 * in. */
#ifndef INLAY_TESTS_KERNELS_COMPARE_PARTS_H
#define INLAY_TESTS_KERNELS_COMPARE_PARTS_H

#include "tests/kernels/compare.h"
#include "tests/kernels/guarded.h"

#define WEIGHTS_LONG 70000 /* more than any kernel may add up without widening its sums */
#define WEIGHTS 2000
#define STRIDE_MAX 4096
#define ROWS 9
#define WIDTH 300
#define ROWS_MIXED 3
#define GAP_MAX 5
#define MIXED (ROWS_MIXED * (WIDTH + GAP_MAX))

struct comparison {
	uint64_t state;
	int round;
	struct guarded lines, line, weight, digit[3][KERNEL_DIGITS];
	struct guarded sum[2][3], out[2]; /* of the truth and of the other table */
	struct guarded object[3], taken[3], coverage, background;
	struct kernel_curves curves[TRANSFER_COUNT][TRANSFER_COUNT];
};

uint64_t compare_next(struct comparison *c);
int compare_below(struct comparison *c, int n);
int compare_between(struct comparison *c, int low, int high);

/* Random number of up to `bits` bits; each length is as likely as any other. */
int64_t compare_spread(struct comparison *c, int bits);

/* How an array of numbers low..high is filled. */
enum filling { RANDOM, LOWEST, HIGHEST, EXTREMES, ALTERNATING, ZEROS, FILLINGS };

int compare_value(struct comparison *c, enum filling filling, int i, int low, int high);
void compare_fill16(struct comparison *c, void *to, int count, int low, int high);

/* One round each. False where the two tables differ; `why` names the case. */
bool compare_sums(struct comparison *c, bool bytes, const struct kernels *tables[2], char *why);
bool compare_values(struct comparison *c, bool bytes, const struct kernels *tables[2], char *why);
bool compare_split(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_project(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_fold(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_tint(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_place(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_mix(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_grain(struct comparison *c, const struct kernels *tables[2], char *why);
bool compare_divide(struct comparison *c, const struct kernels *tables[2], char *why);

#endif
