/* Bakes a scene: all tiles on all cores, into a basis file. */
#ifndef INLAY_BAKE_RENDER_H
#define INLAY_BAKE_RENDER_H

#include "bake/scene.h"

struct render_settings {
	int frequency, division; /* enum dome_division */
	int samples;
	double noise_levels; /* above 0: instead of samples */
	int bounces, seed;
	double ratio_cut;
	int threads; /* 0: one for each processor */
	bool quiet;  /* no progress */
};

struct render_report {
	uint64_t rays;
	double seconds;
	double noise_levels; /* estimated; 0: not known (one sample) */
	double object_error, ratio_error;
	bool object_seen; /* some pixel shows it */
};

/* What the scene file says. */
struct render_settings render_settings_of(const struct scene *scene);

/* Nothing is written on failure. The file depends on scene and settings alone, not on threads. */
int render_run(const struct scene *scene, const struct render_settings *settings, const char *path,
	       struct render_report *report, struct fault *fault);

#endif
