/* SPDX-License-Identifier: MIT */
/*
 * A persistent pool of worker threads: started once, woken for each job, nothing allocated per job.
 *
 * The calling thread works too, so a pool of 1 starts no thread at all.
 */
#ifndef INLAY_HAL_BASE_POOL_H
#define INLAY_HAL_BASE_POOL_H

#define POOL_THREADS_MAX 1024

struct pool;

/* threads counts the caller, 1..POOL_THREADS_MAX; 0 means one for each online processor. 0 or
 * -errno: -EINVAL out of range, -ENOMEM, -EAGAIN (no more threads). Workers have all signals
 * blocked. */
int pool_create(struct pool **pool, int threads);

int pool_threads(const struct pool *pool);

/*
 * Calls work(context, item, worker) for each item in 0..items-1, in no set order, and returns when
 * all are done. Items are claimed one at a time from an atomic counter, so uneven ones balance.
 * worker is in 0..pool_threads()-1 and no two concurrent calls share one: index scratch space by
 * it. Not reentrant; one caller at a time.
 */
void pool_run(struct pool *pool, int items, void (*work)(void *context, int item, int worker),
	      void *context);

/* Joins the threads. NULL is harmless. */
void pool_destroy(struct pool *pool);

#endif
