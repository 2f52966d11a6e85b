/* SPDX-License-Identifier: MIT */
#include "bake/sky/sky_eye.h"

#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/lights/sampler.h"

struct sky_eye {
	const struct dome *pieces; /* borrowed */
	struct light_sampler *sampler;
	struct light_exposures *exposures;
	float (*radiance)[3]; /* [pieces] */
	float *clipped;	      /* [pieces]: share that is clipped in every exposure */
	double clipped_radiance;
};

void sky_eye_destroy(struct sky_eye *eye)
{
	if (!eye)
		return;
	light_sampler_destroy(eye->sampler);
	light_exposures_destroy(eye->exposures);
	free(eye->radiance);
	free(eye->clipped);
	free(eye);
}

/* Tells how many pixels see each piece, by which exposures are weighted. */
static int eye_measure(struct sky_eye *eye, const struct fisheye *lens,
		       const struct sky_eye_settings *settings)
{
	const int count = eye->pieces->count;
	float *pixels = calloc((size_t)count, sizeof(*pixels));

	if (!pixels)
		return -ENOMEM;
	for (int i = 0; i < count; i++) {
		double px[2], sr = 0;

		if (fisheye_project(lens, eye->pieces->direction[i], px))
			sr = fisheye_pixel_sr(lens, px);
		pixels[i] = sr > 0 ? (float)fmax(1, eye->pieces->solid_angle_sr[i] / sr) : 1;
	}
	light_exposures_measured(eye->exposures, settings->ratio, settings->exposures,
				 &settings->curve, 1, pixels);
	eye->clipped_radiance = SKY_EYE_CLIPPED * light_exposures_white(eye->exposures);
	free(pixels);
	return 0;
}

static int eye_prepare(struct sky_eye *eye, const struct sky_eye_settings *settings, int width,
		       int height, struct fault *fault)
{
	const struct light_sampler_settings sampler = {.curve = settings->curve, .gain = 1};
	const size_t count = (size_t)eye->pieces->count;
	struct fisheye lens;
	int err = fisheye_prepare(&lens, &settings->lens, width, height, fault);

	if (!err)
		err = light_sampler_create(&eye->sampler, eye->pieces, &lens, width, height,
					   &sampler, fault);
	if (err)
		return err;
	eye->radiance = calloc(count, sizeof(*eye->radiance));
	eye->clipped = calloc(count, sizeof(*eye->clipped));
	if (!eye->radiance || !eye->clipped ||
	    light_exposures_create(&eye->exposures, eye->pieces->count) ||
	    eye_measure(eye, &lens, settings))
		return fault_say(fault, -ENOMEM, "not enough memory for the sky");
	return 0;
}

int sky_eye_create(struct sky_eye **eye, const struct dome *pieces,
		   const struct sky_eye_settings *settings, int width, int height,
		   struct fault *fault)
{
	struct sky_eye *e = calloc(1, sizeof(*e));
	int err;

	*eye = NULL;
	if (!e)
		return fault_say(fault, -ENOMEM, "not enough memory for the sky");
	e->pieces = pieces;
	err = eye_prepare(e, settings, width, height, fault);
	if (err) {
		sky_eye_destroy(e);
		return err;
	}
	*eye = e;
	return 0;
}

static int sample_codes(struct light_sampler *sampler, const struct image *image,
			float (*radiance)[3], double *clipped)
{
	const struct view view = {.width = image->width, .height = image->height};
	struct canvas canvas = {.pixels = NULL};
	struct picture picture;
	int err = canvas_create(&canvas, image->width, image->height);

	if (err)
		return err;
	/* libyuv's RAW is R, G, B in memory. */
	RAWToARGB(image->u8, 3 * image->width, canvas.pixels, (int)canvas.stride, image->width,
		  image->height);
	picture = view_picture(&view, canvas.pixels, canvas.stride);
	err = light_sampler_read(sampler, &picture, radiance, clipped);
	canvas_free(&canvas);
	return err;
}

int sky_eye_sample(struct light_sampler *sampler, const struct image *image, float (*radiance)[3],
		   double *clipped)
{
	if (image->u8)
		return sample_codes(sampler, image, radiance, clipped);
	if (clipped)
		*clipped = 0;
	return light_sampler_read_linear(sampler, image, radiance);
}

