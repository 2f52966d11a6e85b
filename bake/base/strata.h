/* SPDX-License-Identifier: MIT */
/*
 * What is left of work in numbered pieces of unknown cost. Neighbouring pieces form strata; one
 * piece of each is done first, as a sample of all, then the others in their order:
 *
 *     left = sum over strata (pieces left * mean cost of its pieces that are done)
 *
 * A stratum of which nothing is done counts with the mean of all.
 */
#ifndef INLAY_BAKE_BASE_STRATA_H
#define INLAY_BAKE_BASE_STRATA_H

#define STRATA_MAX 96

struct strata {
	int pieces, count; /* number of strata: 0 where there are few pieces */
	struct {
		int end, sample; /* pieces up to end - 1; the one that is done first */
		int done;
		double cost; /* sum over the pieces that are done */
	} stratum[STRATA_MAX];
	int done;
	double cost;
};

void strata_begin(struct strata *strata, int pieces);

/* The piece whose turn it is at place 0..pieces - 1: the samples, ascending, then all others. */
int strata_piece(const struct strata *strata, int place);

/* The stratum whose sample this piece is, or -1. */
int strata_sampled(const struct strata *strata, int piece);

/* Notes that a piece is done, and what it cost, in any unit. */
void strata_add(struct strata *strata, int piece, double cost);

/* Cost of the pieces that are left, and of `more` pieces like the mean of all. 0 while none is
 * done. */
double strata_left(const struct strata *strata, int more);

#endif
