/* SPDX-License-Identifier: MIT */
/* A camera's controls as numbers and text: what may be set, what was asked for, what became of it.
 */
#ifndef INLAY_DRIVERS_LIBCAMERA_CONTROLS_H
#define INLAY_DRIVERS_LIBCAMERA_CONTROLS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/device/camera_controls.h"

enum { LIBCAMERA_NUMBERS_MAX = 16, LIBCAMERA_WISHES_MAX = 33, LIBCAMERA_VALUE_TEXT_MAX = 256 };

enum libcamera_kind {
	LIBCAMERA_OTHER, /* has no numbers: a rectangle, a text */
	LIBCAMERA_BOOL,
	LIBCAMERA_BYTE,
	LIBCAMERA_INT32,
	LIBCAMERA_INT64, /* as far as doubles count one by one */
	LIBCAMERA_FLOAT,
};

struct libcamera_value {
	enum libcamera_kind kind;
	int count; /* 0: not known */
	double numbers[LIBCAMERA_NUMBERS_MAX];
};

/* One that the camera has. */
struct libcamera_control {
	const void *theirs; /* what the callbacks know it by */
	char name[CAMERA_CONTROL_NAME_MAX];
	enum libcamera_kind kind;
	int elements; /* of an array; 0: a single value */
	struct libcamera_value least, most;
	/* The number that a word stands for; false: it is none of the control's. May be NULL. */
	bool (*number_of)(const void *theirs, const char *word, double *number);
};

/* Between a value and the memory of its elements: bytes, integers and floats of the machine. Of an
 * array with more than LIBCAMERA_NUMBERS_MAX elements the first are read. */
void libcamera_value_unpack(struct libcamera_value *value, enum libcamera_kind kind, int count,
			    const void *elements);
void libcamera_value_pack(const struct libcamera_value *value, void *elements);

/* Numbers with blanks between; empty where there are none. */
void libcamera_value_text(const struct libcamera_value *value, char text[LIBCAMERA_VALUE_TEXT_MAX]);

/* Reads numbers with blanks between, or words. -EINVAL, -ERANGE: the fault says why not. */
int libcamera_value_read(const struct libcamera_control *control, const char *text,
			 struct libcamera_value *value, struct fault *fault);

struct libcamera_wish {
	const struct libcamera_control *control; /* borrowed */
	struct libcamera_value value;
	bool granted;
};

/* What was asked for. */
struct libcamera_wishes {
	const char *camera; /* its name, for messages; borrowed */
	struct libcamera_wish list[LIBCAMERA_WISHES_MAX];
	int count, next;
	bool alone;   /* one for each request */
	int settling; /* frames until what the camera reports is final */
};

/* Reads camera_settings.controls and .rate_hz (0: none) and returns the rate that will be held, or
 * 0: many cameras have no say in it. What cannot be is logged and left out. */
double libcamera_wishes_read(struct libcamera_wishes *wishes, const char *camera,
			     const struct libcamera_control *known, int count, const char *text,
			     double rate_hz);

/* Another value for a control on the way: the requests that are queued from now on carry it.
 * -EINVAL, -ERANGE: as libcamera_value_read(), or no such control; -E2BIG. */
int libcamera_wishes_change(struct libcamera_wishes *wishes, const struct libcamera_control *known,
			    int count, const char *name, const char *value, struct fault *fault);

/* A part of the list. */
struct libcamera_load {
	int first, count;
};

/* What the next request carries: all of them at first, nothing later, and one at a time once the
 * camera has refused several together. */
struct libcamera_load libcamera_wishes_next(struct libcamera_wishes *wishes);

/* A request came back undone with this. */
void libcamera_wishes_refused(struct libcamera_wishes *wishes, struct libcamera_load load);

/* A frame came: get() tells what the camera used for a control, or false. Differences are logged
 * once the camera has had time to settle. */
void libcamera_wishes_compare(struct libcamera_wishes *wishes,
			      bool (*get)(const void *context, const void *theirs,
					  struct libcamera_value *value),
			      const void *context);

#endif
