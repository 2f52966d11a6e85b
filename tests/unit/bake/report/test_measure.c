/* SPDX-License-Identifier: MIT */
/* What bench and report measure with: runs in turn, quartiles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/measure/measure.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* ---- turns ---- */

#define WAYS 3
#define REPEAT 4

struct log {
	int prepared[WAYS], ran[WAYS];
	int last_turn, last_way;
	bool disordered;
	int fails_at; /* number of the way that fails; -1: none */
};

static int test_measure_prepare(void *context, int way, int turn)
{
	struct log *log = context;

	log->prepared[way]++;
	log->disordered |= turn < log->last_turn || (turn == log->last_turn && way < log->last_way);
	log->last_turn = turn;
	log->last_way = way;
	return 0;
}

/* The third way sleeps, which takes time of the clock and not of the processor. */
static int test_measure_run(void *context, int way)
{
	struct log *log = context;

	log->ran[way]++;
	log->disordered |= way != log->last_way;
	if (way == 2)
		usleep(2000);
	return way == log->fails_at ? -5 : 0;
}

static struct turns turns_of(struct log *log)
{
	return (struct turns){.context = log,
			      .ways = WAYS,
			      .repeat = REPEAT,
			      .prepare = test_measure_prepare,
			      .run = test_measure_run};
}

TEST("ways take turns")
{
	struct log log = {.fails_at = -1};
	struct turns turns = turns_of(&log);
	double ms[WAYS * REPEAT];

	for (int k = 0; k < WAYS * REPEAT; k++)
		ms[k] = -1;
	assert_int_equal(turns_time(&turns, ms), 0);
	assert_false(log.disordered);
	for (int k = 0; k < WAYS; k++) {
		expect_at_least(log.ran[k], 2 * REPEAT, "k=%d", k); /* some of them untimed */
		expect_equal(log.prepared[k], log.ran[k], "k=%d", k);
	}
	for (int k = 0; k < WAYS * REPEAT; k++)
		expect_at_least(ms[k], 0, "k=%d", k);
	/* a sleeping way: the clock goes on, the processor does other work */
	assert_true(turns.timed_ns >= REPEAT * 2 * NS_PER_MS);
	assert_true(turns.ran_ns < turns.timed_ns);
	assert_true(turns_spread(ms + (ptrdiff_t)2 * REPEAT, REPEAT).median < 2);
	turns.shared = true;
	turns.timed_ns = 0;
	assert_int_equal(turns_time(&turns, ms), 0);
	assert_true(turns.timed_ns == 0);
	assert_true(turns_spread(ms + (ptrdiff_t)2 * REPEAT, REPEAT).low >= 2);
}

TEST("a failure ends all")
{
	struct log log = {.fails_at = 1};
	struct turns turns = turns_of(&log);
	double ms[WAYS * REPEAT];

	assert_int_equal(turns_time(&turns, ms), -5);
	assert_int_equal(log.ran[1], 1);
	assert_int_equal(log.ran[2], 0);
}

TEST("half of the times are between the quartiles")
{
	double nine[] = {5, 9, 1, 7, 3, 2, 8, 6, 4}, four[] = {40, 10, 30, 20}, one[] = {7};
	const struct turns_spread of_nine = turns_spread(nine, 9), of_four = turns_spread(four, 4),
				  of_one = turns_spread(one, 1);

	assert_true(of_nine.low == 3 && of_nine.median == 5 && of_nine.high == 7);
	assert_true(of_four.low == 17.5 && of_four.median == 25 && of_four.high == 32.5);
	assert_true(of_one.low == 7 && of_one.median == 7 && of_one.high == 7);
}
