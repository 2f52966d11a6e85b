/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/kernels/kernels_isa.h"

const struct kernels *const kernels_all[] = {
	&kernels_c,
#if defined(__x86_64__)
	&kernels_sse41, &kernels_avx2, &kernels_avx512,
#elif defined(__aarch64__)
	&kernels_neon,
	&kernels_neon_dotprod,
#endif
	NULL,
};

const struct kernels *kernels_choose(const char *name)
{
	const struct kernels *fastest = NULL;

	if (!name || strcmp(name, "auto") == 0)
		name = getenv("INLAY_KERNEL");
	if (name && strcmp(name, "auto") == 0)
		name = NULL;
	for (int i = 0; kernels_all[i]; i++) {
		if ((!name || strcmp(kernels_all[i]->name, name) == 0) &&
		    kernels_all[i]->supported())
			fastest = kernels_all[i];
	}
	return fastest;
}
