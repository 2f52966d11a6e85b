/* SPDX-License-Identifier: MIT */
#include "tests/support/chance.h"

#include <stdio.h>
#include <stdlib.h>

uint64_t chance_seed(void)
{
	const char *given = getenv("INLAY_SEED");

	return given ? strtoull(given, NULL, 0) : 20261120;
}

struct chance chance_begin(const char *test)
{
	const uint64_t seed = chance_seed();

	printf("# %s: INLAY_SEED=%llu\n", test, (unsigned long long)seed);
	return (struct chance){seed * 2 + 1};
}

uint64_t chance_bits(struct chance *c)
{
	uint64_t z = c->state += 0x9e3779b97f4a7c15;

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
	z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
	return z ^ (z >> 31);
}

double chance_real(struct chance *c, double from, double to)
{
	return from + (to - from) * ldexp((double)(chance_bits(c) >> 11), -53);
}

int chance_int(struct chance *c, int from, int to)
{
	return from + (int)(chance_bits(c) % (uint64_t)(to - from + 1));
}

double chance_normal(struct chance *c)
{
	const double u = 1 - chance_real(c, 0, 1), v = chance_real(c, 0, 2 * M_PI);

	return sqrt(-2 * log(u)) * cos(v);
}

void chance_direction(struct chance *c, double lowest, double dir[3])
{
	const double z = chance_real(c, lowest, 1), phi = chance_real(c, 0, 2 * M_PI);
	const double r = sqrt(fmax(0, 1 - z * z));

	dir[0] = r * cos(phi);
	dir[1] = r * sin(phi);
	dir[2] = z;
}
