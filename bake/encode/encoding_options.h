/* SPDX-License-Identifier: MIT */
/* Command-line options of the encoder, the same for all commands that make a basis file. */
#ifndef INLAY_BAKE_ENCODE_ENCODING_OPTIONS_H
#define INLAY_BAKE_ENCODE_ENCODING_OPTIONS_H

#include <stdbool.h>

#include "bake/encode/encode.h"
#include "hal/optics/dome.h"
#include "hal/options/options.h"

/* What errors may be, in 8-bit levels: what measurement resolves (LEVELS_ERROR), and black for
 * white. */
#define ENCODING_ERROR_MIN 1e-3
#define ENCODING_ERROR_MAX 255

/* Rows of a command whose AT(encoding) is a struct encoding_choices. */
/* clang-format off */
#define ENCODING_ROWS										   \
	{"error", OPTION_OTHER, AT(encoding), .take = encoding_error_take},			   \
	{"cell-error", OPTION_REAL, AT(encoding.cell), .min = ENCODING_ERROR_MIN, .max = ENCODING_ERROR_MAX},	   \
	{"column-cut", OPTION_REAL, AT(encoding.column_cut), .max = 0.1},			   \
	{"coarse", OPTION_INT, AT(encoding.coarse), .min = 1, .max = DOME_FREQUENCY_MAX},	   \
	{"exact", OPTION_FLAG, AT(encoding.exact)}
/* clang-format on */

#define ENCODING_HELP                                                                              \
	"  --error R[,M]   what the encoding may be off by under a sky, in each tile:\n"           \
	"                  RMS and any pixel, in 8-bit levels; M: twice R\n"                       \
	"  --cell-error L  what any pixel may be off by where one cell gives all light\n"          \
	"  --column-cut X  what a light's own correction may change, as linear light,\n"           \
	"                  and yet be left out of a frame\n"                                       \
	"  --coarse F      frequency of the dome over which smooth light is gathered\n"            \
	"  --exact         store every light in 16 bits as well, for the exact mode\n"

/* Options as a command line gives them; a number that was not given is negative. */
struct encoding_choices {
	double rms, max, cell, column_cut;
	int coarse;
	bool exact;
};

#define ENCODING_UNCHOSEN                                                                          \
	{                                                                                          \
		.rms = -1, .max = -1, .cell = -1, .column_cut = -1, .coarse = -1                   \
	}

/* Reads RMS[,MAX] into a struct encoding_choices. -EINVAL. */
int encoding_error_take(void *choices, const char *option, const char *text, struct fault *fault);

/* Replaces settings by the options that were given. If an RMS error was given without a largest
 * one, target->max becomes 0, and the caller has to choose it. */
void encoding_choices_apply(const struct encoding_choices *choices, struct encode_target *target,
			    double *column_cut, int *coarse, bool *exact);

#endif
