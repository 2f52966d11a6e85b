/* SPDX-License-Identifier: MIT */
/* The pool runs every item once, one item at a time on each worker, and loses nothing between jobs.
 */
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/base/pool.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define ITEMS 5000

struct pool_record {
	atomic_int calls[ITEMS];
	atomic_int busy[64];
	atomic_int clashes, strangers;
	int threads;
	/* Not atomic, so that the thread sanitizer sees two callers on one worker. */
	int scratch[64];
};

static void note(void *context, int item, int worker)
{
	struct pool_record *r = context;

	if (worker < 0 || worker >= r->threads) {
		r->strangers++;
		return;
	}
	if (atomic_fetch_add(&r->busy[worker], 1) != 0)
		r->clashes++;
	r->scratch[worker] += item;
	r->calls[item]++;
	atomic_fetch_sub(&r->busy[worker], 1);
}

TEST("every item once")
{
	static const int counts[] = {0, 1, 2, 3, 7, 64, ITEMS};
	static struct pool_record r;

	for (int threads = 0; threads <= 8; threads++) {
		struct pool *pool = NULL; /* without threads */

		assert_int_equal(threads ? pool_create(&pool, threads) : 0, 0);
		expect_equal(pool_threads(pool), threads ? threads : 1, "threads=%d", threads);
		for (unsigned k = 0; k < sizeof(counts) / sizeof(*counts); k++) {
			int sum = 0;

			memset(&r, 0, sizeof(r));
			r.threads = pool_threads(pool);
			pool_run(pool, counts[k], note, &r);
			for (int i = 0; i < ITEMS; i++)
				expect_equal(r.calls[i], i < counts[k], "threads=%d, k=%u, i=%d",
					     threads, k, i);
			for (int w = 0; w < r.threads; w++)
				sum += r.scratch[w];
			expect_equal(sum, counts[k] * (counts[k] - 1) / 2, "threads=%d, k=%u",
				     threads, k);
			expect_equal(r.clashes, 0, "threads=%d, k=%u", threads, k);
			expect_equal(r.strangers, 0, "threads=%d, k=%u", threads, k);
		}
		pool_destroy(pool);
	}
}

TEST("many short jobs")
{
	static struct pool_record r;
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 4), 0);
	memset(&r, 0, sizeof(r));
	r.threads = 4;
	for (int job = 0; job < 20000; job++)
		pool_run(pool, 1 + job % 5, note, &r);
	pool_destroy(pool);
	/* 20000 / 5 rounds of 1 + 2 + 3 + 4 + 5 items */
	assert_int_equal(r.calls[0], 20000);
	assert_int_equal(r.calls[4], 4000);
	assert_int_equal(r.clashes, 0);
}

/* An item that ends some time after a worker has claimed it. */
static void finish_late(void *context, int item, int worker)
{
	const struct timespec nap = {0, NS_PER_MS / 2};
	int *finished = context;

	(void)worker;
	nanosleep(&nap, NULL);
	finished[item] = 1; /* not atomic: only the end of the job may make it visible */
}

TEST("returns when all are done")
{
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 4), 0);
	for (int round = 0; round < 100; round++) {
		int finished[7] = {0};

		pool_run(pool, 7, finish_late, finished);
		for (int i = 0; i < 7; i++)
			expect_equal(finished[i], 1, "round=%d, i=%d", round, i);
	}
	pool_destroy(pool);
}

struct pool_meeting {
	pthread_mutex_t lock;
	pthread_cond_t changed;
	int present, most;
};

/* Waits up to a minute until three workers are here at once, which needs real concurrency. */
static void meet(void *context, int item, int worker)
{
	struct pool_meeting *m = context;
	struct timespec until;

	(void)item;
	(void)worker;
	clock_gettime(CLOCK_REALTIME, &until);
	until.tv_sec += 60;
	pthread_mutex_lock(&m->lock);
	m->present++;
	if (m->present > m->most)
		m->most = m->present;
	pthread_cond_broadcast(&m->changed);
	while (m->most < 3 && pthread_cond_timedwait(&m->changed, &m->lock, &until) == 0)
		;
	m->present--;
	pthread_mutex_unlock(&m->lock);
}

TEST("works side by side")
{
	struct pool_meeting m = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, 0, 0};
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 3), 0);
	pool_run(pool, 3, meet, &m);
	pool_destroy(pool);
	assert_int_equal(m.most, 3);
}

static void check_caller(void *context, int item, int worker)
{
	const pthread_t *caller = context;

	(void)item;
	assert_int_equal(worker, 0);
	assert_true(pthread_equal(*caller, pthread_self()));
}

TEST("one thread is the caller")
{
	pthread_t self = pthread_self();
	struct pool *pool;

	assert_int_equal(pool_create(&pool, 1), 0);
	pool_run(pool, 100, check_caller, &self);
	pool_destroy(pool);
}

static void check_signals(void *context, int item, int worker)
{
	atomic_int *open = context;
	sigset_t blocked;

	(void)item;
	pthread_sigmask(SIG_SETMASK, NULL, &blocked);
	if (worker > 0 && !sigismember(&blocked, SIGTERM))
		(*open)++;
}

TEST("workers leave signals alone")
{
	atomic_int open = 0;
	struct pool *pool;
	sigset_t blocked;

	assert_int_equal(pool_create(&pool, 4), 0);
	pool_run(pool, 1000, check_signals, &open);
	pool_destroy(pool);
	assert_int_equal(open, 0);
	pthread_sigmask(SIG_SETMASK, NULL, &blocked);
	assert_false(sigismember(&blocked, SIGTERM));
}

static void nothing(void *context, int item, int worker)
{
	(void)context;
	(void)item;
	(void)worker;
}

/* Between jobs the workers sleep: process time stands still while wall time passes. */
TEST("sleeps between jobs")
{
	const struct timespec nap = {0, 200 * NS_PER_MS};
	struct timespec before, after;
	struct pool *pool;
	int64_t spent_ns;

	assert_int_equal(pool_create(&pool, 8), 0);
	pool_run(pool, 100, nothing, NULL);
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &before);
	nanosleep(&nap, NULL);
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &after);
	pool_destroy(pool);
	spent_ns = (after.tv_sec - before.tv_sec) * NS_PER_S + after.tv_nsec - before.tv_nsec;
	assert_true(spent_ns < 50 * NS_PER_MS);
}

TEST("limits")
{
	struct pool *pool;

	assert_int_equal(pool_create(&pool, -1), -EINVAL);
	assert_null(pool);
	assert_int_equal(pool_create(&pool, POOL_THREADS_MAX + 1), -EINVAL);
	assert_int_equal(pool_create(&pool, 0), 0);
	assert_int_equal(pool_threads(pool), sysconf(_SC_NPROCESSORS_ONLN));
	pool_destroy(pool);
	pool_destroy(NULL);
}
