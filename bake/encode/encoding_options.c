/* SPDX-License-Identifier: MIT */
#include "bake/encode/encoding_options.h"

#include <string.h>

#include "bake/base/options.h"
#include "hal/optics/dome.h"

/* Errors in 8-bit levels: what measurement resolves (LEVELS_ERROR), and black for white. */
#define LEVELS_MIN 1e-3
#define LEVELS_MAX 255

/* Parses RMS[,MAX]. */
static int take_error(struct encoding_said *said, char *text, struct fault *fault)
{
	char *comma = strchr(text, ',');
	int err = 0;

	if (comma) {
		*comma = '\0';
		err = option_real("--error", comma + 1, LEVELS_MIN, LEVELS_MAX, &said->max, fault);
	}
	return err ? err : option_real("--error", text, LEVELS_MIN, LEVELS_MAX, &said->rms, fault);
}

int encoding_option_take(struct encoding_said *said, int option, char *text, struct fault *fault)
{
	switch (option) {
	case ENCODING_ERROR:
		return take_error(said, text, fault);
	case ENCODING_CELL_ERROR:
		return option_real("--cell-error", text, LEVELS_MIN, LEVELS_MAX, &said->cell,
				   fault);
	case ENCODING_COLUMN_CUT:
		return option_real("--column-cut", text, 0, 0.1, &said->column_cut, fault);
	case ENCODING_COARSE:
		return option_int("--coarse", text, 1, DOME_FREQUENCY_MAX, &said->coarse, fault);
	default:
		said->exact = true;
		return 0;
	}
}

void encoding_said_apply(const struct encoding_said *said, struct encode_target *target,
			 double *column_cut, int *coarse, bool *exact)
{
	if (said->rms >= 0) {
		target->rms = said->rms;
		target->max = said->max > 0 ? said->max : 0;
	}
	if (said->cell >= 0)
		target->cell = said->cell;
	if (said->column_cut >= 0)
		*column_cut = said->column_cut;
	if (said->coarse >= 0)
		*coarse = said->coarse;
	*exact |= said->exact;
}
