/* SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "hal/base/processor.h"
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

/* Not const, so that it takes no room in the program's file. */
_Alignas(64) int16_t kernel_zeros[KERNEL_STRIDE_MAX];

static bool has(unsigned features)
{
	return (processor_features() & features) == features;
}

bool kernels_supported_sse41(void)
{
	return has(PROCESSOR_SSE41);
}

bool kernels_supported_avx2(void)
{
	return has(PROCESSOR_AVX2);
}

bool kernels_supported_avx512(void)
{
	return has(PROCESSOR_AVX512 | PROCESSOR_AVX512_VNNI);
}

bool kernels_supported_neon(void)
{
	return has(PROCESSOR_NEON);
}

bool kernels_supported_neon_dotprod(void)
{
	return has(PROCESSOR_NEON | PROCESSOR_DOTPROD);
}

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
