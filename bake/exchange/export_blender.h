/* SPDX-License-Identifier: MIT */
/* An export job for Blender's Cycles: the files of export_job.h, scene.json and the script that
 * renders. */
#ifndef INLAY_BAKE_EXCHANGE_EXPORT_BLENDER_H
#define INLAY_BAKE_EXCHANGE_EXPORT_BLENDER_H

#include "bake/exchange/export_job.h"

/* Blender's camera has no distortion. A job is written if leaving it out moves no pixel farther
 * than this. */
#define EXPORT_BLENDER_SHIFT_PX 0.5

/* The largest distance, in pixels, by which the camera's distortion moves a pixel. HUGE_VAL: some
 * pixel sees nothing. */
double export_camera_shift(const struct tsai_camera *camera);

/* Writes the job. -EINVAL: the camera's distortion is too large (the fault says by how many
 * pixels); -ENOTSUP: the lights are not cells; else as export_job_begin(). */
int export_blender(const struct scene *scene, const struct dome *dome, const char *folder,
		   struct fault *fault);

#endif
