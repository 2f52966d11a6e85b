/* SPDX-License-Identifier: MIT */
#include "hal/compositor/kernels/kernels_grain.h"
#include "hal/compositor/kernels/kernels_isa.h"

#include <smmintrin.h>

typedef __m128i vector;
typedef __m128 vector_float;

#define SIMD(name) _mm_##name
#define SIMD_BITS(name) _mm_##name##_si128
#define AS_FLOAT(x) _mm_castsi128_ps(x)
#define LOAD(p) _mm_loadu_si128((const __m128i *)(p))
#define LOAD_ALIGNED(p) _mm_load_si128((const __m128i *)(p))
#define STORE(p, x) _mm_storeu_si128((__m128i *)(p), x)
#define LOAD_WIDE8(p) _mm_cvtepi8_epi16(_mm_loadl_epi64((const __m128i *)(p)))
#define LOAD_WIDE16(p) _mm_cvtepu16_epi32(_mm_loadl_epi64((const __m128i *)(p)))
#define IN_ORDER_LOW(a, b) (a)
#define IN_ORDER_HIGH(a, b) (b)
#define IN_ORDER_64(x) (x)
#define LANES(x) (x)

#define LINEAR(pixel) row->curves->linear[in[4 * (pixel)]]

static inline vector_float x86_linear_of(const struct kernel_row *row, int x, int byte)
{
	const uint8_t *in = row->background + (size_t)x * 4 + byte;

	return _mm_setr_ps(LINEAR(0), LINEAR(1), LINEAR(2), LINEAR(3));
}

#include "hal/compositor/kernels/kernels_x86.h"
#include "hal/compositor/kernels/kernels_x86_mix.h"

const struct kernels kernels_sse41 = {
	.name = "sse4.1",
	.supported = kernels_supported_sse41,
	.sums16 = x86_sums16,
	.sums8 = x86_sums8,
	.values16 = x86_values16,
	.values8 = x86_values8,
	.split = kernel_c_split, /* borrowed from kernels_c.c */
	.project = x86_project,
	.fold = x86_fold,
	.tint = x86_tint,
	.place = kernel_c_place, /* borrowed from kernels_c.c */
	.mix = x86_mix,
	.grain = kernel_add_grain,
	.divide = kernel_divide,
};
