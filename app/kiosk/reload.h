/* SPDX-License-Identifier: MIT */
/*
 * What a configuration that is read again changes in a running kiosk, and what waits for the next
 * start: one table says it for every key.
 */
#ifndef INLAY_APP_KIOSK_RELOAD_H
#define INLAY_APP_KIOSK_RELOAD_H

#include "config/config.h"

/* What has to follow from keys that changed. */
enum reload_effect {
	RELOAD_PIPELINE = 1 << 0,    /* pipeline_change() */
	RELOAD_THRESHOLD = 1 << 1,   /* the chosen one is [lights] threshold again */
	RELOAD_POSE = 1 << 2,	     /* [basis] pose */
	RELOAD_VIEW = 1 << 3,	     /* [screen] show */
	RELOAD_SPLIT = 1 << 4,	     /* [screen] split */
	RELOAD_INFORMATION = 1 << 5, /* [screen] information */
	RELOAD_BUTTONS = 1 << 6,     /* they are opened anew */
	RELOAD_CONTROL = 1 << 7,     /* so is the socket */
	RELOAD_STATE = 1 << 8,	     /* another file or interval */
	RELOAD_LIGHT = 1 << 9,	     /* pipeline_relight() */
	RELOAD_POSES = 1 << 11,	     /* [poses]: the timeline begins anew */
	RELOAD_DRAWING = 1 << 10,    /* the picture is drawn anew; nothing else */
};

/* The effects of all keys that differ. Names each key that waits for the next start in a warning.
 * Changes nothing. */
unsigned reload_compare(struct config *config, const struct config *fresh);

/* Takes over the values of all keys that can be changed. */
void reload_adopt(struct config *config, const struct config *fresh);

#endif
