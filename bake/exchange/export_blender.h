/* SPDX-License-Identifier: MIT */
/* A scene for Blender's Cycles: the job's files, scene.json and the script that renders. */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_BLENDER_H
#define INLAY_BAKE_EXCHANGE_EXPORT_BLENDER_H

#include "bake/exchange/export_job.h"

/* Blender's camera has no such distortion: left out, it may move no pixel further than this. */
#define EXPORT_BLENDER_SHIFT_PX 0.5

/* How far, in pixels, the camera's distortion moves what it moves most. HUGE_VAL: a pixel that sees
 * nothing. */
double export_camera_shift(const struct tsai_camera *camera);

/* -EINVAL: a camera whose distortion is too large, which the fault names in pixels; -ENOTSUP:
 * lights that are no cells. */
int export_blender(const struct scene *scene, const struct dome *dome, const char *folder,
		   struct fault *fault);

#endif
