/* SPDX-License-Identifier: MIT */
/* First guess of a fisheye lens: tries focal lengths and squashes. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_START_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_START_H

#include "bake/calibrate/fisheye/fisheye_solve.h"

/*
 * Fills the solution's optics (of its model, all terms 0) and poses with a first guess. mirrored:
 * the picture fits better mirrored: points in the wrong order, or flipped. -ERANGE: no pose fits;
 * -EINVAL: an impossible point (the fault names it); -ENOMEM.
 */
int lens_start(const struct lens_problem *problem, struct lens_solution *solution, bool *mirrored,
	       struct fault *fault);

#endif
