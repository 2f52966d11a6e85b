/* SPDX-License-Identifier: MIT */
/*
 * The inner loops of the compositor, one table of functions for each instruction set. Private to
 * hal/compositor, its tests and benchmarks.
 *
 * kernels_c.c is the specification: every other table gives the same bits for every input inside
 * the stated ranges. Sums are exact integers, so a table may add in any order and split factors in
 * any way. No intermediate saturates. No function reads or writes beyond what its comment names.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_H
#define INLAY_HAL_COMPOSITOR_KERNELS_KERNELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/colour/transfer.h"

#define KERNEL_LINE_BYTES 64
#define KERNEL_STRIDE_MAX 32768 /* coarse lights in a row */
#define KERNEL_LINE16 32	/* pixels in a line of int16 */
#define KERNEL_LINE8 64		/* pixels in a line of int8 */

/*
 * A number up to 2^46.9 is split into balanced digits of base 4096, each -2048..2047:
 *     number = sum over d of digit_d * 4096^d
 * Then 32 products with int16 add up in int32: 32 * 32767 * 2048 < 2^31.
 */
#define KERNEL_DIGITS 4
#define KERNEL_DIGIT_BITS 12
#define KERNEL_SHIFT_MAX 16
#define KERNEL_RUN 32			     /* lines whose products with a digit add up in int32 */
#define KERNEL_VALUE_LINES8 (4 * KERNEL_RUN) /* most lines of bytes that values8() adds up */
/* Right shift of a sum over a run to get a value: for lines of int16, of int8. */
#define KERNEL_VALUE_SHIFT16 12
#define KERNEL_VALUE_SHIFT8 6
#define KERNEL_WEIGHT 4	       /* three channels and an unused one: a vector */
#define KERNEL_PLACE_BEYOND 16 /* values that place() may read beyond its input */

/* Some lines of a panel, and the weights of each in the three channels. */
struct kernel_weights {
	int count;	      /* even; a line of weight 0 completes an odd number */
	int digits;	      /* 1..KERNEL_DIGITS */
	int shift;	      /* products are added to sums times 2^shift; 0..KERNEL_SHIFT_MAX */
	bool fresh;	      /* overwrite sums or values instead of adding to them */
	const uint32_t *line; /* [count]: line numbers, in any order */
	size_t step;	      /* bytes from a line to the next number; a multiple of a line */
	size_t channel;	      /* bytes to the same line of the next channel; 0: all read the same */
	/* [count / 2][3][digits][2]: the two factors of one instruction are adjacent, and all are
	 * in the order in which they are read. */
	const int16_t *digit;
};

/* Digit d of the weight of line k in channel c. */
static inline const int16_t *kernel_digit(const struct kernel_weights *w, int k, int c, int d)
{
	return w->digit + ((k / 2 * 3 + c) * w->digits + d) * 2 + k % 2;
}

/* A vector over the coarse lights. */
struct kernel_vector {
	int digits;			     /* 0..KERNEL_DIGITS; 0: the vector is 0 */
	const int16_t *digit[KERNEL_DIGITS]; /* [stride], 64-byte aligned, 0 after the last light */
};

/*
 * The transfer functions of background and output, as mix() reads them. Linear light 0..1 becomes
 * the float
 *     v = KERNEL_BLACK + KERNEL_WHITE * light
 * whose exponent and 2 highest mantissa bits number 32 pieces of the encoding curve, finer towards
 * black. Each piece is a parabola.
 */
#define KERNEL_PIECES 32
#define KERNEL_BLACK 256.0f
#define KERNEL_WHITE 65280.0f

struct kernel_curves {
	_Alignas(64) uint16_t decode[256]; /* linear light, 65535 = 1 */
	_Alignas(64) float linear[256];	   /* the same numbers */
	/* Linear light, white is 1, of a code v: light[0] + light[1] v + light[2] v^2 + light[3]
	 * v^3, the cubic through four codes; for the strength of noise. Off by 0.004 of white at
	 * most for named curves, by 0.07 for a film's toe and shoulder. */
	float light[4];
	/* Code of piece i at t in 0..1/2, in 1/256 of a level, plus 1/2 level for the rounding:
	 *     a[i] + b[i] t + c[i] t^2        |b| + |c| / 2 < 32767
	 */
	_Alignas(64) uint16_t a[KERNEL_PIECES];
	_Alignas(64) int16_t b[KERNEL_PIECES];
	_Alignas(64) int16_t c[KERNEL_PIECES];
	/* Low bytes of a, high bytes of a, low bytes of b, and so on. */
	_Alignas(64) uint8_t bytes[6][KERNEL_PIECES];
	uint8_t recode[256]; /* output of mix() for a pixel that nothing changes */
	/* The largest magnitude of `taken`, below KERNEL_FAINT, up to which the output of mix() is
	 * recode[w] for each code w <= v where coverage and O are 0. */
	int32_t steady[256];
};

