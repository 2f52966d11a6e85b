/* SPDX-License-Identifier: MIT */
/*
 * Keeps what was chosen with the buttons over a power cut: threshold, view and pose, in a small INI
 * file that is replaced whole (hal/base/output.h) at most once an interval and at the end. A thread
 * of its own writes it, because a disk may be slow.
 */
#ifndef INLAY_APP_RECORDS_STATE_H
#define INLAY_APP_RECORDS_STATE_H

#include "config/config.h"
#include "hal/base/fault.h"

struct state_values {
	struct ini_level threshold; /* 0..255 or 0..100 % */
	int view;		    /* enum config_show */
	int pose;		    /* at least 0; the caller checks whether the basis has it */
};

/* Reads the file. Keys that are missing leave their value alone; so does any fault, which names
 * file and line. -ENOENT: there is no file. */
int state_read(const char *path, struct state_values *values, struct fault *fault);

/* The same for the text of a file, in memory. */
int state_read_memory(const char *text, size_t bytes, const char *name, struct state_values *values,
		      struct fault *fault);

struct state;

/* Starts the thread. now: what the file holds, or need not hold. 0 or -errno. */
int state_create(struct state **state, const struct config_state *settings,
		 const struct state_values *now);

/* Writes to another file or at another interval from now on. NULL is harmless, here and below. */
void state_move(struct state *state, const struct config_state *settings);

/* Has the values written; never waits. A file that cannot be written (a full disk, a missing
 * folder) is logged once, and tried again each interval, at least each second. */
void state_keep(struct state *state, const struct state_values *values);

/* Writes what has not been written yet, and ends the thread. */
void state_destroy(struct state *state);

#endif
