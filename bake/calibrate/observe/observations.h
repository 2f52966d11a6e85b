/* SPDX-License-Identifier: MIT */
/*
 * What a calibration sees: points whose place in the world is known, and where they are in
 * pictures.
 *
 * Pictures are upright, x right, y down from the upper left corner, pixel centres at +0.5
 * (hal/optics). The world is right-handed; lengths are in the scene's unit.
 */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_OBSERVATIONS_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_OBSERVATIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/base/fault.h"

#define OBSERVATION_NAME_MAX 48

struct observation {
	double world[3];
	double px[2];
	int view;			 /* which picture, 0.. */
	char name[OBSERVATION_NAME_MAX]; /* for people: "points.dat:12", "left03.jpg corner 4,7" */
};

struct observed_view {
	char name[256];	  /* of its file */
	int first, count; /* its points; the points of a view follow each other */
};

struct observations {
	int width, height; /* of every picture; 0: not known (points alone) */
	struct observation *point;
	int count;
	struct observed_view *view;
	int views;
	/* private: room */
	int point_room, view_room;
};

void observations_free(struct observations *all); /* idempotent; zeroed is fine */

/* Points added from now on belong to a new view. -ENOMEM. */
int observations_begin_view(struct observations *all, const char *name);

/* The first view that has the very points of one before it, at the very same places, and that one:
 * the same picture, which counts once only. False: there is none. */
bool observations_twin(const struct observations *all, int twin[2]);

/* The view and the name are taken from the arguments. -ENOMEM. */
int observations_add(struct observations *all, const double world[3], const double px[2],
		     const char *format, ...) __attribute__((format(printf, 4, 5)));

/*
 * The numbers of a line, which may be parted by blanks, commas and semicolons; what follows # is
 * passed over. Returns how many there are, most + 1 for any more; -EINVAL: something else stands in
 * it. The line is cut where its numbers end.
 */
int observations_numbers(char *line, double *number, int most);

/* How files of points have their pictures. */
struct points_convention {
	int height;	/* of the picture, px: needed where y counts upwards, else 0 */
	int y_up;	/* y counts upwards from the lower edge (Tsai, the thesis), not downwards */
	int directions; /* lines dx dy dz xf yf: it is for faults alone */
	double pixel_centre; /* where a file has the centre of the first pixel: 0.5 here, 0 in
				OpenCV */
};

/*
 * A text file of lines `xw yw zw xf yf`, as one view; blank lines and what follows # are passed
 * over. -ENOENT...; -EINVAL: a fault with file, line and what was expected (a number that is none,
 * not finite, too few or too many, no points at all). On failure nothing is added.
 */
int observations_read(struct observations *all, const char *path,
		      const struct points_convention *convention, struct fault *fault);

#endif