int sky_eye_read(struct sky_eye *eye, const struct image *picture, int exposure)
{
	int err;

	light_sampler_exposure(eye->sampler, light_exposures_longer(eye->exposures, exposure),
			       light_exposures_shorter(eye->exposures, exposure));
	err = sky_eye_sample(eye->sampler, picture, eye->radiance, NULL);
	if (!err && picture->u8)
		light_exposures_take(eye->exposures, exposure, (const float(*)[3])eye->radiance,
				     light_sampler_excess(eye->sampler),
				     light_sampler_clipped(eye->sampler), eye->radiance,
				     eye->clipped);
	else
		memset(eye->clipped, 0, (size_t)eye->pieces->count * sizeof(*eye->clipped));
	return err;
}

void sky_eye_gather(const struct sky_eye *eye, const struct sky_need *need, double scale,
		    double *irradiance)
{
	for (int i = 0; i < eye->pieces->count; i++) {
		const float *rgb = eye->radiance[i];
		const double mean = ((double)rgb[0] + (double)rgb[1] + (double)rgb[2]) / 3;
		const double clipped = (double)eye->clipped[i] * eye->clipped_radiance;

		irradiance[i] += scale * (mean + clipped) * need->even[i];
	}
}

double sky_eye_least(void)
{
	return SKY_EYE_DARK * M_PI;
}

/* ---- files ---- */

struct lens_section {
	struct fisheye_settings *lens;
	bool found;
};

static void *lens_section_place(void *root, const char *instance)
{
	struct lens_section *section = root;

	(void)instance;
	section->found = true;
	return section->lens;
}

int sky_eye_lens(struct fisheye_settings *lens, const char *path, struct fault *fault)
{
	const struct ini_table tables[] = {
		{.section = "fisheye", .keys = fisheye_keys, .place = lens_section_place},
		INI_TABLES_END};
	struct lens_section section = {.lens = lens};
	struct ini_report report = {.count = 0};
	int err;

	ini_defaults(fisheye_keys, lens);
	err = ini_read(path, tables, &section, &report);
	if (err)
		return fault_say(fault, err, "%s", report.first.text);
	return section.found ? 0
			     : fault_say(fault, -EINVAL, "%s: expected a [fisheye] section", path);
}

static int add_picture(struct sky_need *need, const struct sky_eye_settings *settings,
		       struct sky_eye **eye, const char *path, int exposure, bool *linear,
		       struct fault *fault)
{
	struct image picture = {.width = 0};
	struct fault why = {.text = ""};
	int err = image_read(path, &picture, fault);

	if (err)
		return err;
	*linear = picture.f32;
	if (*linear && settings->exposures > 1)
		err = fault_say(
			&why, -EINVAL,
			"is linear light, which needs no other exposure; expected 8-bit pictures, or this one alone");
	if (!err && !*eye)
		err = sky_eye_create(eye, sky_need_pieces(need), settings, picture.width,
				     picture.height, &why);
	if (!err) {
		err = sky_eye_read(*eye, &picture, exposure);
		if (err == -EINVAL)
			fault_say(&why, err,
				  "is %dx%d pixels, expected the size of the first picture",
				  picture.width, picture.height);
		else if (err)
			fault_say(&why, err, "%s", strerror(-err));
	}
	image_free(&picture);
	return err ? fault_say(fault, err, "%s: %s", path, why.text) : 0;
}

int sky_need_add_pictures(struct sky_need *need, const struct sky_eye_settings *settings,
			  char *const *path, struct fault *fault)
{
	struct sky_eye *eye = NULL;
	bool linear = false;
	int err = 0;

	for (int k = 0; !err && k < settings->exposures; k++)
		err = add_picture(need, settings, &eye, path[k], k, &linear, fault);
	if (!err) {
		memset(need->irradiance, 0,
		       (size_t)sky_need_pieces(need)->count * sizeof(*need->irradiance));
		sky_eye_gather(eye, need, 1, need->irradiance);
		sky_need_add(need, linear ? 0 : sky_eye_least());
	}
	sky_eye_destroy(eye);
	return err;
}
