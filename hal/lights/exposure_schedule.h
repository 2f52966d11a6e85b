/* SPDX-License-Identifier: MIT */
/*
 * Tells which exposure each frame has, for a camera that is asked for another exposure all the time
 * and obeys some frames later, and measures that delay. Pure arithmetic: no camera, no clock.
 *
 * Frames are counted by the numbers of their source, so that a lost frame does not shift those
 * after it. A number that does not ascend counts as the next frame: the source does not count. An
 * exposure requested after frame n was taken, while `ahead` further frames were captured but not
 * yet taken, holds for the frames from
 *
 *     n + 1 + ahead + delay
 *
 * on. For each frame the caller calls exposure_schedule_take(), which returns the frame's exposure,
 * exposure_schedule_next(), which returns the exposure to request, and exposure_schedule_asked()
 * after the request.
 *
 * An unknown delay is measured: the longest and the shortest exposure alternate, each for
 * EXPOSURE_HOLD frames, and the caller passes each frame's brightness to
 * exposure_schedule_measure(). A change arrives with the first frame that has passed half of it;
 * two changes in a row with the same delay decide. Meanwhile a frame's exposure is known once
 * EXPOSURE_DELAY_MAX frames have passed since the request.
 */
#ifndef INLAY_HAL_LIGHTS_EXPOSURE_SCHEDULE_H
#define INLAY_HAL_LIGHTS_EXPOSURE_SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

#define EXPOSURE_DELAY_MAX 10 /* frames; the measurement finds none beyond */
#define EXPOSURE_HOLD (EXPOSURE_DELAY_MAX + 2)
#define EXPOSURE_CHANGES_MAX 8 /* after so many changes without a delay the measurement fails */
#define EXPOSURE_ASKED_MAX 32

struct exposure_schedule {
	int count; /* exposures, the longest first */
	int delay; /* frames; -1: not known yet */
	bool started;
	uint32_t sequence; /* the source's number of the last frame taken */
	int64_t frame;	   /* number of that frame without wraps */
	struct {
		int64_t from; /* first frame of the exposure if the delay were 0 */
		int exposure;
	} asked[EXPOSURE_ASKED_MAX]; /* requests, the oldest first */
	int asked_count;
	/* The measurement: */
	int changes, found; /* changes so far; the delay that the last one showed, -1: none */
	double before;	    /* brightness at the end of the exposure before; < 0: unknown */
	struct {
		int64_t frame;
		double level;
	} seen[EXPOSURE_HOLD]; /* frames since the last change */
	int seen_count;
	bool turn; /* the last change is complete: request the other exposure */
};

/* delay: 0..EXPOSURE_DELAY_MAX, or -1 to measure it. */
void exposure_schedule_begin(struct exposure_schedule *schedule, int count, int delay);

/* Takes a frame. Returns its exposure; -1: unknown. */
int exposure_schedule_take(struct exposure_schedule *schedule, uint32_t sequence);

/* The exposure to request now; -1: none, the last request goes on. */
int exposure_schedule_next(const struct exposure_schedule *schedule);
/* Says that an exposure was requested; ahead as above. */
void exposure_schedule_asked(struct exposure_schedule *schedule, int exposure, int ahead);

/* Passes the brightness of the last frame taken, in any unit that is linear in light below
 * clipping. Does nothing if the delay is known. 0; -ENODATA: EXPOSURE_CHANGES_MAX changes showed no
 * delay, or no two in a row the same; the measurement begins again. */
int exposure_schedule_measure(struct exposure_schedule *schedule, double level);

#endif
