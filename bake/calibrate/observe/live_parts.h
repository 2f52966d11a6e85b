/* SPDX-License-Identifier: MIT */
/* Shared by live*.c; private to them. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_PARTS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_PARTS_H

#include "bake/calibrate/observe/live.h"
#include "config/config.h"

/* The configuration given to live_open(); it also names the screen. */
struct config *live_config(struct live *live);

/* Height of a pixel over its width, from the view's settings. */
double live_squash(const struct live *live);

#endif
