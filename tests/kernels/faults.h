/* SPDX-License-Identifier: MIT */
/* Tables that are wrong in one small thing each, and that the comparison must find. */
#ifndef INLAY_TESTS_KERNELS_FAULTS_H
#define INLAY_TESTS_KERNELS_FAULTS_H

#include "tests/kernels/compare.h"

struct faulty {
	const char *fault;
	enum kernel_function function;
	struct kernels table;
};

extern const int faulty_count;
struct faulty faulty_table(int i); /* the C table with that one function replaced */

#endif
