/* SPDX-License-Identifier: MIT */
/*
 * Which pose is shown when: poses by the clock, not by frames, so that nothing drifts and late
 * frames leave poses out.
 */
#ifndef INLAY_APP_KIOSK_TIMELINE_H
#define INLAY_APP_KIOSK_TIMELINE_H

#include <stdint.h>

#include "config/config.h"

struct timeline {
	enum config_timeline kind;
	double rate; /* poses a second */
	int count;
	/* private: at this time it stood there; swinging, counted through one way and back */
	int64_t since_ns;
	double place;
};

/* Where it stands: at this pose, and by this share on the way to the next one. */
struct timeline_place {
	int pose, next;
	double share; /* 0 <= share < 1 */
};

/* From a pose on, forwards. rate > 0, count >= 1, pose in 0..count-1. */
void timeline_begin(struct timeline *timeline, const struct config_poses *poses, int count,
		    int pose, int64_t now_ns);

/* Time that goes back stands still until it is there again. */
struct timeline_place timeline_at(const struct timeline *timeline, int64_t now_ns);

#endif