/*
 * Fits the curves. The output of mix() is within 0.52 levels of the exact encoding of the exact
 * sum, and recode[i] is i where both transfer functions are the same: tests/kernels proves both for
 * every code and named curve. For three measured curves it finds at most 0.56 levels above 1 / 1020
 * of white; below that 0.52 for curves with a straight foot, and 1.75 (recode one level off) for a
 * power of 2.2.
 */
void kernel_curves_fill(struct kernel_curves *curves, const struct transfer_curve *background,
			const struct transfer_curve *output);

/* Rows of pixels for mix(). Channels are in the order R, G, B. Nothing need be aligned. */
struct kernel_row {
	int count, rows;
	const int32_t *object[3];  /* [count]: O in Q24, |O| < 2^31 */
	const int32_t *taken[3];   /* [count]: 1 - ratio in Q24 */
	const uint16_t *coverage;  /* [count]: 65535 = 1; NULL: coverage and O are 0 */
	const uint8_t *background; /* [count] BGRX */
	const struct kernel_curves *curves;
	uint8_t *out; /* [count] BGRX; X becomes 255; written once and never read */
	/* Strides to the next row: object and taken, coverage in elements; the others in bytes. */
	ptrdiff_t value_step, coverage_step, background_step, out_step;
};

/* A shadow that takes less light than this, in Q24, keeps the background's own noise
 * (compositor/live/grain.c). */
#define KERNEL_FAINT (INT32_C(1) << 19)

/* A tile that gets grain (compositor/live/grain.h). All rows have KERNEL_GRAIN pixels. */
enum {
	KERNEL_GRAIN = 16,    /* pixels */
	KERNEL_GRAIN_ONE = 32 /* noise that stands for one standard deviation */
};

struct kernel_grain {
	int rows;
	const int32_t *object[3], *taken[3]; /* as in struct kernel_row; rows follow each other */
	const uint16_t *coverage;
	const uint8_t *background; /* BGRX */
	const int8_t *noise[3];
	const struct kernel_curves *curves;
	float floor[3], slope[3]; /* >= 0 */
	int32_t *to[3];		  /* object with grain; overlaps nothing; rows follow each other */
	/* Strides to the next row: coverage and noise in elements, background in bytes. */
	ptrdiff_t coverage_step, noise_step, background_step;
};

enum { KERNEL_GRID = 5 };

struct kernels {
	const char *name; /* as in options and environment */
	bool (*supported)(void);

	/* For the KERNEL_LINE16 pixels p of a panel:
	 *     sum[c][p] += 2^shift * sum over k of line[k][c][p] * weight[k][c]
	 * lines is 64-byte aligned; no value is -32768. Results are below 2^63 in magnitude. */
	void (*sums16)(const int16_t *lines, const struct kernel_weights *weights,
		       int64_t *const sum[3]);
	/* The same for bytes and KERNEL_LINE8 pixels; no value is -128. */
	void (*sums8)(const int8_t *lines, const struct kernel_weights *weights,
		      int64_t *const sum[3]);

	/* For at most KERNEL_RUN lines, modulo 2^32:
	 *     value[c][p] += round_shift(sum over k of line[k][c][p] * weight[k][c],
	 *                                KERNEL_VALUE_SHIFT16)
	 */
	void (*values16)(const int16_t *lines, const struct kernel_weights *weights,
			 int32_t *const value[3]);
	/* The same for KERNEL_VALUE_LINES8 lines of bytes, with KERNEL_VALUE_SHIFT8. */
	void (*values8)(const int8_t *lines, const struct kernel_weights *weights,
			int32_t *const value[3]);

	/* Splits count weights of each channel into digits, in the layout of kernel_digit().
	 * Returns the number of digits that the largest needs; 0 if all weights are 0. count is
	 * even and below 2^16; |weight| <= 2^46. digit has room for KERNEL_DIGITS, 64-byte aligned.
	 */
	int (*split)(int64_t (*weight)[KERNEL_WEIGHT], int count, int16_t *digit);

