/* SPDX-License-Identifier: MIT */
/*
 * The inner loops of the light sampler, one table of functions for each instruction set.
 *
 * sampler_kernels.c is the specification: all is integer and exact, so every other table gives the
 * same numbers. No function writes beyond what its comment names.
 */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_KERNELS_H
#define INLAY_HAL_LIGHTS_SAMPLER_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Red, green, blue, and whether a pixel is clipped. */
enum { SAMPLER_PLANES = 4 };

/* Values that weights are given for at a time: the rest of the last ones are 0. */
enum { SAMPLER_CHUNK = 16 };

/* Linear light less one half, 65535 = 1: -32768..32767. */
struct sampler_decode {
	int16_t value[256];
	int32_t wide[256];	     /* the same again */
	uint8_t low[256], high[256]; /* and its bytes */
};

/* Of a span: with weights split into seven bits and eight, the sums of so many products of pairs
 * stay below 2^31, as 128 * 2 * 2^15 * 255 does. */
enum { SAMPLER_CHUNKS_MAX = 128 };

struct sampler_span {
	uint32_t offset : 20; /* in a strip's planes */
	uint32_t chunks : 12; /* 1..SAMPLER_CHUNKS_MAX */
};

struct sampler_kernels {
	const char *name;
	unsigned needs; /* of the processor: enum processor_feature */

	/* count pixels into planes that lie plane_stride values apart: R, G, B, and 1 where one
	 * of them is 255 or else 0. Whether that was so anywhere. X is ignored. */
	bool (*decode)(const struct sampler_decode *table, const uint32_t *bgrx, int count,
		       int16_t *planes, size_t plane_stride);

	/* sum[c] = of all spans, value times weight, of the first 3 or all 4 planes; without the
	 * fourth its sum is 0. weight is 32-byte aligned, none is above 32767. What lies beyond a
	 * span's pixels, up to a whole chunk, is read and has no weight. */
	void (*add)(const int16_t *planes, int plane_count, size_t plane_stride,
		    const struct sampler_span *spans, int span_count, const uint16_t *weight,
		    int64_t sum[SAMPLER_PLANES]);
};

/* The tables that this program was built with, the specification first, the fastest last, then
 * NULL. */
extern const struct sampler_kernels *const sampler_kernels_all[];

/* The fastest that the processor has and the environment's INLAY_KERNEL allows (processor.h). */
const struct sampler_kernels *sampler_kernels_choose(void);

/* The specification; what other tables leave of a row is its. */
bool sampler_decode_c(const struct sampler_decode *table, const uint32_t *bgrx, int count,
		      int16_t *planes, size_t plane_stride);

extern const struct sampler_kernels sampler_kernels_c;
extern const struct sampler_kernels sampler_kernels_avx2;
extern const struct sampler_kernels sampler_kernels_avx512;
extern const struct sampler_kernels sampler_kernels_neon;

#endif
