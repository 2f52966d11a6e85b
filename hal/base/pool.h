/* SPDX-License-Identifier: MIT */
/*
 * A persistent pool of worker threads: started once, woken for each job. A job allocates nothing.
 * The calling thread works too, so a pool of 1 starts no thread.
 */
#ifndef INLAY_HAL_BASE_POOL_H
#define INLAY_HAL_BASE_POOL_H

#include <pthread.h>

#define POOL_THREADS_MAX 1024

struct pool;

/* threads includes the caller, 1..POOL_THREADS_MAX; 0: one for each online processor. Workers have
 * all signals blocked. 0; -EINVAL: out of range; -ENOMEM; -EAGAIN: no more threads. */
int pool_create(struct pool **pool, int threads);

int pool_threads(const struct pool *pool); /* with the caller; pool may be NULL */

/*
 * Calls work(context, item, worker) for each item in 0..items-1, in no set order, and returns when
 * all are done. Threads claim items one at a time from an atomic counter, which balances items of
 * unequal cost. worker is in 0..pool_threads()-1, and no two concurrent calls have the same one:
 * use it to index scratch memory. Not reentrant; one caller at a time. pool NULL: the caller does
 * all.
 */
void pool_run(struct pool *pool, int items, void (*work)(void *context, int item, int worker),
	      void *context);

/* Ends and joins the threads. NULL is harmless. */
void pool_destroy(struct pool *pool);

/* Starts a thread with all signals blocked: that of the event loop handles them. 0 or -errno. */
int thread_start(pthread_t *thread, void *(*run)(void *context), void *context);

#endif
