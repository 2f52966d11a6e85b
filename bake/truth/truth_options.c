/* SPDX-License-Identifier: MIT */
#include "bake/truth/truth_options.h"

#include "bake/base/options.h"

int truth_option_take(struct truth_settings *settings, int option, const char *text,
		      struct fault *fault)
{
	switch (option) {
	case TRUTH_SAMPLES:
		return option_int("--samples", text, 1, 1 << 20, &settings->samples, fault);
	case TRUTH_SEED:
		return option_int("--seed", text, 0, 2147483647, &settings->seed, fault);
	case TRUTH_THREADS:
		return option_int("--threads", text, 1, 1024, &settings->threads, fault);
	default:
		settings->quiet = true;
		return 0;
	}
}
