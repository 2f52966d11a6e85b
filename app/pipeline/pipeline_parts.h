/* SPDX-License-Identifier: MIT */
/* Private to app/pipeline*.c. */
#ifndef INLAY_APP_PIPELINE_PIPELINE_PARTS_H
#define INLAY_APP_PIPELINE_PIPELINE_PARTS_H

#include "app/pipeline/pipeline.h"

/* What the sampler turns light into: gain, and what colours make of grey in the mean. */
double pipeline_gain_of_grey(const struct light_sampler_settings *settings);

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
