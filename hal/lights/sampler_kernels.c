/* SPDX-License-Identifier: MIT */
#include "hal/lights/sampler_kernels.h"

#include <stddef.h>

#include "hal/base/processor.h"

const struct sampler_kernels *const sampler_kernels_all[] = {
	&sampler_kernels_c,
#if defined(__x86_64__)
	&sampler_kernels_avx2,
#elif defined(__aarch64__)
	&sampler_kernels_neon,
#endif
	NULL,
};

const struct sampler_kernels *sampler_kernels_choose(void)
{
	const unsigned features = processor_features_allowed(NULL);
	const struct sampler_kernels *chosen = sampler_kernels_all[0];

	for (int i = 1; sampler_kernels_all[i]; i++) {
		if ((sampler_kernels_all[i]->needs & ~features) == 0)
			chosen = sampler_kernels_all[i];
	}
	return chosen;
}
