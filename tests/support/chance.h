/* SPDX-License-Identifier: MIT */
/*
 * Seeded random numbers. Every run draws the same numbers, so that a new failure comes from a
 * change of the code. INLAY_SEED=n in the environment draws others; tests/seeds.sh tries many.
 */
#ifndef INLAY_TESTS_SUPPORT_CHANCE_H
#define INLAY_TESTS_SUPPORT_CHANCE_H

#include <math.h>
#include <stdint.h>

struct chance {
	uint64_t state;
};

/* The seed of this run: INLAY_SEED, or the default. */
uint64_t chance_seed(void);

/* A generator that starts from chance_seed(). Prints the seed and the test's name in TAP. */
struct chance chance_begin(const char *test);

/* 64 random bits (splitmix64). */
uint64_t chance_bits(struct chance *c);

/* Uniform in from..to. */
double chance_real(struct chance *c, double from, double to);

/* Uniform in from..to, both included. */
int chance_int(struct chance *c, int from, int to);

/* Normal distribution with mean 0 and standard deviation 1 (Box and Muller). */
double chance_normal(struct chance *c);

/* Uniform on the part of the unit sphere with z >= lowest. */
void chance_direction(struct chance *c, double lowest, double dir[3]);

#endif
