/* SPDX-License-Identifier: MIT */
/* The job of `inlay-calibrate light`: its options, and steps shared by its commands. */
#ifndef INLAY_BAKE_CALIBRATE_LIGHT_JOB_H
#define INLAY_BAKE_CALIBRATE_LIGHT_JOB_H

#include <stdbool.h>

#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/response/light_patch.h"
#include "bake/calibrate/response/light_samples.h"
#include "hal/base/fault.h"
#include "hal/colour/response.h"

#define LIGHT_AREAS_MAX 64

struct light_areas {
	struct light_area area[LIGHT_AREAS_MAX];
	int count;
};

struct light_job {
	const char *output, *report; /* NULL: none */
	const char *curve;	     /* LIGHT.ini or hdrgen's .rsp; NULL: sRGB */
	char **files;
	int file_count;
	double time[LIGHT_EXPOSURES_MAX];
	int times;
	double time_deviation;
	double misfit_percent; /* 0: the default */
	const char *lens, *background_light, *fisheye, *background;
	double reflectance[3];
	struct light_areas patch, background_patch;
	struct response measured; /* values that output holds already */
};

/* Writes the key (light_file_set()) if the verdict is trust; else logs the verdict. Returns 0; 1:
 * not trusted; negative errno. */
int light_conclude(const struct light_job *job, const struct verdict *verdict, const char *key,
		   const char *text, const char *comment, struct fault *fault);

/* Whether a file's name ends as those of hdrgen's responses do. */
bool light_is_rsp(const char *path);

/* Checks that there are two pictures or more, and no or as many times. -EINVAL. */
int light_check_times(const struct light_job *job, struct fault *fault);

/* Fills the relative times: those of --times, or what the pictures say (EXIF). -ENODATA: one says
 * none. */
int light_times(const struct light_job *job, double *time, struct fault *fault);

/* Computes the curve of a camera from its LIGHT.ini; without one, or a response in it, sRGB. */
int light_curve_of(const char *path, struct transfer_curve *curve, struct fault *fault);

/* Check whether a job is complete; -EINVAL: the fault says what was expected. */
int light_check_black(const struct light_job *job, struct fault *fault);
int light_check_response(const struct light_job *job, struct fault *fault);
int light_check_gain(const struct light_job *job, struct fault *fault);
int light_check_colours(const struct light_job *job, struct fault *fault);
int light_check_merge(const struct light_job *job, struct fault *fault);

/* Run a complete job: find the value, print it on standard output, write the report and, if the
 * value can be trusted, its key. Return 0; 1: not trusted, the verdict is logged; negative
 * errno. */
int light_command_black(const struct light_job *job, struct fault *fault);
int light_command_response(const struct light_job *job, struct fault *fault);
int light_command_gain(const struct light_job *job, struct fault *fault);
int light_command_colours(const struct light_job *job, struct fault *fault);
int light_command_merge(const struct light_job *job, struct fault *fault);

/* Reads the job's 8-bit pictures, all of one size. Returns errors of image_read(), -EINVAL. */
int light_read_pictures(const struct light_job *job, struct image *pictures, struct fault *fault);
void light_free_pictures(struct image *pictures, int count);

#endif
