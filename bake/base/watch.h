/* SPDX-License-Identifier: MIT */
/*
 * Waits until a file that was read changes: another time, size or file under its name, links
 * followed. A file that was not there is waited for. Looks ten times a second, which works on
 * network file systems, too.
 */
#ifndef INLAY_BAKE_BASE_WATCH_H
#define INLAY_BAKE_BASE_WATCH_H

#include <stdbool.h>

#include "hal/base/fault.h"

struct watch;

int watch_create(struct watch **watch, struct fault *fault); /* -ENOMEM */
void watch_destroy(struct watch *watch);		     /* NULL is harmless */

/* Forgets the files so far, and adds each that is looked for (hal/base/input.h) until
 * watch_end(): at most one watch at a time. A file's change counts from the moment before it is
 * opened. -ENOMEM. */
void watch_begin(struct watch *watch);
int watch_end(struct watch *watch, struct fault *fault);

/* Waits until a file changes, appears or goes, and then until nothing more has for a tenth of a
 * second, or for a second in all. False: nothing has within limit_ms (below 0: no limit). */
bool watch_wait(struct watch *watch, int limit_ms);

#endif
