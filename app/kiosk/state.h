/* SPDX-License-Identifier: MIT */
/*
 * What was chosen with the buttons, kept over a power cut: threshold, view and pose in a small INI
 * file that is replaced whole (hal/base/output.h), at most once an interval and at the end, by a thread
 * of its own, because a disk may take its time.
 */
#ifndef INLAY_APP_KIOSK_STATE_H
#define INLAY_APP_KIOSK_STATE_H

#include "config/config.h"
#include "hal/base/fault.h"

struct state_values {
	struct ini_level threshold; /* 0..255 or 0..100 % */
	int view;		    /* enum config_show */
	int pose; /* of at least 0; whether the basis has it is for the caller to find out */
};

/* Reads what was kept; keys that are missing leave their value alone. -ENOENT: nothing was. On any
 * fault, which names file and line, all values are left alone. */
int state_read(const char *path, struct state_values *values, struct fault *fault);

/* The same for text in memory. */
int state_read_memory(const char *text, size_t bytes, const char *name, struct state_values *values,
		      struct fault *fault);

struct state;

/* now: what is kept already, or need not be. 0 or -errno. */
int state_create(struct state **state, const struct config_state *settings,
		 const struct state_values *now);

/* Another file or interval from now on. NULL is harmless, here and below. */
void state_move(struct state *state, const struct config_state *settings);

/* To be kept. Never waits. What cannot be written (a full disk, a missing folder) is said once, and
 * tried again each interval, at least each second. */
void state_keep(struct state *state, const struct state_values *values);

/* Writes what is not yet kept. */
void state_destroy(struct state *state);

#endif
