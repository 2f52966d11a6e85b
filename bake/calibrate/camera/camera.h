/* SPDX-License-Identifier: MIT */
/*
 * Calibration of Tsai's camera (thesis 2.1) from points whose place in the world is known.
 *
 * Views share f, kappas, centre and s; each has its own pose. The resulting camera is that of the
 * reference view, whose world is the scene's.
 */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_H

#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/optics/tsai.h"

/* Standard deviation of the axis from the middle of the picture, as a share of its diagonal. Axes
 * of ordinary cameras are within two or three of these. */
#define CAMERA_CENTRE_DEVIATION 0.025

/* Standard deviation of s from 1. Pixels of sensors are square to 0.001 or 0.002; digitizers squash
 * by 2 to 10 %, which the picture of a lone plane does not show, so the user must say so. */
#define CAMERA_ASPECT_DEVIATION 0.002

struct camera_task {
	/* of the picture, px; 0: not known, then its middle is that of the points */
	int width, height;
	bool centre_given;   /* else the centre is the middle of the picture */
	double centre_px[2]; /* first guess of the axis, x right, y down */
	/* Its standard deviation, px across (and as far up and down on the sensor); 0: exact;
	 * negative: CAMERA_CENTRE_DEVIATION of the picture's diagonal. */
	double centre_deviation_px;
	bool aspect_given; /* s is known */
	double aspect;	   /* first guess of s; s is held there if the points do not determine it */
	/* Its standard deviation; 0: exact; negative: 0 if aspect_given, else
	 * CAMERA_ASPECT_DEVIATION. */
	double aspect_deviation;
	int distortion; /* enum tsai_distortion */
	/* terms of its polynomial, 1 to 3; 0: as many as predict best */
	int radial;
	bool robust;
	/* known f, distortion, centre, D and s; NULL: found. Its size is the picture's. */
	const struct tsai_camera *intrinsics;
	int reference;			 /* view whose world is the scene's */
	bool object_given;		 /* else the object is the points' bounding box */
	double object[3], object_radius; /* in the scene */
	double tolerance_px;		 /* largest uncertainty at the object */
	double unit_mm;			 /* length of a unit of the world, mm */
	bool z_down; /* the world's Z points into the ground: cameras are at negative Z */
};

struct camera_private;

struct camera_solution {
	bool solved;		   /* camera and view are valid */
	struct tsai_camera camera; /* width and height are the task's */
	struct tsai_camera *view;  /* [finding.seen->views]: camera of each view */
	struct finding finding;	   /* its verdict says whether to trust the camera */
	struct camera_private *own;
};

/* A task with defaults: unit pixels, the thesis's direction, 1 px, metres. */
struct camera_task camera_task_default(void);

/*
 * Calibrates. Returns 0 with a verdict, also where nothing could be solved (solved is then false);
 * -ENOMEM; -EINVAL: the task contradicts itself (no such reference view). seen must outlive the
 * solution.
 */
int camera_calibrate(const struct observations *seen, const struct camera_task *task,
		     struct camera_solution *solution, struct fault *fault);
void camera_solution_free(struct camera_solution *solution); /* idempotent; zeroed is fine */

#endif