	/* Multiplies `count` rows with the vectors of three channels:
	 *     y[j][c] = sum over k of rows[j][k] * vector[c][k]      below 2^63 in magnitude
	 * rows is 64-byte aligned; no value is -32768. stride is a multiple of 32,
	 * 32..KERNEL_STRIDE_MAX. */
	void (*project)(const int16_t *rows, int count, int stride,
			const struct kernel_vector vector[3], int64_t (*y)[3]);

	/*
	 * Converts sums to Q24 and adds them to values; clamp() is to +-KERNEL_LIMIT:
	 *     x     = clamp(round_shift(sum[p], shift))        shift in 1..62
	 *     x     = clamp(round_shift(x * factor, 30))       factor <= 2^31
	 *     x     = clamp(round_shift(x * tint[p], 15))      unless tint is NULL
	 *     to[p] = clamp(from[p] + x)
	 * from may be to. count 1..256; |sum[p]| <= 2^62.
	 */
	void (*fold)(const int64_t *sum, int count, int shift, uint32_t factor,
		     const uint16_t *tint, const int32_t *from, int32_t *to);

	/* Multiplies values by tints:
	 *     value[n] = round_shift(value[n] * tint[n], 15)      below 2^31 in magnitude
	 * count 1..256. */
	void (*tint)(int32_t *value, const uint16_t *tint, int count);

	/* Adds the values of listed pixels to their places in a tile:
	 *     to[p] = clamp(to[p] + value[n])
	 * where p is the place of the n-th set bit in 16 rows of 16 bits, lowest bit first, and
	 * clamp() is to +-KERNEL_LIMIT. value has KERNEL_PLACE_BEYOND readable elements more than
	 * there are bits. |value[n]|, |to[p]| <= KERNEL_LIMIT. */
	void (*place)(const int32_t *value, const uint16_t row[16], int32_t *to);

	/*
	 * Mixes object and background. For each pixel and channel, in float, each operation rounded
	 * to the nearest (never contracted), with B = linear[background]:
	 *     left  = (65536 - coverage - (coverage >> 15)) * fl(KERNEL_WHITE / 65535 / 65536)
	 *     ratio = min(max(1 - taken * 2^-24, 0), 16)
	 *     v     = (ratio * left) * B + (object * (KERNEL_WHITE * 2^-24) + KERNEL_BLACK)
	 * and in integers, from the bits of v:
	 *     key   = min(max((bits >> 10) - (135 << 13), 0), 65535)      as 135 - 127 = log2 256
	 *     i     = key >> 11,  t = (key & 2047) << 4                   t / 65536 in 0..1/2
	 *     out   = (a[i] + ((b[i] + ((c[i] * t) >> 16)) * t >> 16)) >> 8
	 */
	void (*mix)(const struct kernel_row *row);

	/*
	 * Adds grain to the rows of a tile, in single precision (rounded to the nearest, never
	 * contracted, in this order), with B = light[0] + v (light[1] + v (light[2] + v light[3]))
	 * of the background's code v:
	 *     k        = max(1 - taken, 0) (1 - coverage),    L = min(O + k B, 1)
	 *     variance = max(floor (1 - k^2) + slope (L - k^2 B), 0)
	 *     to       = object + sqrt(variance) noise        cut towards 0
	 */
	void (*grain)(const struct kernel_grain *tile);

	/*
	 * Divides the values of a tile by what is bilinear between KERNEL_GRID x
	 * KERNEL_GRID points, the last on the next tile's edge, in single precision (rounded to the
	 * nearest, never contracted, in this order). With u = (x % 4 + 1/2) / 4 and v alike, and
	 * the points a b above c d around the pixel:
	 *     upper    = a + u (b - a),     lower = c + u (d - c)
	 *     value[p] = value[p] / (upper + v (lower - upper))    clamped to +-KERNEL_LIMIT, cut
	 *                                                          towards 0
	 * grid: above 0. */
	void (*divide)(int32_t value[256], const float grid[KERNEL_GRID * KERNEL_GRID]);
};

/* Clamp of values in Q24: 127. Only light far beyond white reaches it. */
#define KERNEL_LIMIT (INT32_C(127) << 24)

extern const struct kernels kernels_c;

/* The tables that were compiled in: the specification first, the fastest last, then NULL. */
extern const struct kernels *const kernels_all[];

/*
 * Returns the table of that name; "auto" or NULL: the fastest that the processor supports. For
 * these two the environment variable INLAY_KERNEL may name another. NULL: there is no table of that
 * name, or the processor does not support it.
 */
const struct kernels *kernels_choose(const char *name);

#endif
