/* SPDX-License-Identifier: MIT */
#include "hal/look/grain_tables.h"

#include <math.h>

/* Tables are made anew once a correlation has moved by this; chosen, as a change of a twentieth
 * cannot be seen in the picture. */
#define CORRELATION_MOVED 0.05

static uint64_t random_bits(uint64_t *state)
{
	uint64_t x = *state += 0x9e3779b97f4a7c15u;

	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/* Returns a nearly normal number of mean 0 and variance 1: the sum of twelve uniform numbers, less
 * 6. Integers keep it exact, so that it is the same on every machine. */
static double random_normal(uint64_t *state)
{
	int64_t sum = 0;

	for (int i = 0; i < 4; i++) {
		const uint64_t bits = random_bits(state);

		sum += (int64_t)(bits & 0x1fffff) + (int64_t)((bits >> 21) & 0x1fffff) +
		       (int64_t)((bits >> 42) & 0x1fffff);
	}
	return (double)sum * 0x1p-21 - 6;
}

/* Makes noise of variance 1 that is correlated with its neighbours to the left and above. It is
 * autoregressive of order one in both directions: v = r v' + sqrt(1 - r^2) w, with w white. */
static void make_correlated(double across, double down, uint64_t *state, float (*to)[GRAIN_SIDE])
{
	const double w_across = sqrt(1 - across * across), w_down = sqrt(1 - down * down);

	for (int y = 0; y < GRAIN_SIDE; y++) {
		double row = random_normal(state);

		for (int x = 0; x < GRAIN_SIDE; x++) {
			row = x ? across * row + w_across * random_normal(state) : row;
			to[y][x] = (float)(y ? down * (double)to[y - 1][x] + w_down * row : row);
		}
	}
}

static int8_t table_value(double n)
{
	const double scaled = round(n * GRAIN_ONE);

	return (int8_t)(scaled > 127 ? 127 : scaled < -127 ? -127 : scaled);
}

static void make_tables(struct grain_tables *t, const struct sensor_noise_model *m)
{
	static float common[GRAIN_SIDE][GRAIN_SIDE], own[GRAIN_SIDE][GRAIN_SIDE];
	const double shared = sqrt(m->channels), alone = sqrt(1 - m->channels);
	uint64_t state = 1;

	make_correlated(m->across, m->down, &state, common);
	for (int c = 0; c < 3; c++) {
		make_correlated(m->across, m->down, &state, own);
		for (int y = 0; y < GRAIN_SIDE; y++)
			for (int x = 0; x < GRAIN_SIDE; x++)
				t->n[c][y][x] = table_value(shared * (double)common[y][x] +
							    alone * (double)own[y][x]);
	}
	t->across = m->across;
	t->down = m->down;
	t->channels = m->channels;
	t->made = true;
}

void grain_tables_fit(struct grain_tables *t, const struct sensor_noise_model *m,
		      struct grain *grain)
{
	if (!t->made || fabs(t->across - m->across) > CORRELATION_MOVED ||
	    fabs(t->down - m->down) > CORRELATION_MOVED ||
	    fabs(t->channels - m->channels) > CORRELATION_MOVED)
		make_tables(t, m);
	for (int c = 0; c < 3; c++) {
		grain->floor[c] = (float)m->floor[c];
		grain->slope[c] = (float)m->slope[c];
		grain->table[c] = t->n[c][0];
	}
}
