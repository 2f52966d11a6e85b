/* SPDX-License-Identifier: MIT */
/* Private to command_light.c and light_command_*.c: what the command line asks for. */
#ifndef INLAY_BAKE_CALIBRATE_LIGHT_JOB_H
#define INLAY_BAKE_CALIBRATE_LIGHT_JOB_H

#include <stdbool.h>

#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/response/light_patch.h"
#include "bake/calibrate/response/light_samples.h"
#include "hal/base/fault.h"
#include "hal/colour/response.h"

#define LIGHT_AREAS_MAX 64

struct light_job {
	const char *output, *report; /* NULL: none */
	char **files;
	int file_count;
	double time[LIGHT_EXPOSURES_MAX];
	int times;
	double time_deviation;
	bool exposures, keep_white, white_balance;
	const char *lens, *background_light, *fisheye, *background;
	const char *config, *control[2];   /* of live pictures */
	int controls, view;		   /* enum live_view */
	int transfer, background_transfer; /* enum transfer */
	int frequency;
	double reflectance[3];
	struct light_area area[LIGHT_AREAS_MAX];
	int areas;
	struct light_area background_area[LIGHT_AREAS_MAX];
	int background_areas;
	struct response measured; /* what output says already */
};

/* Writes the key (light_file_set()) if the verdict is trust, else says the verdict. As above. */
int light_conclude(const struct light_job *job, const struct verdict *verdict, const char *key,
		   const char *text, const char *comment, struct fault *fault);

/* The curve of a camera of that file (NULL: none) and transfer. */
int light_curve_of(const char *path, int transfer, struct transfer_curve *curve,
		   struct fault *fault);

#endif
