/* SPDX-License-Identifier: MIT */
/* Compares two tables of kernels on the same inputs, random and worst ones. */
#ifndef INLAY_TESTS_KERNELS_COMPARE_H
#define INLAY_TESTS_KERNELS_COMPARE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/compositor/kernels/kernels.h"

enum kernel_function {
	SUMS16,
	SUMS8,
	VALUES16,
	VALUES8,
	SPLIT,
	PROJECT,
	FOLD,
	TINT,
	PLACE,
	MIX,
	GRAIN,
	DIVIDE,
	FUNCTIONS
};

extern const char *const kernel_function_names[FUNCTIONS];

struct comparison;

struct comparison *comparison_create(uint64_t seed);
void comparison_free(struct comparison *c);

/* False where the tables differ, or where `other` writes outside its output; `why` then names the
 * case. */
bool comparison_run(struct comparison *c, enum kernel_function function, int rounds,
		    const struct kernels *truth, const struct kernels *other, char why[256]);

#endif
