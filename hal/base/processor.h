/* SPDX-License-Identifier: MIT */
/*
 * What the processor can do beyond what the program was compiled for.
 *
 * Tables of functions for an instruction set (hal/compositor/kernels/kernels.h, hal/frame/frame_rows.h,
 * hal/lights/sampler_kernels.h) each say what they need; who chooses one asks here first. This code
 * itself is compiled for every processor.
 */
#ifndef INLAY_HAL_BASE_PROCESSOR_H
#define INLAY_HAL_BASE_PROCESSOR_H

#include <stdbool.h>

enum processor_feature {
	PROCESSOR_SSE41 = 1 << 0,
	PROCESSOR_AVX2 = 1 << 1,
	PROCESSOR_AVX512 = 1 << 2,	/* F, BW, DQ and VL */
	PROCESSOR_AVX512_VNNI = 1 << 3, /* with the above */
	PROCESSOR_AVX512_VBMI = 1 << 4, /* with the above but for VNNI */
	PROCESSOR_NEON = 1 << 5,	/* every aarch64 has it */
	PROCESSOR_DOTPROD = 1 << 6,
};

/* Features that processor and system support, or'ed. */
unsigned processor_features(void);

/*
 * Features that what is called so may use, from no others: "c" none, then "sse4.1", "avx2",
 * "avx512-vnni", "neon", "neon-dotprod", each with those before it on its machine; NULL, "" and
 * "auto": all. False: there is no such name.
 */
bool processor_features_named(const char *name, unsigned *features);

/*
 * Those of processor_features() that name allows, or where that is NULL or "auto" the environment's
 * INLAY_KERNEL does. An unknown name allows none.
 */
unsigned processor_features_allowed(const char *name);

#endif
