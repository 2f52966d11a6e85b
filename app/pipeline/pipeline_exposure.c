/* SPDX-License-Identifier: MIT */
/* The object follows the background camera's exposure and white balance, and lamps that flicker in
 * its rows (hal/look). */
#include <errno.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/base/clock.h"
#include "hal/look/exposure.h"
#include "hal/look/flicker.h"

void pipeline_exposure_free(struct pipeline *p)
{
	exposure_destroy(p->follower);
	flicker_destroy(p->flicker);
	p->follower = NULL;
	p->flicker = NULL;
}

int pipeline_exposure_prepare(struct pipeline *p, const struct pipeline_settings *settings,
			      struct fault *fault)
{
	const bool same = transfer_curve_same(&settings->background, &p->settings.background);
	const int width = (int)p->basis->info.width, height = (int)p->basis->info.height;
	struct exposure *exposure;
	struct flicker *flicker;
	int err;

	if (settings->follow_exposure && p->follower && same)
		return 0;
	if (!settings->follow_exposure) {
		pipeline_exposure_free(p);
		return 0;
	}
	err = exposure_create(&exposure, width, height, &settings->background, &p->dome);
	if (!err) {
		err = flicker_create(&flicker, width, height, &settings->background);
		if (err)
			exposure_destroy(exposure);
	}
	if (err)
		return fault_say(fault, err, "not enough memory to follow the camera's exposure");
	pipeline_exposure_free(p);
	p->follower = exposure;
	p->flicker = flicker;
	return 0;
}

void pipeline_exposure_look(struct pipeline *p, const struct picture *background)
{
	float expected[3];
	const int64_t start_ns = clock_now_ns();
	int64_t exposed_ns;

	exposure_look(p->follower, background, (const float(*)[3])p->light.radiance);
	exposed_ns = clock_now_ns();
	exposure_expected(p->follower, expected);
	flicker_look(p->flicker, background, expected);
	p->look_ns[PIPELINE_EXPOSURE] += exposed_ns - start_ns;
	p->look_ns[PIPELINE_FLICKER] += clock_now_ns() - exposed_ns;
}

const int32_t (*pipeline_rows(const struct pipeline *p))[3]
{
	return p->flicker ? flicker_rows(p->flicker) : NULL;
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
		p->selection.mirror_gain[c] *= gain[c];
		for (int l = 0; l < LAMPS_MAX; l++)
			p->selection.lamp[l][c] *= gain[c];
	}
	p->followed = true;
}
