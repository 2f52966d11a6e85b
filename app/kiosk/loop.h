/* SPDX-License-Identifier: MIT */
/*
 * The one epoll loop: a fixed set of slots, each with a descriptor or none. Also signals, and a
 * tick every second. SIGINT and SIGTERM end the program. SIGHUP does when it came because the
 * terminal has gone; otherwise somebody asks for the configuration to be read again. Under nohup it
 * is ignored.
 */
#ifndef INLAY_APP_KIOSK_LOOP_H
#define INLAY_APP_KIOSK_LOOP_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

#define LOOP_SLOTS 24

struct loop {
	int epoll, signals, timer; /* -1: not there */
	int watched[LOOP_SLOTS];   /* -1: nothing */
	int terminal;		   /* it was started from; -1: none */
	/* What the last wait found: */
	uint32_t ready; /* bit i: slot i */
	bool tick, stop, reload;
};

/* Blocks those signals for the caller and for threads that it starts from then on. */
int loop_open(struct loop *loop, struct fault *fault);
void loop_close(struct loop *loop); /* idempotent, after loop_open() */

void loop_start(struct loop *loop);

/* Polls descriptor in a slot from now on; -1: nothing. A descriptor that was closed must leave its
 * slot (-1) before its number can come back. */
int loop_watch(struct loop *loop, int slot, int descriptor, struct fault *fault);

/* Waits until something is ready. tick and reload are of this wait; stop stays. */
int loop_wait(struct loop *loop, struct fault *fault);

static inline bool loop_ready(const struct loop *loop, int slot)
{
	return loop->ready >> slot & 1;
}

#endif
