/* SPDX-License-Identifier: MIT */
/*
 * The roundings of the compositor: each of them is one of these functions. ../README.md proves
 * ranges and errors. Private to hal/compositor.
 *
 * >> of a negative number is the arithmetic shift, as gcc and clang define it.
 */
#ifndef INLAY_HAL_COMPOSITOR_KERNELS_FIXED_H
#define INLAY_HAL_COMPOSITOR_KERNELS_FIXED_H

#include <math.h>
#include <stdint.h>
#include <string.h>

/* floor(x / 2^n + 1/2). n in 1..63; |x| < 2^62. */
static inline int64_t round_shift(int64_t x, int n)
{
	return (x + (INT64_C(1) << (n - 1))) >> n;
}

/* floor(x * m / 2^15 + 1/2), exact. |x| < 2^61, m in 0..65535; the result may be twice x. */
static inline int64_t mul_q15(int64_t x, uint16_t m)
{
	return (x >> 15) * m + round_shift((x & 32767) * m, 15);
}

/* The nearest integer, halves to even. |x| < 2^62. x is a double, so factors may be powers of two
 * of any size. */
static inline int64_t round_double(double x)
{
	return llrint(x);
}

/* The nearest integer, halves to even, as a double. |x| < 2^51: near 1.5 * 2^52 a double has no
 * fraction bits. Two additions, which compilers can vectorise. */
static inline double round_narrow(double x)
{
	return (x + 0x1.8p52) - 0x1.8p52;
}

/* The nearest integer, halves to even. |x| < 2^51. The mantissa of the sum holds the integer, so no
 * conversion is needed and compilers can vectorise it. */
static inline int64_t round_whole(double x)
{
	const double sum = x + 0x1.8p52;
	int64_t bits;

	memcpy(&bits, &sum, sizeof(bits));
	return bits - INT64_C(0x4338000000000000);
}

/* 2^e, e in -1022..1023. */
static inline double power_of_two(int e)
{
	const uint64_t bits = (uint64_t)(e + 1023) << 52;
	double power;

	memcpy(&power, &bits, sizeof(power));
	return power;
}

/* The least e with x <= 2^e; x > 0. */
static inline int exponent_above(double x)
{
	int e;
	const double mantissa = frexp(x, &e);

	return mantissa == 0.5 ? e - 1 : e;
}

/* Returns x * 2^n whose highest bit is at place `bit`, and subtracts n from *exponent. Bits shifted
 * out at the right are lost. x > 0. */
static inline uint64_t normalise(uint64_t x, int bit, int *exponent)
{
	const int up = bit - (63 - __builtin_clzll(x));

	*exponent -= up;
	return up >= 0 ? x << up : x >> -up;
}

/*
 * n / d * 2^exponent in Q24, clamped to -limit..limit; relative error below 2^-29 before the
 * rounding. |n| < 2^63, 0 < d < 2^63.
 */
static inline int32_t quotient_q24(int64_t n, int64_t d, int exponent, int32_t limit)
{
	uint64_t above, below, quotient;
	int64_t value;

	if (!n)
		return 0;
	exponent += 24;
	above = normalise(n < 0 ? -(uint64_t)n : (uint64_t)n, 62, &exponent);
	exponent = -exponent;
	below = normalise((uint64_t)d, 31, &exponent);
	exponent = -exponent;
	quotient = above / below; /* 2^30 < quotient < 2^32 */
	if (exponent >= 1)
		value = limit;
	else if (exponent == 0)
		value = (int64_t)quotient;
	else
		value = exponent < -62 ? 0 : round_shift((int64_t)quotient, -exponent);
	value = value > limit ? limit : value;
	return (int32_t)(n < 0 ? -value : value);
}

#endif
