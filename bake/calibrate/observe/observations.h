/* SPDX-License-Identifier: MIT */
/*
 * Observations: points whose place in the world is known, and where they are seen in pictures.
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
	int view;			 /* index of the picture, from 0 */
	char name[OBSERVATION_NAME_MAX]; /* for people: "points.dat:12", "left03.jpg corner 4,7" */
};

struct observed_view {
	char name[256];	  /* name of its file */
	int first, count; /* its points, which follow each other */
	int number;	  /* from 1, of all pictures that were looked at */
};

struct observations {
	int width, height; /* of every picture; 0: not known (points alone) */
	struct observation *point;
	int count;
	struct observed_view *view;
	int views;
	int pictures; /* looked at: the views, and pictures that show nothing */
	/* private: allocated */
	int point_room, view_room;
};

void observations_free(struct observations *all); /* idempotent; zeroed is fine */

/* Begins a new view: points added from now on belong to it. -ENOMEM. */
int observations_begin_view(struct observations *all, const char *name);

/* Finds two views with exactly the same points at the same pixels: twin[0] is the first view that
 * repeats an earlier one, twin[1] that earlier one. False: there are none. */
bool observations_twin(const struct observations *all, int twin[2]);

/* Adds a point to the current view; format gives its name. -ENOMEM. */
int observations_add(struct observations *all, const double world[3], const double px[2],
		     const char *format, ...) __attribute__((format(printf, 4, 5)));

/*
 * Reads the numbers of a line, separated by blanks, commas or semicolons; a comment begins with #.
 * Returns how many there are, most + 1 if there are more than most; -EINVAL: something else stands
 * in the line. Cuts the comment off the line.
 */
int observations_numbers(char *line, double *number, int most);

/* How a file of points counts pixels. */
struct points_convention {
	int height; /* of the picture, px: needed where y counts upwards, else 0 */
	bool y_up;  /* y counts upwards from the lower edge (Tsai, the thesis), not downwards */
	double pixel_centre; /* coordinate of the first pixel's centre: 0.5 here, 0 in OpenCV */
};

/*
 * Reads a text file of lines `xw yw zw xf yf` as one view; blank lines and what follows # are
 * ignored. -ENOENT...; -EINVAL: the fault says file, line and what was expected (not a number, not
 * finite, too few or too many numbers, no points at all). On failure nothing is added.
 */
int observations_read(struct observations *all, const char *path,
		      const struct points_convention *convention, struct fault *fault);

#endif
