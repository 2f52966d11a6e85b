/* SPDX-License-Identifier: MIT */
/* What the files of live pictures share. Private to live*. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_PARTS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_PARTS_H

#include "bake/calibrate/observe/live.h"
#include "config/config.h"

/* The configuration that it was opened with; its screen is whoever shows the pictures'. */
struct config *live_config(struct live *live);

/* The height of a pixel over its width, as the view has it. */
double live_squash(const struct live *live);

#endif
