/* SPDX-License-Identifier: MIT */
/*
 * The inner loops of the light sampler, one table of functions for each instruction set.
 *
 * sampler_c.c is the specification. All arithmetic is integer and exact, so every table gives the
 * same numbers. No function writes beyond what its comment names.
 */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_KERNELS_H
#define INLAY_HAL_LIGHTS_SAMPLER_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Planes of values: red, green, blue, clipped (0 or 1). */
enum { SAMPLER_PLANES = 4 };

/* Weights come in chunks of so many; the last chunk of a span is padded with 0. */
enum { SAMPLER_CHUNK = 16 };

/* Linear light of each code value: round(65535 * linear) - 32768, in -32768..32767. */
struct sampler_decode {
	int16_t value[256];
	int32_t wide[256]; /* the same values, for gathers of 32 bits */
	uint8_t white;	   /* lowest code that counts as clipped; at least 1 */
};

/* Most chunks of a span. Kernels split weights into 8 and 7 bits, so that the 32-bit sums of pairs
 * of products do not overflow: 128 * 2 * 2^15 * 255 < 2^31. */
enum { SAMPLER_CHUNKS_MAX = 128 };

struct sampler_span {
	uint32_t offset : 20; /* in a strip's planes */
	uint32_t chunks : 12; /* 1..SAMPLER_CHUNKS_MAX */
};

struct sampler_kernels {
	const char *name;
	unsigned needs; /* enum processor_feature, or'ed */

	/* Decodes count pixels into planes that lie plane_stride values apart: R, G, B, and
	 * clipped, which is 1 if a channel is table->white or more, else 0. Returns whether any
	 * pixel is clipped. Ignores X. */
	bool (*decode)(const struct sampler_decode *table, const uint32_t *bgrx, int count,
		       int16_t *planes, size_t plane_stride);

	/* sum[c] = sum over all spans of value * weight, for the first 3 or all 4 planes; with 3,
	 * sum[3] = 0. weight is 32-byte aligned and at most 32767. Values behind a span, up to a
	 * whole chunk, are read and have weight 0. */
	void (*add)(const int16_t *planes, int plane_count, size_t plane_stride,
		    const struct sampler_span *spans, int span_count, const uint16_t *weight,
		    int64_t sum[SAMPLER_PLANES]);
};

/* The tables in this program, from the C one to the fastest, then NULL. */
extern const struct sampler_kernels *const sampler_kernels_all[];

/* The fastest table that the processor and the environment variable INLAY_KERNEL allow
 * (processor.h). */
const struct sampler_kernels *sampler_kernels_choose(void);

/* decode of the C table (sampler_c.c). Other tables use it for the rest of a row, or as it is. */
bool sampler_decode_c(const struct sampler_decode *table, const uint32_t *bgrx, int count,
		      int16_t *planes, size_t plane_stride);

extern const struct sampler_kernels sampler_kernels_c;
extern const struct sampler_kernels sampler_kernels_avx2;
extern const struct sampler_kernels sampler_kernels_neon;

#endif
