/* SPDX-License-Identifier: MIT */
/*
 * The event loop, on epoll: a fixed set of slots, each with a descriptor or none, signals, and a
 * tick every second. SIGINT and SIGTERM end the program. SIGHUP asks for the configuration to be
 * read again, unless the program's terminal has gone: then it ends the program. Where SIGHUP is
 * ignored (nohup) it stays ignored.
 */
#ifndef INLAY_APP_KIOSK_LOOP_H
#define INLAY_APP_KIOSK_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

#define LOOP_SLOTS 24

struct loop {
	int epoll, signals, timer; /* -1: not open */
	int watched[LOOP_SLOTS];   /* descriptor of each slot; -1: none */
	int terminal;		   /* controlling terminal of the process */
	/* What the last wait found: */
	uint32_t ready; /* bit i: slot i is readable */
	bool tick, stop, reload;
};

/* Opens the loop. Blocks the signals above for the calling thread and for threads that it starts
 * afterwards. */
int loop_open(struct loop *loop, struct fault *fault);
void loop_close(struct loop *loop); /* idempotent, after loop_open() */

void loop_start(struct loop *loop);

/* Polls descriptor in a slot; -1: leaves the slot empty. A descriptor that was closed must leave
 * its slot before its number can be used again. */
int loop_watch(struct loop *loop, int slot, int descriptor, struct fault *fault);

/* Waits until a slot, a signal or the tick is ready. tick and reload are set by this wait only;
 * stop stays set. */
int loop_wait(struct loop *loop, struct fault *fault);

static inline bool loop_ready(const struct loop *loop, int slot)
{
	return loop->ready >> slot & 1;
}

#endif
