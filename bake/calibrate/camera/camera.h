/* SPDX-License-Identifier: MIT */
/*
 * Calibration of Tsai's camera (thesis 2.1) from points whose place in the world is known.
 *
 * Views share f, kappa1, centre and s; each has its own pose. The camera that comes out is that of
 * the reference view: its world is the scene's.
 */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_H

#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/optics/tsai.h"

enum camera_method {
	CAMERA_FULL,  /* everything that is observable */
	CAMERA_THREE, /* f, Tz and kappa1; the rest as the closed form has it (Tsai 1987) */
};

/* Of the diagonal: how far lenses are from the middle of their pictures. Those of ordinary cameras
 * are within two or three of these. */
#define CAMERA_CENTRE_DEVIATION 0.025

/* How far s is from 1. Pixels of sensors are square to a thousandth or two; digitizers squash by 2
 * to 10 %, which nothing in a lone plane's picture tells: whoever has one says so. */
#define CAMERA_ASPECT_DEVIATION 0.002

struct camera_task {
	int width, height;   /* of the picture, px; 0: not known, its middle then is the points' */
	double pixel[2];     /* D; 1 1 where it is not known: f is then in pixels */
	bool centre_given;   /* else the middle of the picture */
	double centre_px[2]; /* where the axis is first taken to be, x right, y down */
	/* One deviation of that, px across (and as far up and down on the sensor); 0: exact;
	 * negative: CAMERA_CENTRE_DEVIATION of the picture's diagonal. */
	double centre_deviation_px;
	bool aspect_given; /* s is known */
	double aspect;	   /* where it is first taken to be, and held where it does not show */
	/* One deviation of that; 0: exact; negative: 0 where it is given, otherwise
	 * CAMERA_ASPECT_DEVIATION. */
	double aspect_deviation;
	int distortion; /* enum tsai_distortion */
	enum camera_method method;
	bool robust;
	const struct tsai_camera *intrinsics; /* f, kappa1, centre, D and s are these; NULL: found.
						 Its size is the picture's. */
	int reference;			      /* view whose world is the scene's */
	bool object_given;		      /* else the middle and half extent of the points */
	double object[3], object_radius;      /* in the scene */
	double tolerance_px;		      /* of what is uncertain at the object */
	double unit_mm;			      /* a unit of the world, in mm */
	bool z_down; /* cameras at negative Z are meant: the world's Z points into the ground */
};

struct camera_private;

struct camera_solution {
	bool solved;		   /* there is a camera */
	struct tsai_camera camera; /* width and height as the task has them */
	struct tsai_camera *view;  /* [finding.seen->views]: each view's */
	struct finding finding;	   /* its verdict says whether to trust the camera */
	struct camera_private *own;
};

/* A task with defaults: unit pixels, the thesis's direction, full, 1 px, metres. */
struct camera_task camera_task_default(void);

/*
 * 0: the verdict speaks, also where nothing could be solved (solved is false then); -ENOMEM;
 * -EINVAL: the task contradicts itself (no such reference view). seen must outlive the solution.
 */
int camera_calibrate(const struct observations *seen, const struct camera_task *task,
		     struct camera_solution *solution, struct fault *fault);
void camera_solution_free(struct camera_solution *solution); /* idempotent; zeroed is fine */

#endif
