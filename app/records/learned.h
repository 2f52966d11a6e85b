/* SPDX-License-Identifier: MIT */
/*
 * Keeps over a power cut what was learned of the place without people (hal/people), beside the file
 * of [state] and under its name with .place: at most 20 MB, replaced whole (hal/base/output.h). It
 * is first written 4 intervals of [state] after learning began, then every 360, and at the end.
 * What is written is copied part by part between pictures; a thread of its own seals and writes it.
 */
#ifndef INLAY_APP_RECORDS_LEARNED_H
#define INLAY_APP_RECORDS_LEARNED_H

#include <stdint.h>

#include "app/pipeline/pipeline.h"
#include "config/config.h"

struct learned;

/* Starts the thread. 0 or -errno. Calls come from one thread; NULL is harmless in all of them. */
int learned_create(struct learned **learned, const struct config_state *settings);

/* Gives what is kept to a pipeline that has not looked at a frame yet; it does nothing to others. A
 * file that is damaged or of another place is logged and not used. To be called for each new
 * pipeline, and when its settings have changed. */
void learned_restore(struct learned *learned, struct pipeline *pipeline);

/* Has it written when it is time to; never waits. To be called after each picture. A file that
 * cannot be written is logged once, and tried again when it is next due. */
void learned_keep(struct learned *learned, const struct pipeline *pipeline);

/* Another file or interval counts from now on. */
void learned_move(struct learned *learned, const struct config_state *settings);

/* What is seen was taken as the place: it is written soon. */
void learned_soon(struct learned *learned);

/* Removes the file. */
void learned_forget(struct learned *learned);

/* Writes what was learned, and ends the thread. pipeline NULL: nothing was. */
void learned_destroy(struct learned *learned, const struct pipeline *pipeline);

#endif
