/* SPDX-License-Identifier: MIT */
#include "hal/base/pool.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

struct pool_worker {
	struct pool *pool;
	pthread_t thread;
	int number;
};

struct pool_job {
	void (*work)(void *context, int item, int worker);
	void *context;
	int items;
};

struct pool {
	pthread_mutex_t lock;
	pthread_cond_t wake, idle;
	/* Guarded by the lock. A job is open from its start until the caller finds no item left. A
	 * worker that wakes later goes back to sleep, and the caller does not wait for it. */
	struct pool_job job;
	unsigned generation;
	bool open, quit;
	int busy;
	atomic_int next; /* the next item to claim */
	int threads;	 /* with the caller */
	int started;	 /* workers that run */
	struct pool_worker workers[];
};

static void pool_take_items(struct pool *pool, const struct pool_job *job, int worker)
{
	for (;;) {
		const int item = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed);

		if (item >= job->items)
			return;
		job->work(job->context, item, worker);
	}
}

static void *pool_worker_main(void *argument)
{
	const struct pool_worker *self = argument;
	struct pool *pool = self->pool;
	unsigned seen = 0;

	pthread_mutex_lock(&pool->lock);
	for (;;) {
		struct pool_job job;

		while (!pool->quit && (!pool->open || pool->generation == seen))
			pthread_cond_wait(&pool->wake, &pool->lock);
		if (pool->quit)
			break;
		seen = pool->generation;
		job = pool->job;
		pool->busy++;
		pthread_mutex_unlock(&pool->lock);

		pool_take_items(pool, &job, self->number);

		pthread_mutex_lock(&pool->lock);
		if (--pool->busy == 0)
			pthread_cond_signal(&pool->idle);
	}
	pthread_mutex_unlock(&pool->lock);
	return NULL;
}

int thread_start(pthread_t *thread, void *(*run)(void *context), void *context)
{
	sigset_t all, before;
	int ret;

	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	ret = -pthread_create(thread, NULL, run, context);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return ret;
}

static int pool_start_workers(struct pool *pool)
{
	int ret = 0;

	while (ret == 0 && pool->started < pool->threads - 1) {
		struct pool_worker *w = &pool->workers[pool->started];

		w->pool = pool;
		w->number = pool->started + 1;
		ret = thread_start(&w->thread, pool_worker_main, w);
		if (ret == 0)
			pool->started++;
	}
	return ret;
}

int pool_create(struct pool **out, int threads)
{
	struct pool *pool;
	int ret;

	*out = NULL;
	if (threads < 0 || threads > POOL_THREADS_MAX)
		return -EINVAL;
	if (threads == 0) {
		const long online = sysconf(_SC_NPROCESSORS_ONLN);

		threads = online < 1 ? 1 : online > POOL_THREADS_MAX ? POOL_THREADS_MAX : online;
	}
	pool = calloc(1, sizeof(*pool) + sizeof(pool->workers[0]) * (size_t)(threads - 1));
	if (!pool)
		return -ENOMEM;
	pool->threads = threads;
	pthread_mutex_init(&pool->lock, NULL);
	pthread_cond_init(&pool->wake, NULL);
	pthread_cond_init(&pool->idle, NULL);
	ret = pool_start_workers(pool);
	if (ret < 0) {
		pool_destroy(pool);
		return ret;
	}
	*out = pool;
	return 0;
}

int pool_threads(const struct pool *pool)
{
	return pool ? pool->threads : 1;
}

void pool_run(struct pool *pool, int items, void (*work)(void *context, int item, int worker),
	      void *context)
{
	const struct pool_job job = {work, context, items};

	if (!pool || items <= 1 || pool->started == 0) {
		for (int i = 0; i < items; i++)
			work(context, i, 0);
		return;
	}

	pthread_mutex_lock(&pool->lock);
	pool->job = job;
	pool->generation++;
	pool->open = true;
	atomic_store_explicit(&pool->next, 0, memory_order_relaxed);
	pthread_cond_broadcast(&pool->wake);
	pthread_mutex_unlock(&pool->lock);

	pool_take_items(pool, &job, 0);

	pthread_mutex_lock(&pool->lock);
	pool->open = false;
	while (pool->busy > 0)
		pthread_cond_wait(&pool->idle, &pool->lock);
	pthread_mutex_unlock(&pool->lock);
}

void pool_destroy(struct pool *pool)
{
	if (!pool)
		return;
	pthread_mutex_lock(&pool->lock);
	pool->quit = true;
	pthread_cond_broadcast(&pool->wake);
	pthread_mutex_unlock(&pool->lock);
	for (int i = 0; i < pool->started; i++)
		pthread_join(pool->workers[i].thread, NULL);
	pthread_cond_destroy(&pool->idle);
	pthread_cond_destroy(&pool->wake);
	pthread_mutex_destroy(&pool->lock);
	free(pool);
}
