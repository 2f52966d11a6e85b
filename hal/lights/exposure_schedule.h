/* SPDX-License-Identifier: MIT */
/*
 * Which exposure a frame has, of a camera that is asked for another one all the time and obeys some
 * frames later; and how many. Nothing but numbers: no camera, no clock.
 *
 * Frames are counted by the numbers that they have at their source, so that a lost one does not
 * shift those after it; a number that does not ascend is a source that does not count, and stands
 * for the next frame. An exposure that is asked for once frame n, and `ahead` more that were not
 * seen yet, have been captured, is that of frames n + 1 + ahead + delay and later.
 *
 * A frame at a time: exposure_schedule_take() says what it has, exposure_schedule_next() what to
 * ask for, exposure_schedule_asked() that it was done.
 *
 * A delay that is not known is measured: the longest exposure and the shortest in turn, each for
 * EXPOSURE_HOLD frames, whose brightness exposure_schedule_measure() is told. A change is there
 * with the first frame that has passed half of its way; two that agree are the delay. Frames that
 * have had time enough are known meanwhile.
 */
#ifndef INLAY_HAL_LIGHTS_EXPOSURE_SCHEDULE_H
#define INLAY_HAL_LIGHTS_EXPOSURE_SCHEDULE_H

#include <stdbool.h>
#include <stdint.h>

#define EXPOSURE_DELAY_MAX 10 /* frames: as far as the measurement looks */
#define EXPOSURE_HOLD (EXPOSURE_DELAY_MAX + 2)
#define EXPOSURE_CHANGES_MAX 8 /* without two that agree: there is no delay */
#define EXPOSURE_ASKED_MAX 32

struct exposure_schedule {
	int count; /* exposures, the longest first */
	int delay; /* frames; -1: not known yet */
	bool started;
	uint32_t sequence; /* of the frame taken last, as its source says */
	int64_t frame;	   /* the same counted by us */
	struct {
		int64_t from; /* with a delay of 0 */
		int exposure;
	} asked[EXPOSURE_ASKED_MAX]; /* the oldest first */
	int asked_count;
	/* of the measurement: */
	int changes, found; /* so far; the delay that the last one showed, -1: none */
	double before;	    /* how bright it was at its end before this change; < 0: unknown */
	struct {
		int64_t frame;
		double level;
	} seen[EXPOSURE_HOLD]; /* since this change */
	int seen_count;
	bool turn; /* this change has been seen to its end */
};

/* delay: 0..EXPOSURE_DELAY_MAX, or -1 to measure it. */
void exposure_schedule_begin(struct exposure_schedule *schedule, int count, int delay);

/* A frame has come: which exposure it has, -1: that is not known. */
int exposure_schedule_take(struct exposure_schedule *schedule, uint32_t sequence);

/* Which exposure to ask for now; -1: the one that was asked for last goes on. */
int exposure_schedule_next(const struct exposure_schedule *schedule);
void exposure_schedule_asked(struct exposure_schedule *schedule, int exposure, int ahead);

/* How bright the frame taken last is, in any unit that is linear in light but where it clips. Only
 * while the delay is not known. 0; -ENODATA: EXPOSURE_CHANGES_MAX changes have not shown a delay:
 * none is visible, or no two of them agree; the measurement begins anew. */
int exposure_schedule_measure(struct exposure_schedule *schedule, double level);

#endif
