/* SPDX-License-Identifier: MIT */
#include "bake/base/strata.h"

#include <math.h>
#include <stdint.h>

/* Fewest pieces of a stratum. */
#define PIECES_LEAST 6
/* Samples lie at multiples of this in their strata, modulo 1: where pieces are rows of a picture,
 * none of its columns is preferred. A step of the plane's low-discrepancy sequence, 1 / plastic
 * number^2. */
#define STEP 0.569840290998053

void strata_begin(struct strata *s, int pieces)
{
	int first = 0;

	*s = (struct strata){.pieces = pieces,
			     .count = (int)fmin(pieces / PIECES_LEAST, STRATA_MAX)};
	for (int k = 0; k < s->count; k++) {
		const int end = (int)((int64_t)(k + 1) * pieces / s->count);

		s->stratum[k].end = end;
		s->stratum[k].sample = first + (int)(fmod(k * STEP, 1) * (end - first));
		first = end;
	}
}

int strata_piece(const struct strata *s, int place)
{
	int piece = place - s->count;

	if (place < s->count)
		return s->stratum[place].sample;
	for (int k = 0; k < s->count && s->stratum[k].sample <= piece; k++)
		piece++;
	return piece;
}

static int strata_find(const struct strata *s, int piece)
{
	int k = 0;

	while (k < s->count && piece >= s->stratum[k].end)
		k++;
	return k;
}

int strata_sampled(const struct strata *s, int piece)
{
	const int k = strata_find(s, piece);

	return k < s->count && s->stratum[k].sample == piece ? k : -1;
}

void strata_add(struct strata *s, int piece, double cost)
{
	const int k = strata_find(s, piece);

	s->done++;
	s->cost += cost;
	if (k < s->count) {
		s->stratum[k].done++;
		s->stratum[k].cost += cost;
	}
}

double strata_left(const struct strata *s, int more)
{
	const double mean = s->done ? s->cost / s->done : 0;
	double left = more * mean;
	int first = 0;

	for (int k = 0; k < s->count; k++) {
		const int done = s->stratum[k].done;

		left += (s->stratum[k].end - first - done) *
			(done ? s->stratum[k].cost / done : mean);
		first = s->stratum[k].end;
	}
	return s->count ? left : left + (s->pieces - s->done) * mean;
}
