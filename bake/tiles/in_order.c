/* SPDX-License-Identifier: MIT */
#include "bake/tiles/in_order.h"

#include <pthread.h>
#include <stdbool.h>

#include "bake/base/strata.h"
#include "hal/base/clock.h"

/* A tile that is not of the sample is begun at most this far ahead of the one whose turn it is,
 * which bounds the memory of those that wait. */
#define WINDOW 64

struct waiting_tile {
	struct finished_tile tile;
	bool ready;
};

struct tile_queue {
	const struct in_order *work;
	pthread_mutex_t lock;  /* guards all below */
	pthread_cond_t turned; /* next has advanced, or a call has failed */
	struct strata strata;
	struct waiting_tile waiting[WINDOW], sample[STRATA_MAX];
	int next, err; /* the tile whose turn it is; the first error */
	uint64_t rays; /* rays of all finished tiles */
	struct fault *fault;
};

static void queue_fail(struct tile_queue *q, int err)
{
	if (!q->err)
		q->err = err;
	pthread_cond_broadcast(&q->turned);
}

static struct waiting_tile *queue_place(struct tile_queue *q, int tile)
{
	const int k = strata_sampled(&q->strata, tile);

	return k < 0 ? &q->waiting[tile % WINDOW] : &q->sample[k];
}

/* Hands on every tile whose turn has come. The caller holds the lock. */
static void queue_hand_on(struct tile_queue *q)
{
	while (!q->err && q->next < q->work->tiles && queue_place(q, q->next)->ready) {
		struct waiting_tile *place = queue_place(q, q->next);
		const int err = q->work->take(q->work->context, &place->tile, q->fault);

		finished_tile_free(&place->tile);
		place->ready = false;
		q->next++;
		if (err)
			queue_fail(q, err);
	}
	pthread_cond_broadcast(&q->turned);
}

/* Waits until the tile is inside the window. Returns false if a call has failed. The sample is
 * begun first, and all other tiles in order, so some thread is always at work on the tile whose
 * turn it is, and the wait ends. */
static bool queue_wait(struct tile_queue *q, int index)
{
	bool go_on;

	pthread_mutex_lock(&q->lock);
	while (!q->err && index >= q->next + WINDOW && strata_sampled(&q->strata, index) < 0)
		pthread_cond_wait(&q->turned, &q->lock);
	go_on = !q->err;
	pthread_mutex_unlock(&q->lock);
	return go_on;
}

static void queue_show_progress(struct tile_queue *q)
{
	struct progress *progress = q->work->progress;
	const double done = q->work->seconds_before + q->strata.cost;

	progress->total = done + strata_left(&q->strata, q->work->tiles_after);
	progress_show(progress, done, q->rays);
}

static void queue_make(void *context, int place, int worker)
{
	struct tile_queue *q = context;
	const int index = strata_piece(&q->strata, place);
	int64_t start_ns;
	struct finished_tile tile = {.blocks = NULL};
	struct fault fault = {.text = ""};
	int err;

	if (!queue_wait(q, index))
		return;
	start_ns = clock_now_ns();
	err = q->work->make(q->work->context, index, worker, &tile, &fault);
	tile.seconds = (double)(clock_now_ns() - start_ns) / NS_PER_S;
	pthread_mutex_lock(&q->lock);
	if (err || q->err) {
		finished_tile_free(&tile);
		if (!q->err)
			*q->fault = fault;
		queue_fail(q, err);
	} else {
		q->rays += tile.account.rays;
		strata_add(&q->strata, index, tile.seconds);
		*queue_place(q, index) = (struct waiting_tile){.tile = tile, .ready = true};
		queue_hand_on(q);
		queue_show_progress(q);
	}
	pthread_mutex_unlock(&q->lock);
}

int in_order_run(const struct in_order *work, struct pool *pool, struct fault *fault)
{
	struct fault reason = {.text = ""};
	struct tile_queue q = {
		.work = work, .rays = work->rays_before, .fault = fault ? fault : &reason};

	pthread_mutex_init(&q.lock, NULL);
	pthread_cond_init(&q.turned, NULL);
	strata_begin(&q.strata, work->tiles);
	pool_run(pool, work->tiles, queue_make, &q);
	for (int k = 0; k < WINDOW; k++)
		finished_tile_free(&q.waiting[k].tile);
	for (int k = 0; k < STRATA_MAX; k++)
		finished_tile_free(&q.sample[k].tile);
	pthread_cond_destroy(&q.turned);
	pthread_mutex_destroy(&q.lock);
	return q.err;
}
