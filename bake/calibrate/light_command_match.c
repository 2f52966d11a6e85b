/* SPDX-License-Identifier: MIT */
/* inlay-calibrate light gain and colours. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/light_job.h"
#include "bake/calibrate/response/light_colours.h"
#include "bake/calibrate/response/light_gain.h"
#include "bake/calibrate/response/light_report.h"
#include "bake/sky/sky_eye.h"

/* The frequency of the dome that the sky is measured by. Its 2,886 cells are sqrt(2 pi / 2886) =
 * 2.7 degrees wide. */
#define SKY_FREQUENCY 24

/* ---- the sky ---- */

struct measured_sky {
	struct dome dome;
	struct fisheye_settings lens;
	struct light_sampler_settings sampler;
	float (*radiance)[3];
};

static int sky_create(struct measured_sky *sky, const struct light_job *job, struct fault *fault)
{
	int err = 0;

	ini_defaults(fisheye_keys, &sky->lens);
	if (job->lens)
		err = sky_eye_lens(&sky->lens, job->lens, fault);
	if (err)
		return err;
	sky->sampler = (struct light_sampler_settings){
		.placed = true,
		.curve = response_curve(&job->measured, TRANSFER_SRGB, 0),
		.gain = 1,
	};
	memcpy(sky->sampler.colours, job->measured.colours, sizeof(sky->sampler.colours));
	err = dome_create(&sky->dome, SKY_FREQUENCY, fault);
	if (err)
		return err;
	sky->radiance = calloc((size_t)sky->dome.count, sizeof(*sky->radiance));
	return sky->radiance ? 0 : fault_say(fault, -ENOMEM, "not enough memory");
}

static void sky_free(struct measured_sky *sky)
{
	free(sky->radiance);
	dome_free(&sky->dome);
}

static int sky_measure(struct measured_sky *sky, const char *path, double *clipped,
		       struct fault *fault)
{
	struct light_sampler *sampler = NULL;
	struct image image = {.width = 0};
	struct fault why = {.text = ""};
	struct fisheye lens;
	int err = image_read(path, &image, fault);

	*clipped = 0;
	if (err)
		return err;
	err = fisheye_prepare(&lens, &sky->lens, image.width, image.height, &why);
	if (!err)
		err = light_sampler_create(&sampler, &sky->dome, &lens, image.width, image.height,
					   &sky->sampler, &why);
	if (!err) {
		err = sky_eye_sample(sampler, &image, sky->radiance, clipped);
		if (err)
			fault_say(&why, err, "cannot be measured: %s", strerror(-err));
	}
	if (err)
		fault_say(fault, err, "%s: %s", path, why.text);
	light_sampler_destroy(sampler);
	image_free(&image);
	return err;
}

/* ---- gain ---- */

static int measure_patch(const char *path, const struct light_area *area,
			 const struct transfer_curve *curve, struct light_patch *patch,
			 struct fault *fault)
{
	struct image image = {.width = 0};
	struct fault why = {.text = ""};
	int err = image_read(path, &image, fault);

	if (err)
		return err;
	err = light_patch_measure(patch, &image, area, curve, &why);
	image_free(&image);
	return err ? fault_say(fault, err, "%s: %s", path, why.text) : 0;
}

static int measure_pairs(const struct light_job *job, struct light_pair *pairs, struct fault *fault)
{
	struct measured_sky sky = {.radiance = NULL};
	struct transfer_curve curve;
	int err = light_curve_of(job->background_light, &curve, fault);

	if (!err)
		err = sky_create(&sky, job, fault);
	for (int k = 0; !err && k < job->file_count / 2; k++) {
		const int area = k < job->patch.count ? k : job->patch.count - 1;

		err = sky_measure(&sky, job->files[2 * k], &pairs[k].clipped_sky, fault);
		if (err)
			break;
		light_gain_predict(&sky.dome, (const float(*)[3])sky.radiance, job->reflectance,
				   pairs[k].predicted);
		err = measure_patch(job->files[2 * k + 1], &job->patch.area[area], &curve,
				    &pairs[k].patch, fault);
	}
	sky_free(&sky);
	return err;
}

int light_check_gain(const struct light_job *job, struct fault *fault)
{
	if (job->file_count >= 2 && job->file_count % 2 == 0 &&
	    job->file_count <= 2 * LIGHT_PAIRS_MAX && job->patch.count >= 1 &&
	    job->patch.count <= job->file_count / 2)
		return 0;
	return fault_say(
		fault, -EINVAL,
		"there are %d pictures and %d --patch, expected pairs of pictures, fisheye and background, and one patch for all or one for each",
		job->file_count, job->patch.count);
}

