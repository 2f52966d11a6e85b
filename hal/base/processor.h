/* SPDX-License-Identifier: MIT */
/*
 * Instruction sets of the processor beyond those that the program was compiled for.
 *
 * Each table of functions for an instruction set (hal/compositor/kernels/kernels.h,
 * hal/frame/frame_rows.h, hal/lights/sampler_kernels.h) says what it needs; code that chooses a
 * table asks here first. This file is compiled for every processor.
 */
#ifndef INLAY_HAL_BASE_PROCESSOR_H
#define INLAY_HAL_BASE_PROCESSOR_H

#include <stdbool.h>

enum processor_feature {
	PROCESSOR_SSE41 = 1 << 0,
	PROCESSOR_AVX2 = 1 << 1,
	PROCESSOR_AVX512 = 1 << 2,	/* F, BW, DQ and VL */
	PROCESSOR_AVX512_VNNI = 1 << 3, /* only together with PROCESSOR_AVX512 */
	PROCESSOR_NEON = 1 << 4,	/* every aarch64 has it */
	PROCESSOR_DOTPROD = 1 << 5,
};

/* Features that processor and system support: enum processor_feature, or'ed. */
unsigned processor_features(void);

/*
 * The features that a name allows: "c" none; "sse4.1", "avx2", "avx512-vnni", "neon",
 * "neon-dotprod" each its own and those before it on the same machine; NULL, "" and "auto" all.
 * False: unknown name.
 */
bool processor_features_named(const char *name, unsigned *features);

/*
 * The part of processor_features() that name allows. Where name is NULL, "" or "auto", the
 * environment variable INLAY_KERNEL is the name. An unknown name allows no feature.
 */
unsigned processor_features_allowed(const char *name);

#endif
