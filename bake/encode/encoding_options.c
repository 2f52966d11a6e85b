/* SPDX-License-Identifier: MIT */
#include "bake/encode/encoding_options.h"

int encoding_error_take(void *choices, const char *option, const char *text, struct fault *fault)
{
	struct encoding_choices *c = choices;
	double error[2] = {-1, -1};
	const int count = option_reals(option, text, 1, 2, ENCODING_ERROR_MIN, ENCODING_ERROR_MAX,
				       error, fault);

	c->rms = error[0];
	c->max = error[1];
	return count < 0 ? count : 0;
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
