/* SPDX-License-Identifier: MIT */
#include "hal/compositor/kernels/kernels_grain.h"
#include "hal/compositor/kernels/kernels_isa.h"

#include <immintrin.h>

typedef __m256i vector;
typedef __m256 vector_float;

#define SIMD(name) _mm256_##name
#define SIMD_BITS(name) _mm256_##name##_si256
#define AS_FLOAT(x) _mm256_castsi256_ps(x)
#define LOAD(p) _mm256_loadu_si256((const __m256i *)(p))
#define LOAD_ALIGNED(p) _mm256_load_si256((const __m256i *)(p))
#define STORE(p, x) _mm256_storeu_si256((__m256i *)(p), x)
#define LOAD_WIDE8(p) _mm256_cvtepi8_epi16(_mm_loadu_si128((const __m128i *)(p)))
#define LOAD_WIDE16(p) _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(p)))
#define IN_ORDER_LOW(a, b) _mm256_permute2x128_si256(a, b, 0x20)
#define IN_ORDER_HIGH(a, b) _mm256_permute2x128_si256(a, b, 0x31)
#define IN_ORDER_64(x) _mm256_permute4x64_epi64(x, 0xd8)
#define LANES(x) _mm256_broadcastsi128_si256(x)

#define LINEAR(pixel) linear[in[4 * (pixel)]]

static inline vector_float x86_linear_of(const struct kernel_row *row, int x, int byte)
{
	const float *linear = row->curves->linear;
	const uint8_t *in = row->background + (size_t)x * 4 + byte;

	return _mm256_setr_ps(LINEAR(0), LINEAR(1), LINEAR(2), LINEAR(3), LINEAR(4), LINEAR(5),
			      LINEAR(6), LINEAR(7));
}

#include "hal/compositor/kernels/kernels_x86.h"
#include "hal/compositor/kernels/kernels_x86_mix.h"

const struct kernels kernels_avx2 = {
	.name = "avx2",
	.supported = kernels_supported_avx2,
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
