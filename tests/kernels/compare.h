/* SPDX-License-Identifier: MIT */
/*
 * Two tables of kernels over the same random and worst inputs.
 */
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
	FUNCTIONS
};

extern const char *const kernel_function_names[FUNCTIONS];

struct comparison;

struct comparison *comparison_create(uint64_t seed);
void comparison_free(struct comparison *c);

/* False where they differ, or where `other` writes beyond what it may; then why says in which case.
 */
bool comparison_run(struct comparison *c, enum kernel_function function, int rounds,
		    const struct kernels *truth, const struct kernels *other, char why[256]);

#endif
