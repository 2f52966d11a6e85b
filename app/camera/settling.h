/* SPDX-License-Identifier: MIT */
/*
 * Whether a camera's pictures can be believed already: after it was opened, a camera may send black
 * frames, green ones (YUV buffers of zeros, which nobody has filled), and frames whose exposure and
 * white balance are still being found. They are left out of the light.
 *
 * A picture is blank where no pixel has red or blue. Pictures count once their mean level has
 * stayed within 4 % (or one code value) for SETTLING_STEADY_NS and three pictures, and in any case
 * SETTLING_MOST_NS after the first one: a dark night is black for ever. Pure: asks no clock.
 */
#ifndef INLAY_APP_CAMERA_SETTLING_H
#define INLAY_APP_CAMERA_SETTLING_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/clock.h"
#include "hal/frame/frame_reader.h"

#define SETTLING_STEADY_NS (300 * NS_PER_MS)
#define SETTLING_MOST_NS (3 * NS_PER_S)
/* For a picture that is kept: at 8 Hz an exposure that takes five seconds changes by less than 4 %
 * in a third of a second. */
#define SETTLING_KEPT_STEADY_NS NS_PER_S
#define SETTLING_KEPT_MOST_NS (10 * NS_PER_S)

struct settling {
	unsigned opening;  /* the camera's opening that this is about; 0: none yet */
	bool settled;	   /* its pictures count */
	bool in_vain;	   /* only because they were waited for long enough */
	bool kept;	   /* set by the user: one picture is kept, so the times are longer */
	uint64_t left_out; /* pictures that did not, of all openings */
	int64_t begun_ns;  /* when its first picture was captured */
	int64_t steady_ns; /* since when its level has been steady */
	double level;	   /* which level that is; < 0: none, the last picture was blank */
	int steady;	   /* pictures of that level */
};

/* What a picture looks like. */
struct settling_look {
	double level; /* mean code value */
	bool blank;
};

struct settling_look settling_look_at(const struct frame_reader *picture);

/* Takes a picture of this opening (1 or more) that was captured at a time. metering: the camera
 * finds its exposure itself; else only blank pictures are left out. Returns whether the picture
 * counts. */
bool settling_take(struct settling *settling, unsigned opening, const struct settling_look *look,
		   bool metering, int64_t captured_ns);

#endif
