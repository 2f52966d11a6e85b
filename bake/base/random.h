/* SPDX-License-Identifier: MIT */
/*
 * Random numbers and low-discrepancy points. All are functions of pixel, sample and seed, so that a
 * picture does not depend on threads or on the order of tiles.
 */
#ifndef INLAY_BAKE_BASE_RANDOM_H
#define INLAY_BAKE_BASE_RANDOM_H

#include <stdint.h>

/* The finaliser of SplitMix64 (Steele, Lea and Flood 2014): every bit depends on every bit. */
static inline uint64_t random_mix(uint64_t x)
{
	x = (x ^ (x >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
	x = (x ^ (x >> 27)) * UINT64_C(0x94d049bb133111eb);
	return x ^ (x >> 31);
}

static inline uint64_t random_hash(uint64_t a, uint64_t b, uint64_t c)
{
	const uint64_t step = UINT64_C(0x9e3779b97f4a7c15);

	return random_mix(random_mix(random_mix(a + step) + b + step) + c + step);
}

static inline uint32_t random_hash32(uint32_t x)
{
	x = (x ^ (x >> 16)) * UINT32_C(0x7feb352d);
	x = (x ^ (x >> 15)) * UINT32_C(0x846ca68b);
	return x ^ (x >> 16);
}

/* Uniform number from 32 random bits, 0 <= x < 1. */
static inline float random_unit(uint32_t bits)
{
	return (float)(bits >> 8) * 0x1p-24f;
}

/* The generator SplitMix64. */
struct random {
	uint64_t state;
};

static inline uint64_t random_bits(struct random *r)
{
	r->state += UINT64_C(0x9e3779b97f4a7c15);
	return random_mix(r->state);
}

static inline float random_next(struct random *r)
{
	return random_unit((uint32_t)(random_bits(r) >> 32));
}

/* First two dimensions of Sobol's sequence: every aligned run of 2^m points is a (0,m,2)-net. It
 * stays one when the bits of a dimension are XORed with a constant. */
static inline uint32_t sobol_first(uint32_t index)
{
	index = (index << 16) | (index >> 16);
	index = ((index & UINT32_C(0x00ff00ff)) << 8) | ((index & UINT32_C(0xff00ff00)) >> 8);
	index = ((index & UINT32_C(0x0f0f0f0f)) << 4) | ((index & UINT32_C(0xf0f0f0f0)) >> 4);
	index = ((index & UINT32_C(0x33333333)) << 2) | ((index & UINT32_C(0xcccccccc)) >> 2);
	return ((index & UINT32_C(0x55555555)) << 1) | ((index & UINT32_C(0xaaaaaaaa)) >> 1);
}

static inline uint32_t sobol_second(uint32_t index)
{
	uint32_t bits = 0;

	for (uint32_t v = UINT32_C(1) << 31; index; index >>= 1, v ^= v >> 1)
		if (index & 1)
			bits ^= v;
	return bits;
}

/* Point of the net, its bits XORed with those of scramble; 0 <= x < 1. */
static inline void sobol_point(uint32_t index, uint64_t scramble, double point[2])
{
	point[0] = (sobol_first(index) ^ (uint32_t)scramble) * 0x1p-32;
	point[1] = (sobol_second(index) ^ (uint32_t)(scramble >> 32)) * 0x1p-32;
}

/*
 * Permutes the indices of a sequence so that aligned runs of 2^m stay aligned runs of 2^m. Pairs
 * taken from differently shuffled sequences are independent of each other (Owen scrambling of the
 * index by the hash of Laine and Karras 2011, with Vegdahl's constants).
 */
static inline uint32_t sobol_shuffle(uint32_t index, uint32_t seed)
{
	uint32_t x = sobol_first(index); /* the bits reversed */

	x += seed;
	x ^= x * UINT32_C(0x6c50b47c);
	x ^= x * UINT32_C(0xb82f1e52);
	x ^= x * UINT32_C(0xc7afe638);
	x ^= x * UINT32_C(0x8d22f6e6);
	return sobol_first(x);
}

#endif
