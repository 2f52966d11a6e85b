/* SPDX-License-Identifier: MIT */
#include "bake/tiles/in_order.h"

#include <pthread.h>
#include <stdbool.h>

/* How far a tile may be ahead of the one whose turn it is. */
#define WINDOW 64

struct tile_queue {
	const struct in_order *work;
	pthread_mutex_t lock;  /* guards all below */
	pthread_cond_t turned; /* next has advanced, or a call has failed */
	struct {
		struct finished_tile tile;
		bool ready;
	} waiting[WINDOW];
	int next, err; /* the tile whose turn it is; the first error */
	uint64_t rays; /* of all finished tiles */
	struct fault *fault;
};

static void queue_fail(struct tile_queue *q, int err)
{
	if (!q->err)
		q->err = err;
	pthread_cond_broadcast(&q->turned);
}

/* Hands on every tile whose turn has come. The caller holds the lock. */
static void queue_hand_on(struct tile_queue *q)
{
	while (!q->err && q->waiting[q->next % WINDOW].ready) {
		struct finished_tile *tile = &q->waiting[q->next % WINDOW].tile;
		const int err = q->work->take(q->work->context, tile, q->fault);

		finished_tile_free(tile);
		q->waiting[q->next % WINDOW].ready = false;
		q->next++;
		if (err)
			queue_fail(q, err);
	}
	pthread_cond_broadcast(&q->turned);
}

/* Waits until the tile is inside the window. False when a call has failed. Tiles are begun in
 * order, so some thread is always at work on the one whose turn it is, and the wait ends. */
static bool queue_wait(struct tile_queue *q, int index)
{
	bool go_on;

	pthread_mutex_lock(&q->lock);
	while (!q->err && index >= q->next + WINDOW)
		pthread_cond_wait(&q->turned, &q->lock);
	go_on = !q->err;
	pthread_mutex_unlock(&q->lock);
	return go_on;
}

static void queue_make(void *context, int index, int worker)
{
	struct tile_queue *q = context;
	struct finished_tile tile = {.blocks = NULL};
	struct fault fault = {.text = ""};
	int err;

	if (!queue_wait(q, index))
		return;
	err = q->work->make(q->work->context, index, worker, &tile, &fault);
	pthread_mutex_lock(&q->lock);
	if (err || q->err) {
		finished_tile_free(&tile);
		if (!q->err)
			*q->fault = fault;
		queue_fail(q, err);
	} else {
		q->rays += tile.account.rays;
		q->waiting[index % WINDOW].tile = tile;
		q->waiting[index % WINDOW].ready = true;
		queue_hand_on(q);
		progress_show(q->work->progress, q->work->tiles_before + q->next, q->rays);
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
	pool_run(pool, work->tiles, queue_make, &q);
	for (int k = 0; k < WINDOW; k++)
		finished_tile_free(&q.waiting[k].tile);
	pthread_cond_destroy(&q.turned);
	pthread_mutex_destroy(&q.lock);
	return q.err;
}
