/* SPDX-License-Identifier: MIT */
/*
 * The inner loops of the compositor, one table of functions for each instruction set. Private to
 * hal/compositor, its tests and benchmarks.
 *
 * kernels_c.c is the specification: every other table gives the same bits for every input inside
 * the stated ranges, in whatever order it adds and however it splits its factors, since what is
 * computed is an exact integer. No intermediate saturates. No function reads or writes beyond what
 * its comment names.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/colour/transfer.h"

#define KERNEL_LINE_BYTES 64
#define KERNEL_STRIDE_MAX 32768 /* coarse lights of a row */
#define KERNEL_LINE16 32	/* pixels of a line of int16 */
#define KERNEL_LINE8 64		/* of int8 */

/*
 * A number up to 2^46.9 is split into balanced digits of base 4096, -2048..2047 each, so that
 * products with int16 add up in int32: 32 of them at most, as 32 * 32767 * 2048 < 2^31.
 */
#define KERNEL_DIGITS 4
#define KERNEL_DIGIT_BITS 12
#define KERNEL_SHIFT_MAX 16
#define KERNEL_RUN 32 /* lines whose products with a digit add up in int32 */
/* By so much the sum of a run is shifted down to become a value: of lines of int16, of int8. */
#define KERNEL_VALUE_SHIFT16 12
#define KERNEL_VALUE_SHIFT8 4
#define KERNEL_WEIGHT 4 /* three channels, and one that nobody reads: a vector */
#define KERNEL_PLACE_BEYOND 16

/* Some lines of a panel, and what each weighs in the three channels. */
struct kernel_weights {
	int count;	      /* even; an odd number of lines is filled up with a weight of 0 */
	int digits;	      /* 1..KERNEL_DIGITS; digit d counts 4096^d */
	int shift;	      /* what is added to sums counts 2^shift; 0..KERNEL_SHIFT_MAX */
	bool fresh;	      /* what is added to is 0, whatever stands there */
	const uint32_t *line; /* [count]: their numbers; need not ascend */
	size_t step;	      /* bytes from a line to that of the next number, whole lines */
	size_t channel;	      /* to that of the next channel; 0: all three read the same */
	/* [count / 2][3][digits][2]: what one instruction multiplies lies side by side, and all of
	 * it in the order in which it is read. */
	const int16_t *digit;
};

/* Digit d of what line k weighs in channel c. */
static inline const int16_t *kernel_digit(const struct kernel_weights *w, int k, int c, int d)
{
	return w->digit + ((k / 2 * 3 + c) * w->digits + d) * 2 + k % 2;
}

/* A vector over the coarse lights. */
struct kernel_vector {
	int digits;			     /* 0..KERNEL_DIGITS; 0: all of it is 0 */
	const int16_t *digit[KERNEL_DIGITS]; /* [stride], 64-byte aligned, 0 after the last light */
};

/*
 * The transfer functions of background and output, as mix reads them. White is KERNEL_WHITE, raised
 * by KERNEL_BLACK: then the exponent of a float and the 2 highest bits of its mantissa number 32
 * pieces of the encoding's curve, finer towards black, each of which is a parabola.
 */
#define KERNEL_PIECES 32
#define KERNEL_BLACK 256.0f
#define KERNEL_WHITE 65280.0f

struct kernel_curves {
	_Alignas(64) uint16_t decode[256]; /* linear light, 65535 = 1 */
	_Alignas(64) float linear[256];	   /* the same numbers */
	/* Of piece i and t in 0..1/2, in 1/256 of a level, 1/2 of a level added for the rounding:
	 * a + b t + c t^2. |b| + |c| / 2 < 32767. */
	_Alignas(64) uint16_t a[KERNEL_PIECES];
	_Alignas(64) int16_t b[KERNEL_PIECES];
	_Alignas(64) int16_t c[KERNEL_PIECES];
	/* The low and the high byte of each a, each b and each c. */
	_Alignas(64) uint8_t bytes[6][KERNEL_PIECES];
	uint8_t recode[256]; /* what mix makes of a pixel that nothing changes */
};

/*
 * What mix writes is within 0.52 levels of the exact encoding of the exact sum, and recode[i] is i
 * where both transfer functions are the same: tests/kernels proves both for every code and named
 * curve. Of measured curves it tries three: 0.56 levels above 1 / 1020 of white; below it 0.52 for
 * curves with a straight foot, 1.75 (and recode one level off) for a power of 2.2.
 */
void kernel_curves_fill(struct kernel_curves *curves, const struct transfer_curve *background,
			const struct transfer_curve *output);

/* Rows of pixels to be mixed; R, G, B is the order of the channels. Nothing need be aligned. */
struct kernel_row {
	int count, rows;
	const int32_t *object[3];  /* [count]: O in Q24, |O| < 2^31 */
	const int32_t *taken[3];   /* [count]: 1 - ratio in Q24 */
	const uint16_t *coverage;  /* [count]: 65535 = 1 */
	const uint8_t *background; /* [count] BGRX */
	const struct kernel_curves *curves;
	uint8_t *out; /* [count] BGRX; X becomes 255; written once and never read */
	/* To the next row: of object and taken, of coverage, in numbers; in bytes. */
	ptrdiff_t value_step, coverage_step, background_step, out_step;
};

