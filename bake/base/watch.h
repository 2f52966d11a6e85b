/* SPDX-License-Identifier: MIT */
/*
 * Waits until a file that was read changes. Folders are watched (inotify), and events are compared
 * by name, because editors often write another file and rename it over the old one; a file that was
 * not there is waited for, and of symbolic links, of files and of folders, both the link and its
 * target are.
 */
#ifndef INLAY_BAKE_BASE_WATCH_H
#define INLAY_BAKE_BASE_WATCH_H

#include "hal/base/fault.h"

struct watch;

/* 0, -ENOMEM, or -EMFILE ...: the system has no more watches. */
int watch_create(struct watch **watch, struct fault *fault);
void watch_destroy(struct watch *watch); /* NULL is harmless */

/* Forgets the files so far, and adds each that is looked for (hal/base/input.h) until watch_end():
 * at most one watch at a time. A file's change counts from the moment before it is opened.
 * watch_end() returns 0, or the error of a file that cannot be watched. */
void watch_begin(struct watch *watch);
int watch_end(struct watch *watch, struct fault *fault);

/* Waits until a file changes, appears or goes, and then until nothing more has for a tenth of a
 * second, or for a second in all. 1; 0: nothing has within limit_ms (below 0: no limit); errors of
 * poll() and read(). */
int watch_wait(struct watch *watch, int limit_ms, struct fault *fault);

#endif
