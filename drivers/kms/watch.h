/* SPDX-License-Identifier: MIT */
/*
 * What happens to a screen while it is open: events of the card, hotplug messages of the kernel and
 * a slow timer, behind one epoll descriptor.
 */
#ifndef INLAY_DRIVERS_KMS_WATCH_H
#define INLAY_DRIVERS_KMS_WATCH_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/base/fault.h"

/* Bits that kms_watch_take() returns. */
enum {
	KMS_READY_CARD = 1,    /* the card has an event to read */
	KMS_READY_HOTPLUG = 2, /* the kernel reports a change of connectors */
	KMS_READY_TICK = 4,    /* four times a second, or soon after kms_watch_soon() */
	KMS_READY_CONSOLE = 8, /* the text console is to be switched */
	KMS_READY_GONE = 16,   /* the card itself was removed */
};

struct kms_watch {
	int set;     /* epoll: the display's descriptor */
	int timer;   /* timerfd of the tick */
	int netlink; /* hotplug messages of the kernel; -1: forbidden, only the tick is left */
};

/* Starts watching. console: descriptor of kms_console.told; -1: none. All members of *watch are -1
 * before. kms_watch_close() cleans up after a failure too. */
int kms_watch_open(struct kms_watch *watch, int card, int console, struct fault *fault);

/* Returns KMS_READY_... bits without waiting. Reads everything but the card and the console. */
unsigned kms_watch_take(struct kms_watch *watch);

void kms_watch_soon(struct kms_watch *watch);  /* brings the next tick forward to 4 ms from now */
void kms_watch_close(struct kms_watch *watch); /* idempotent */

/* Whether a hotplug message (strings, each ended by NUL) is about graphics cards. */
bool kms_watch_concerns(const char *message, size_t length);

#endif
