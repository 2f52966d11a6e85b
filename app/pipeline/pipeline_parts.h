/* SPDX-License-Identifier: MIT */
/* Private to app/pipeline*.c. */
#ifndef INLAY_APP_PIPELINE_PIPELINE_PARTS_H
#define INLAY_APP_PIPELINE_PIPELINE_PARTS_H

#include "app/pipeline/pipeline.h"

/* ---- pipeline_level.c ---- */

/*
 * What the sampler multiplies grey light by, as the mean over the three channels:
 *
 *     gain * (sum of colours[0..8]) / 3, or gain where colours are not set (all 0)
 */
double pipeline_gain_of_grey(const struct light_sampler_settings *settings);

/* Radiance of a grey level, 0..255, of the fisheye's picture, as the sampler would read it. */
double pipeline_linear_level(const struct light_sampler_settings *settings, double level);

/* Width of the hysteresis below a threshold, in radiance: one grey level, and twice what the sampler
 * may round, so that a light at exactly that level is not below it. */
double pipeline_band_below(const struct light_sampler_settings *settings, double threshold);

/* ---- pipeline_ground.c ---- */

/* What the settings' patch needs, in place of what there was; that stays on failure. What
 * pipeline_check_patch() returns, -ENOMEM. */
int pipeline_ground_prepare(struct pipeline *pipeline, const struct pipeline_settings *settings,
			    struct fault *fault);
void pipeline_ground_free(struct pipeline *pipeline); /* idempotent; zeroed is fine */

/* Which poses are shown, in p->choice: those of choice, or those before them. An error, which
 * p->trouble tells, where there are none. */
int pipeline_take_poses(struct pipeline *pipeline, const struct pipeline_choice *choice);

/* Room for the pictures of two poses. Idempotent. -ENOMEM. */
int pipeline_fade_begin(struct pipeline *pipeline);
/* The two poses of p->choice, mixed by its share. What compositor_run() returns. */
int pipeline_fade_run(struct pipeline *pipeline, const struct backdrop *background, uint8_t *out,
		      size_t out_stride);
void pipeline_fade_end(struct pipeline *pipeline);

/* Waits for what pipeline_relight() has begun, and forgets it. */
void pipeline_relight_end(struct pipeline *pipeline);

#endif
