/* SPDX-License-Identifier: MIT */
/*
 * Maps time to poses. Poses follow the time at which frames are captured, not their number, so that
 * the animation does not drift and late frames leave poses out.
 */
#ifndef INLAY_APP_KIOSK_TIMELINE_H
#define INLAY_APP_KIOSK_TIMELINE_H

#include <stdint.h>

#include "config/config.h"

struct timeline {
	enum config_timeline kind;
	double rate; /* poses a second */
	int count;
	/* private: it stood at place at since_ns. Where it swings, poses are counted through, one
	 * way and back */
	int64_t since_ns;
	double place;
};

/* A place between two poses: at pose, by this share on the way to next. */
struct timeline_place {
	int pose, next;
	double share; /* 0 <= share < 1 */
};

/* Begins at a pose, forwards. rate > 0, count >= 1, 0 <= pose < count. */
void timeline_begin(struct timeline *timeline, const struct config_poses *poses, int count,
		    int pose, int64_t now_ns);

/* Returns the place at a time. A time before the beginning counts as the beginning. */
struct timeline_place timeline_at(const struct timeline *timeline, int64_t now_ns);

#endif
