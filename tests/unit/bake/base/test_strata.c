/* SPDX-License-Identifier: MIT */
/* Each piece of work is done once, and what is left is known long before the end. */
#include <math.h>
#include <stdlib.h>

#include "bake/base/strata.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define ACROSS 40
#define DOWN 30
#define TILES (ACROSS * DOWN)
#define DRAWS 400

TEST("each piece once")
{
	static const int pieces[] = {0, 1, 2, 3, 4, 7, 48, 80, 191, 192, 193, 1200, 3072};

	for (size_t n = 0; n < sizeof(pieces) / sizeof(*pieces); n++) {
		int *times = calloc((size_t)pieces[n] + 1, sizeof(*times)), last = -1;
		struct strata strata;

		assert_non_null(times);
		strata_begin(&strata, pieces[n]);
		for (int place = 0; place < pieces[n]; place++) {
			const int piece = strata_piece(&strata, place);

			expect_that(piece >= 0 && piece < pieces[n], "place %d of %d", place,
				    pieces[n]);
			times[piece]++;
			expect_equal(strata_sampled(&strata, piece),
				     place < strata.count ? place : -1, "place %d of %d", place,
				     pieces[n]);
			if (place >= strata.count)
				expect_above(piece, last, "place %d of %d", place, pieces[n]);
			last = place < strata.count ? -1 : piece;
		}
		for (int piece = 0; piece < pieces[n]; piece++)
			expect_equal(times[piece], 1, "piece %d of %d", piece, pieces[n]);
		free(times);
	}
}

TEST("equal pieces")
{
	struct strata strata;

	strata_begin(&strata, 100);
	expect_equal(strata_left(&strata, 50), 0, "nothing is known yet");
	for (int place = 0; place < 100; place++) {
		strata_add(&strata, strata_piece(&strata, place), 0.25);
		expect_below(fabs(strata_left(&strata, 50) - 0.25 * (149 - place)), 1e-9,
			     "after place %d", place);
	}
}

/* A bake's costs: an empty sky, a floor, and in its middle an object whose tiles cost 30 times as
 * much, all of them off by a factor of up to 3. */
static void draw_costs(struct chance *c, double cost[TILES])
{
	const double x = chance_real(c, 10, 30), y = chance_real(c, 8, 22);
	const double radius = chance_real(c, 4, 10);

	for (int k = 0; k < TILES; k++) {
		const double away = hypot(k % ACROSS - x, k / ACROSS - y) / radius;

		cost[k] = (away < 1	    ? 30
			   : away < 2	    ? 10
			   : k / ACROSS < 8 ? 0.3
					    : 2) *
			  pow(3, chance_real(c, -1, 1));
	}
}

/* At a quarter of the work, what is left is right within a third in nearly all draws. */
TEST("a quarter tells the rest")
{
	struct chance c = chance_begin(__func__);
	double cost[TILES], square = 0;
	int wrong = 0;

	for (int draw = 0; draw < DRAWS; draw++) {
		double all = 0, done = 0, off;
		struct strata strata;

		draw_costs(&c, cost);
		for (int k = 0; k < TILES; k++)
			all += cost[k];
		strata_begin(&strata, TILES);
		for (int place = 0; done < all / 4; place++) {
			const int piece = strata_piece(&strata, place);

			strata_add(&strata, piece, cost[piece]);
			done += cost[piece];
		}
		off = strata_left(&strata, 0) / (all - done) - 1;
		wrong += fabs(off) > 1.0 / 3;
		square += off * off;
	}
	expect_at_most(wrong, DRAWS / 20, "of %d draws", DRAWS);
	expect_below(sqrt(square / DRAWS), 0.2, "RMS over %d draws", DRAWS);
}
