/* SPDX-License-Identifier: MIT */
/* What V4L2 says about the fields of a picture, and how single fields become pairs. Nothing here
 * touches a device. */
#ifndef INLAY_DRIVERS_V4L2_FIELDS_H
#define INLAY_DRIVERS_V4L2_FIELDS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stdint.h>

#include "hal/frame/frame.h"

/* v4l2.field: what the device is asked for. */
enum v4l2_field_wish {
	V4L2_WISH_DRIVER,
	V4L2_WISH_NONE,
	V4L2_WISH_INTERLACED,
	V4L2_WISH_SEQUENTIAL,
	V4L2_WISH_ALTERNATE,
	V4L2_WISH_TOP,
	V4L2_WISH_BOTTOM,
	V4L2_WISH_COUNT
};

extern const char *const v4l2_field_wish_names[]; /* "driver", "none", ... NULL */

/* V4L2_FIELD_* to ask for; a sequence begins with the field that the standard sends first. */
uint32_t v4l2_field_asked(enum v4l2_field_wish wish, v4l2_std_id standard);

struct v4l2_lines {
	enum frame_fields fields; /* of a whole frame: fields that alternate become a pair */
	bool bottom_first;
	bool one_field; /* a buffer holds one field, half the picture's height */
};

/* What a format's V4L2_FIELD_* means under a standard (0: not television). 525-line television
 * sends the bottom field first, everything else the top one. */
struct v4l2_lines v4l2_lines_of(uint32_t field, v4l2_std_id standard);

/* A buffer may say more than its format did, but not that it holds less. */
struct v4l2_lines v4l2_lines_of_buffer(const struct v4l2_lines *format, uint32_t field,
				       v4l2_std_id standard);

/* "progressive", "interlaced, bottom field first", ... */
const char *v4l2_lines_text(const struct v4l2_lines *lines);

/*
 * Fields that come one by one: two that follow each other with the same sequence number are a
 * frame. Some drivers count fields although V4L2 counts frames; such a driver is recognised by a
 * run of numbers that differ, and then a frame is the field that the standard sends first and the
 * next.
 */
struct v4l2_pairing {
	bool waiting, bottom; /* of the field that waits */
	uint32_t sequence;
	bool counts_frames, counts_fields; /* as far as is known */
	int run;
};

enum v4l2_pair {
	V4L2_PAIR_FIRST,  /* it waits for the other one */
	V4L2_PAIR_SECOND, /* it completes the one that waits */
	V4L2_PAIR_ORPHAN, /* the one that waits remains alone; this one waits in its place */
};

enum v4l2_pair v4l2_pairing_take(struct v4l2_pairing *pairing, uint32_t sequence, bool bottom,
				 bool bottom_first);

#endif
