/* SPDX-License-Identifier: MIT */
/* Command-line options of the encoder, the same for all commands that make a basis file. */
#ifndef INLAY_BAKE_ENCODE_ENCODING_OPTIONS_H
#define INLAY_BAKE_ENCODE_ENCODING_OPTIONS_H

#include <stdbool.h>

#include "bake/encode/encode.h"
#include "hal/base/fault.h"

enum encoding_option {
	ENCODING_ERROR = 200, /* above the commands' own */
	ENCODING_CELL_ERROR,
	ENCODING_COLUMN_CUT,
	ENCODING_COARSE,
	ENCODING_EXACT
};

/* Entries of getopt_long()'s table. */
#define ENCODING_OPTIONS                                                                           \
	{"error", required_argument, NULL, ENCODING_ERROR},                                        \
		{"cell-error", required_argument, NULL, ENCODING_CELL_ERROR},                      \
		{"column-cut", required_argument, NULL, ENCODING_COLUMN_CUT},                      \
		{"coarse", required_argument, NULL, ENCODING_COARSE},                              \
	{                                                                                          \
		"exact", no_argument, NULL, ENCODING_EXACT                                         \
	}

#define ENCODING_USAGE                                                                             \
	"[--error RMS[,MAX]] [--cell-error LEVELS] [--column-cut X] [--coarse F] [--exact]"

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

/* Parses one option and its argument; text is changed. -EINVAL. */
int encoding_option_parse(struct encoding_choices *choices, int option, char *text,
			  struct fault *fault);

/* Replaces settings by the options that were given. If an RMS error was given without a largest
 * one, target->max becomes 0, and the caller has to choose it. */
void encoding_choices_apply(const struct encoding_choices *choices, struct encode_target *target,
			    double *column_cut, int *coarse, bool *exact);

#endif
