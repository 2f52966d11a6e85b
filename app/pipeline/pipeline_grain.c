/* SPDX-License-Identifier: MIT */
/* The background camera's noise, measured and given to the object (hal/look). */
#include <errno.h>
#include <stdlib.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/look/grain_tables.h"

#define FIT_EVERY 25 /* frames */

struct pipeline_grain {
	struct sensor_noise *noise; /* watched where nobody is looked for */
	struct grain_tables tables;
	struct grain grain;
	int frames;  /* since the last fit */
	bool fitted; /* grain is valid */
};

void pipeline_grain_free(struct pipeline *p)
{
	if (!p->grain)
		return;
	sensor_noise_destroy(p->grain->noise);
	free(p->grain);
	p->grain = NULL;
}

int pipeline_grain_prepare(struct pipeline *p, const struct pipeline_settings *settings,
			   struct fault *fault)
{
	const bool same = transfer_curve_same(&settings->background, &p->settings.background);
	struct pipeline_grain *g;
	int err;

	if (settings->grain && p->grain && same)
		return 0;
	if (!settings->grain) {
		pipeline_grain_free(p);
		return 0;
	}
	g = calloc(1, sizeof(*g));
	err = g ? sensor_noise_create(&g->noise, (int)p->basis->info.width,
				      (int)p->basis->info.height, &settings->background)
		: -ENOMEM;
	if (err) {
		free(g);
		return fault_say(
			fault, err,
			err == -EINVAL
				? "[composite] grain: the picture is too small to measure its noise, expected 8x8 pixels"
				: "not enough memory to measure the camera's noise");
	}
	pipeline_grain_free(p);
	p->grain = g;
	return 0;
}

void pipeline_grain_watch(struct pipeline *p, const struct picture *background, uint64_t seed)
{
	struct pipeline_grain *g = p->grain;
	const struct sensor_noise *noise = pipeline_people_noise(p);
	struct sensor_noise_model model;

	/* Who looks for people measures it anyway. */
	if (!noise) {
		sensor_noise_watch(g->noise, background);
		noise = g->noise;
	}
	g->grain.seed = seed;
	if (g->frames++ % FIT_EVERY == 0 && sensor_noise_fit(noise, &model)) {
		grain_tables_fit(&g->tables, &model, &g->grain);
		g->fitted = true;
	}
}

const struct grain *pipeline_grain(const struct pipeline *p)
{
	return p->grain && p->grain->fitted ? &p->grain->grain : NULL;
}
