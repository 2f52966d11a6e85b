/* SPDX-License-Identifier: MIT */
/* Functions that the tables call and every processor can run. This file names no table, so tables
 * depend on it but not on the list of tables (kernels.c). */
#include "hal/compositor/kernels/kernels_isa.h"

#include "hal/base/processor.h"

/* Not const, so that it is in .bss and takes no space in the program's file. */
_Alignas(64) int16_t kernel_zeros[KERNEL_STRIDE_MAX];

static bool isa_is_present(unsigned features)
{
	return (processor_features() & features) == features;
}

bool kernels_supported_sse41(void)
{
	return isa_is_present(PROCESSOR_SSE41);
}

bool kernels_supported_avx2(void)
{
	return isa_is_present(PROCESSOR_AVX2);
}

bool kernels_supported_avx512(void)
{
	return isa_is_present(PROCESSOR_AVX512 | PROCESSOR_AVX512_VNNI);
}

bool kernels_supported_neon(void)
{
	return isa_is_present(PROCESSOR_NEON);
}

bool kernels_supported_neon_dotprod(void)
{
	return isa_is_present(PROCESSOR_NEON | PROCESSOR_DOTPROD);
}