int light_command_gain(const struct light_job *job, struct fault *fault)
{
	struct light_pair pairs[LIGHT_PAIRS_MAX];
	struct light_gain found;
	char text[64], comment[256];
	int err;

	err = measure_pairs(job, pairs, fault);
	if (!err)
		err = light_gain_find(&found, pairs, job->file_count / 2, fault);
	if (err)
		return err;
	printf("gain %.5g, deviation %.2g (%.2f %%); white balance %.4f %.4f %.4f\n", found.gain,
	       found.deviation, 100 * found.deviation / found.gain, found.balance[0],
	       found.balance[1], found.balance[2]);
	for (int k = 0; k < found.pairs; k++)
		printf("pair %d: %.5g, weight %.2f, the patch uneven by %.1f %%\n", k + 1,
		       found.ratio[k], found.weight[k], 100 * pairs[k].patch.uneven);
	if (job->report)
		err = light_report_gain(job->report, &found, pairs, fault);
	snprintf(text, sizeof(text), "%.6g", found.gain);
	snprintf(comment, sizeof(comment), "Gain: deviation %.2g, from %d pairs of pictures.",
		 found.deviation, found.pairs);
	return err ? err : light_conclude(job, &found.verdict, "gain", text, comment, fault);
}

/* ---- colours ---- */

static int measure_colours(const struct light_job *job, struct light_colour_pair *pairs,
			   struct fault *fault)
{
	struct transfer_curve here, there;
	struct light_patch patch;
	int err;

	here = response_curve(&job->measured, TRANSFER_SRGB, 0);
	err = light_curve_of(job->background_light, &there, fault);
	for (int k = 0; !err && k < job->patch.count; k++) {
		err = measure_patch(job->fisheye, &job->patch.area[k], &here, &patch, fault);
		if (err)
			break;
		memcpy(pairs[k].fisheye, patch.mean, sizeof(patch.mean));
		err = measure_patch(job->background, &job->background_patch.area[k], &there, &patch,
				    fault);
		memcpy(pairs[k].background, patch.mean, sizeof(patch.mean));
	}
	return err ? err : job->patch.count;
}

static void say_colours(const struct light_colours *found)
{
	for (int r = 0; r < 3; r++)
		printf("%8.4f %8.4f %8.4f   deviation %.4f %.4f %.4f\n", found->matrix[3 * r],
		       found->matrix[3 * r + 1], found->matrix[3 * r + 2],
		       estimate_deviation(&found->estimate, 3 * r),
		       estimate_deviation(&found->estimate, 3 * r + 1),
		       estimate_deviation(&found->estimate, 3 * r + 2));
	printf("scale %.4g; %d patches differ by %.2f %%, before by %.2f %%; condition %.3g\n",
	       found->scale, found->patches, 100 * found->after, 100 * found->before,
	       found->condition);
}

int light_check_colours(const struct light_job *job, struct fault *fault)
{
	if (job->file_count == 1)
		return 0;
	if (!job->file_count && job->fisheye && job->background && job->patch.count >= 1 &&
	    job->patch.count == job->background_patch.count)
		return 0;
	return fault_say(
		fault, -EINVAL,
		"expected a file of patches, or --fisheye, --background and as many --patch as --background-patch");
}

int light_command_colours(const struct light_job *job, struct fault *fault)
{
	struct light_colour_pair pairs[LIGHT_PATCHES_MAX];
	struct light_colours found = {.patches = 0};
	char text[256] = "", comment[256];
	int err = job->file_count == 1 ? light_colours_read(job->files[0], pairs, fault)
				       : measure_colours(job, pairs, fault);

	if (err >= 0)
		err = light_colours_find(&found, pairs, err, fault);
	if (!err) {
		say_colours(&found);
		for (int e = 0; e < 9; e++)
			snprintf(text + strlen(text), sizeof(text) - strlen(text), "%s%.6g",
				 e % 3	 ? " "
				 : e > 0 ? "  "
					 : "",
				 found.matrix[e]);
		snprintf(comment, sizeof(comment),
			 "Colours: %d patches, which differ by %.2f %% (before: %.2f %%).",
			 found.patches, 100 * found.after, 100 * found.before);
		if (job->report)
			err = light_report_colours(job->report, &found, fault);
	}
	if (!err)
		err = light_conclude(job, &found.verdict, "colours", text, comment, fault);
	light_colours_free(&found);
	return err;
}
