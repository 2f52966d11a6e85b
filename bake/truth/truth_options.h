/* SPDX-License-Identifier: MIT */
/* The options of path tracing, the same for truth and pictures. */
#ifndef INLAY_BAKE_TRUTH_TRUTH_OPTIONS_H
#define INLAY_BAKE_TRUTH_TRUTH_OPTIONS_H

#include <limits.h>

#include "bake/truth/truth.h"
#include "hal/options/options.h"

/* Rows of a command whose AT(truth) is a struct truth_settings. */
/* clang-format off */
#define TRUTH_ROWS										   \
	{"samples", OPTION_INT, AT(truth.samples), .min = 1, .max = 1 << 20},			   \
	{"seed", OPTION_INT, AT(truth.seed), .max = INT_MAX},					   \
	{"threads", OPTION_INT, AT(truth.threads), .min = 1, .max = 1024},			   \
	{"quiet", OPTION_FLAG, AT(truth.quiet)}
/* clang-format on */

#endif
