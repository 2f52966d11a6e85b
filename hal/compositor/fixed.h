/*
 * The integer arithmetic of the compositor: every rounding it makes is one of these functions.
 * Ranges and errors are proven in README.md. Private to hal/compositor.
 *
 * >> of a negative number is the arithmetic shift, as gcc and clang define it.
 */
#ifndef INLAY_HAL_COMPOSITOR_FIXED_H
#define INLAY_HAL_COMPOSITOR_FIXED_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#define Q16_ONE 65536 /* of ratios and of what coverage leaves */

/* The rounding: floor(x / 2^n + 1/2). n in 1..63; |x| < 2^62. */
static inline int64_t round_shift(int64_t x, int n)
{
	return (x + (INT64_C(1) << (n - 1))) >> n;
}

/* floor(a * m / 2^shift + 1/2), of the exact 96-bit product. |a| < 2^62; shift in 33..95. */
static inline int64_t mul_shift_round(int64_t a, uint32_t m, int shift)
{
	const int64_t high = (a >> 32) * (int64_t)m;
	const uint64_t low = (uint64_t)(uint32_t)a * m;

	return round_shift(high + (int64_t)(low >> 32), shift - 32);
}

/* A non-negative factor: mantissa * 2^-shift. */
struct multiplier {
	uint32_t mantissa;
	int shift;
};

/* Exact; the mantissa has 24 bits. scale is finite and not negative. */
static inline struct multiplier multiplier_from_scale(float scale)
{
	uint32_t bits;
	int exponent;

	memcpy(&bits, &scale, sizeof(bits));
	exponent = (int)(bits >> 23);
	bits &= 0x7fffff;
	if (exponent)
		bits |= 0x800000;
	else
		exponent = 1;
	return (struct multiplier){bits, 150 - exponent};
}

/* To 32 bits: a relative error of at most 2^-32. */
static inline struct multiplier multiplier_from_double(double factor)
{
	int exponent;
	uint64_t mantissa;

	if (!(factor > 0))
		return (struct multiplier){0, 95};
	mantissa = (uint64_t)(ldexp(frexp(factor, &exponent), 32) + 0.5);
	if (mantissa >> 32)
		return (struct multiplier){UINT32_C(1) << 31, 31 - exponent};
	return (struct multiplier){(uint32_t)mantissa, 32 - exponent};
}

/* The product of a 24-bit and a 32-bit one. */
static inline struct multiplier multiplier_product(struct multiplier scale, struct multiplier frame)
{
	const uint64_t product = (uint64_t)scale.mantissa * frame.mantissa;

	return (struct multiplier){(uint32_t)round_shift((int64_t)product, 24),
				   scale.shift + frame.shift - 24};
}

/* Rounded a * m, clamped to -limit..limit. |a| < 2^62. */
static inline int32_t multiplier_apply(struct multiplier m, int64_t a, int32_t limit)
{
	int64_t value;
	int shift = m.shift;

	if (shift > 95) {
		shift = 95; /* all of these round to 0 */
	} else if (shift < 33) {
		const int up = 33 - shift;
		const int64_t magnitude = a < 0 ? -a : a;

		if (up > 61 || magnitude >> (61 - up))
			return a > 0 ? limit : a < 0 ? -limit : 0; /* beyond any limit */
		a = (int64_t)((uint64_t)a << up);
		shift = 33;
	}
	value = mul_shift_round(a, m.mantissa, shift);
	return value > limit ? limit : value < -limit ? -limit : (int32_t)value;
}

/* x * 2^(result - log2 x), its highest bit at place `bit`; *exponent gains what was taken off. Bits
 * that fall off at the right are lost. x > 0. */
static inline uint64_t normalise(uint64_t x, int bit, int *exponent)
{
	const int up = bit - (63 - __builtin_clzll(x));

	*exponent -= up;
	return up >= 0 ? x << up : x >> -up;
}

/*
 * n * n_scale / (d * d_scale) in Q16, clamped to -limit..limit; relative error below 2^-28 before
 * the rounding. Both scales as multiplier_from_scale() gives them. |n| and d < 2^63, and d and its
 * scale > 0.
 */
static inline int32_t quotient_q16(int64_t n, struct multiplier n_scale, int64_t d,
				   struct multiplier d_scale, int32_t limit)
{
	const uint64_t magnitude = n < 0 ? -(uint64_t)n : (uint64_t)n;
	int exponent = d_scale.shift - n_scale.shift + 16, d_exponent = 0;
	uint64_t above, below, quotient;
	int64_t value;

	if (!magnitude || !n_scale.mantissa)
		return 0;
	above = normalise(magnitude, 38, &exponent) * n_scale.mantissa;
	above = normalise(above, 62, &exponent);
	below = normalise((uint64_t)d, 38, &d_exponent) * d_scale.mantissa;
	below = normalise(below, 31, &d_exponent);
	quotient = above / below; /* 2^30 < quotient < 2^32 */
	exponent -= d_exponent;
	if (exponent >= 0)
		value = limit;
	else
		value = exponent < -62 ? 0 : round_shift((int64_t)quotient, -exponent);
	value = value > limit ? limit : value;
	return (int32_t)(n < 0 ? -value : value);
}

#endif
