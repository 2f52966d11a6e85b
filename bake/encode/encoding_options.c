/* SPDX-License-Identifier: MIT */
#include "bake/encode/encoding_options.h"

#include <string.h>

#include "bake/base/options.h"
#include "hal/optics/dome.h"

/* Errors in 8-bit levels: what measurement resolves (LEVELS_ERROR), and black for white. */
#define LEVELS_MIN 1e-3
#define LEVELS_MAX 255

/* Parses RMS[,MAX]. */
static int parse_rms_max(struct encoding_choices *choices, char *text, struct fault *fault)
{
	char *comma = strchr(text, ',');
	int err = 0;

	if (comma) {
		*comma = '\0';
		err = option_real("--error", comma + 1, LEVELS_MIN, LEVELS_MAX, &choices->max,
				  fault);
	}
	return err ? err
		   : option_real("--error", text, LEVELS_MIN, LEVELS_MAX, &choices->rms, fault);
}

int encoding_option_parse(struct encoding_choices *choices, int option, char *text,
			  struct fault *fault)
{
	switch (option) {
	case ENCODING_ERROR:
		return parse_rms_max(choices, text, fault);
	case ENCODING_CELL_ERROR:
		return option_real("--cell-error", text, LEVELS_MIN, LEVELS_MAX, &choices->cell,
				   fault);
	case ENCODING_COLUMN_CUT:
		return option_real("--column-cut", text, 0, 0.1, &choices->column_cut, fault);
	case ENCODING_COARSE:
		return option_int("--coarse", text, 1, DOME_FREQUENCY_MAX, &choices->coarse, fault);
	default:
		choices->exact = true;
		return 0;
	}
}

void encoding_choices_apply(const struct encoding_choices *choices, struct encode_target *target,
			    double *column_cut, int *coarse, bool *exact)
{
	if (choices->rms >= 0) {
		target->rms = choices->rms;
		target->max = choices->max > 0 ? choices->max : 0;
	}
	if (choices->cell >= 0)
		target->cell = choices->cell;
	if (choices->column_cut >= 0)
		*column_cut = choices->column_cut;
	if (choices->coarse >= 0)
		*coarse = choices->coarse;
	*exact |= choices->exact;
}
