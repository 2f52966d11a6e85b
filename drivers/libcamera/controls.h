/* SPDX-License-Identifier: MIT */
/*
 * Controls of a camera as numbers and text: what may be set, what the configuration asks for (the
 * wishes), and what the camera makes of them. No type of libcamera's, so that tests need no camera.
 */
#ifndef INLAY_DRIVERS_LIBCAMERA_CONTROLS_H
#define INLAY_DRIVERS_LIBCAMERA_CONTROLS_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/device/camera_controls.h"

enum { LIBCAMERA_NUMBERS_MAX = 16, LIBCAMERA_WISHES_MAX = 33, LIBCAMERA_VALUE_TEXT_MAX = 256 };

enum libcamera_kind {
	LIBCAMERA_OTHER, /* not numeric: a rectangle, a text */
	LIBCAMERA_BOOL,
	LIBCAMERA_BYTE,
	LIBCAMERA_INT32,
	LIBCAMERA_INT64, /* limited to the integers that a double holds exactly, 2^53 */
	LIBCAMERA_FLOAT,
};

struct libcamera_value {
	enum libcamera_kind kind;
	int count; /* 0: not known */
	double numbers[LIBCAMERA_NUMBERS_MAX];
};

/* A control that the camera has. */
struct libcamera_control {
	const void *theirs; /* lc::ControlId, opaque here; passed to the callbacks */
	char name[CAMERA_CONTROL_NAME_MAX];
	enum libcamera_kind kind;
	int elements; /* length of an array; 0: a single value */
	struct libcamera_value least, most;
	/* Converts one of the control's named values to its number. False: no such name. May be
	 * NULL. */
	bool (*number_of)(const void *theirs, const char *word, double *number);
};

/* Convert between a value and its elements in memory: bytes, integers or floats of the machine.
 * Elements of an array beyond LIBCAMERA_NUMBERS_MAX are ignored. */
void libcamera_value_unpack(struct libcamera_value *value, enum libcamera_kind kind, int count,
			    const void *elements);
void libcamera_value_pack(const struct libcamera_value *value, void *elements);

/* Writes the numbers with blanks between; empty if the value has none. */
void libcamera_value_text(const struct libcamera_value *value, char text[LIBCAMERA_VALUE_TEXT_MAX]);

/* Reads numbers or named values with blanks between. 0; -EINVAL, -ERANGE with a fault. */
int libcamera_value_read(const struct libcamera_control *control, const char *text,
			 struct libcamera_value *value, struct fault *fault);

struct libcamera_wish {
	const struct libcamera_control *control; /* borrowed */
	struct libcamera_value value;
	bool granted; /* the camera reported this value */
};

struct libcamera_wishes {
	const char *camera; /* its name, for messages; borrowed */
	struct libcamera_wish list[LIBCAMERA_WISHES_MAX];
	int count, next; /* list[next] is the first that no request carries yet */
	bool alone;	 /* each request carries one wish only */
	int settling;	 /* frames until the values that the camera reports are final */
};

/* Reads camera_settings.controls and .rate_hz (0: none). Wishes that cannot be met are logged and
 * left out. Returns the frame rate in Hz that will be held; 0: the camera cannot set one. */
double libcamera_wishes_read(struct libcamera_wishes *wishes, const char *camera,
			     const struct libcamera_control *known, int count, const char *text,
			     double rate_hz);

/* Changes a control while the camera runs: the next request that is queued carries it. 0; -EINVAL:
 * no such control; -EINVAL, -ERANGE as libcamera_value_read(); -E2BIG: too many wishes. */
int libcamera_wishes_change(struct libcamera_wishes *wishes, const struct libcamera_control *known,
			    int count, const char *name, const char *value, struct fault *fault);

/* A part of the list of wishes, which one request carries. */
struct libcamera_load {
	int first, count;
};

/* Returns what the next request carries: all wishes at first, then none; after the camera has
 * refused several wishes together, one at a time. */
struct libcamera_load libcamera_wishes_next(struct libcamera_wishes *wishes);

/* Tells that a request which carried this load failed. */
void libcamera_wishes_refused(struct libcamera_wishes *wishes, struct libcamera_load load);

/* Compares the wishes with what the camera used for a frame. get() fetches the value of a control;
 * false: not reported. Differences are logged once the camera has had time to settle. */
void libcamera_wishes_compare(struct libcamera_wishes *wishes,
			      bool (*get)(const void *context, const void *theirs,
					  struct libcamera_value *value),
			      const void *context);

#endif
