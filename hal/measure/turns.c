/* SPDX-License-Identifier: MIT */
#include "hal/measure/measure.h"

#include <stdlib.h>

#include "hal/base/clock.h"

/* Untimed runs before each timed one: at most this many, or until this time has passed. */
#define WARM_RUNS 8
#define WARM_NS (2 * NS_PER_MS)

/* Processor time of this thread, in ns. */
static int64_t thread_ns(void)
{
	struct timespec t;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
	return (int64_t)t.tv_sec * NS_PER_S + t.tv_nsec;
}

/* Warms caches and branch predictors; a short run needs several repetitions. */
static int warm_up(const struct turns *t, int way, int turn)
{
	const int64_t start = thread_ns();
	int err = 0;

	for (int n = 0; !err && n < WARM_RUNS && thread_ns() - start < WARM_NS; n++) {
		err = t->prepare(t->context, way, turn);
		if (!err)
			err = t->run(t->context, way);
	}
	return err;
}

static int time_run(struct turns *t, int way, int turn, double *ms)
{
	int64_t start, ran, took;
	int err = warm_up(t, way, turn);

	if (!err)
		err = t->prepare(t->context, way, turn);
	if (err)
		return err;
	ran = thread_ns();
	start = clock_now_ns();
	err = t->run(t->context, way);
	took = clock_now_ns() - start;
	ran = thread_ns() - ran;
	t->timed_ns += t->shared ? 0 : took;
	t->ran_ns += t->shared ? 0 : ran;
	*ms = (double)(t->shared ? took : ran) / (double)NS_PER_MS;
	return err;
}

int turns_time(struct turns *t, double *ms)
{
	int err = 0;

	for (int turn = 0; !err && turn < t->repeat; turn++)
		for (int way = 0; !err && way < t->ways; way++)
			err = time_run(t, way, turn, ms + (int64_t)way * t->repeat + turn);
	return err;
}

static int rising(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

static double sorted_quantile(const double *ms, int count, double share)
{
	const double at = share * (count - 1);
	const int below = (int)at, above = below + 1 < count ? below + 1 : below;

	return ms[below] + (at - below) * (ms[above] - ms[below]);
}

struct turns_spread turns_spread(double *ms, int count)
{
	qsort(ms, (size_t)count, sizeof(*ms), rising);
	return (struct turns_spread){.least = ms[0],
				     .low = sorted_quantile(ms, count, 0.25),
				     .median = sorted_quantile(ms, count, 0.5),
				     .high = sorted_quantile(ms, count, 0.75)};
}
