/* SPDX-License-Identifier: MIT */
/*
 * Sorts the keys of a configuration that is read again: a table says for every key what has to
 * follow in a running kiosk, or that it waits for the next start.
 */
#ifndef INLAY_APP_KIOSK_RELOAD_H
#define INLAY_APP_KIOSK_RELOAD_H

#include "config/config.h"

/* What has to be done for keys that changed. */
enum reload_effect {
	RELOAD_PIPELINE = 1 << 0,    /* pipeline_change() */
	RELOAD_THRESHOLD = 1 << 1,   /* [lights] threshold goes over the chosen one */
	RELOAD_POSE = 1 << 2,	     /* [basis] pose goes over the chosen one */
	RELOAD_VIEW = 1 << 3,	     /* [screen] show goes over the chosen view */
	RELOAD_SPLIT = 1 << 4,	     /* [screen] split */
	RELOAD_INFORMATION = 1 << 5, /* [screen] information */
	RELOAD_BUTTONS = 1 << 6,     /* the drivers are opened again */
	RELOAD_CONTROL = 1 << 7,     /* the socket is opened again */
	RELOAD_STATE = 1 << 8,	     /* state_move() */
	RELOAD_LIGHT = 1 << 9,	     /* pipeline_relight() */
	RELOAD_POSES = 1 << 11,	     /* the timeline begins again */
	RELOAD_HOURS = 1 << 12,	     /* [screen] hours */
	RELOAD_DRAWING = 1 << 10,    /* the picture is drawn again */
};

/* Returns the effects of all keys that differ. Logs a warning for each key that waits for the next
 * start. Changes nothing. */
unsigned reload_compare(struct config *config, const struct config *fresh);

/* Sets the values in fresh of all keys that wait for the next start to those in force. */
void reload_keep(struct config *fresh, const struct config *config);

/* Takes over the values of all keys that can be changed. */
void reload_adopt(struct config *config, const struct config *fresh);

#endif
