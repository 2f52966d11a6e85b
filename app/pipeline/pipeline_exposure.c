/* SPDX-License-Identifier: MIT */
/* The object follows the background camera's exposure and white balance (hal/look). */
#include <errno.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/look/exposure.h"

void pipeline_exposure_free(struct pipeline *p)
{
	exposure_destroy(p->follower);
	p->follower = NULL;
}

int pipeline_exposure_prepare(struct pipeline *p, const struct pipeline_settings *settings,
			      struct fault *fault)
{
	const bool same = transfer_curve_same(&settings->background, &p->settings.background);
	struct exposure *exposure;
	int err;

	if (settings->follow_exposure && p->follower && same)
		return 0;
	if (!settings->follow_exposure) {
		pipeline_exposure_free(p);
		return 0;
	}
	err = exposure_create(&exposure, (int)p->basis->info.width, (int)p->basis->info.height,
			      &settings->background, &p->dome);
	if (err)
		return fault_say(fault, err, "not enough memory to follow the camera's exposure");
	pipeline_exposure_free(p);
	p->follower = exposure;
	return 0;
}

void pipeline_exposure_look(struct pipeline *p, const struct picture *background)
{
	exposure_look(p->follower, background, (const float(*)[3])p->radiance);
}

void pipeline_exposure_follow(struct pipeline *p)
{
	double gain[3];

	if (!p->follower || p->followed)
		return;
	exposure_gain(p->follower, gain);
	for (int c = 0; c < 3; c++) {
		for (int i = 0; i < p->selection.count; i++)
			p->selection.radiance[i][c] *= gain[c];
		p->selection.ambient[c] *= gain[c];
	}
	p->followed = true;
}