struct kernels {
	const char *name; /* as options and environment spell it */
	bool (*supported)(void);

	/* sum[c][p] += 2^shift * sum over k of line[k][c][p] * weight[k][c] for the pixels of a
	 * panel, KERNEL_LINE16 of them. lines is 64-byte aligned; no value is -32768. The result's
	 * magnitude is below 2^63. */
	void (*sums16)(const int16_t *lines, const struct kernel_weights *weights,
		       int64_t *const sum[3]);
	/* The same for bytes, of KERNEL_LINE8 pixels; none is -128. */
	void (*sums8)(const int8_t *lines, const struct kernel_weights *weights,
		      int64_t *const sum[3]);

	/* value[c][p] += round_shift(sum over k of line[k][c][p] * weight[k][c],
	 * KERNEL_VALUE_SHIFT16), modulo 2^32, of at most KERNEL_RUN lines. */
	void (*values16)(const int16_t *lines, const struct kernel_weights *weights,
			 int32_t *const value[3]);
	/* The same for bytes, KERNEL_VALUE_SHIFT8. */
	void (*values8)(const int8_t *lines, const struct kernel_weights *weights,
			int32_t *const value[3]);

	/* Digit d of weight[k][c] to where kernel_digit() finds it, for count weights of each
	 * channel, an even number; as many digits as any of them needs, which it returns, 0 where
	 * all are 0. |weight| <= 2^46. digit has room for KERNEL_DIGITS, 64-byte aligned; count is
	 * below 2^16. */
	int (*split)(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit);

	/* y[j][c] = sum over k of rows[j][k] * vector_c[k], below 2^63 in magnitude. rows is
	 * 64-byte aligned, stride a multiple of 32, 32..KERNEL_STRIDE_MAX; no value is -32768. */
	void (*project)(const int16_t *rows, int count, int stride,
			const struct kernel_vector vector[3], int64_t (*y)[3]);

	/*
	 * to[p] = from[p] + what sum[p] is in Q24; from may be to:
	 *     x = round_shift(sum[p], shift), clamped to +-KERNEL_LIMIT    shift in 1..62
	 *     x = round_shift(x * factor, 30), clamped likewise            factor <= 2^31
	 *     x = round_shift(x * tint[p], 15), clamped likewise           unless tint is NULL
	 * and the sum with from[p] is clamped too. count 1..256; |sum[p]| <= 2^62.
	 */
	void (*fold)(const int64_t *sum, int count, int shift, uint32_t factor,
		     const uint16_t *tint, const int32_t *from, int32_t *to);

	/* value[n] = round_shift(value[n] * tint[n], 15), which is below 2^31 in magnitude. count
	 * 1..256. */
	void (*tint)(int32_t *value, const uint16_t *tint, int count);

	/* to[p] += value[n], clamped to +-KERNEL_LIMIT, where p is the place of the n-th bit that
	 * is set among 16 rows of 16, the lowest first. value has KERNEL_PLACE_BEYOND more than
	 * there are bits, of any value. |value[n]|, |to[p]| <= KERNEL_LIMIT. */
	void (*place)(const int32_t *value, const uint16_t row[16], int32_t *to);

	/*
	 * For each pixel and channel, in float, each operation rounded to the nearest (never
	 * contracted), with B = linear[background]:
	 *     left  = (65536 - coverage - (coverage >> 15)) * fl(KERNEL_WHITE / 65535 / 65536)
	 *     ratio = min(max(1 - taken * 2^-24, 0), 16)
	 *     v     = (ratio * left) * B + (object * (KERNEL_WHITE * 2^-24) + KERNEL_BLACK)
	 * and of the bits of v, in integers:
	 *     key   = min(max((bits >> 10) - (135 << 13), 0), 65535)      as 135 - 127 = log2 256
	 *     i     = key >> 11,  t = (key & 2047) << 4                   t / 65536 in 0..1/2
	 *     out   = (a[i] + ((b[i] + ((c[i] * t) >> 16)) * t >> 16)) >> 8
	 */
	void (*mix)(const struct kernel_row *row);
};

/* Of sums in Q24: 127. No lighting that is not blindingly beyond white reaches it. */
#define KERNEL_LIMIT (INT32_C(127) << 24)

extern const struct kernels kernels_c;

/* The tables that this program was built with, the specification first, the fastest last, then
 * NULL. */
extern const struct kernels *const kernels_all[];

/*
 * The fastest that the processor supports, or the one of that name ("auto" and NULL: the fastest).
 * The environment's INLAY_KERNEL names one in place of "auto". NULL: there is none of that name, or
 * the processor does not support it.
 */
const struct kernels *kernels_choose(const char *name);

#endif
