/* SPDX-License-Identifier: MIT */
/* Interprets V4L2's fields of interlaced video, and pairs single fields. Pure: touches no
 * device. */
#ifndef INLAY_DRIVERS_V4L2_FIELDS_H
#define INLAY_DRIVERS_V4L2_FIELDS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stdint.h>

#include "hal/frame/frame.h"

/* The key v4l2.field: which arrangement of fields the device is asked for. */
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

/* Returns the V4L2_FIELD_* to ask for. Sequential fields begin with the one that the standard sends
 * first. */
uint32_t v4l2_field_asked(enum v4l2_field_wish wish, v4l2_std_id standard);

struct v4l2_lines {
	enum frame_fields fields; /* of a whole frame: alternating fields become a pair */
	bool bottom_first;	  /* the bottom field is the earlier one */
	bool one_field;		  /* a buffer holds one field, half the picture's height */
};

/* Interprets the V4L2_FIELD_* of a format under a standard (0: not television). 525-line television
 * sends the bottom field first, everything else the top field. */
struct v4l2_lines v4l2_lines_of(uint32_t field, v4l2_std_id standard);

/* The same for the field of a buffer. It may be more specific than that of its format, but a buffer
 * cannot hold less than the format says. */
struct v4l2_lines v4l2_lines_of_buffer(const struct v4l2_lines *format, uint32_t field,
				       v4l2_std_id standard);

/* Returns "progressive", "interlaced, bottom field first", ... */
const char *v4l2_lines_text(const struct v4l2_lines *lines);

/*
 * Pairs fields that come one by one. Two successive fields with the same sequence number are a
 * frame. Some drivers number fields, although V4L2 asks for numbers of frames. A run of differing
 * numbers reveals such a driver; then a frame is the field that the standard sends first together
 * with the next one.
 */
struct v4l2_pairing {
	bool waiting, bottom;		   /* a first field waits; it is the bottom one */
	uint32_t sequence;		   /* its number */
	bool counts_frames, counts_fields; /* both false: not known yet */
	int run;			   /* successive fields with differing numbers */
};

enum v4l2_pair {
	V4L2_PAIR_FIRST,  /* the field waits for its partner */
	V4L2_PAIR_SECOND, /* the field completes the waiting one */
	V4L2_PAIR_ORPHAN, /* the waiting field stays alone; the new one waits in its place */
};

/* Says how the next field pairs up. bottom_first: what the standard sends. */
enum v4l2_pair v4l2_pairing_take(struct v4l2_pairing *pairing, uint32_t sequence, bool bottom,
				 bool bottom_first);

#endif
