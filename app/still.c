/* SPDX-License-Identifier: MIT */
#include "app/still.h"

#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline.h"
#include "app/pipeline/pipeline_config.h"
#include "hal/base/output.h"
#include "hal/frame/frame.h"
#include "hal/image/image.h"
#include "hal/lights/lights_file.h"

const char *const still_mode_names[] = {"fast", "exact", "reference", NULL};

struct still {
	const struct still_settings *settings;
	struct basis basis;
	struct pipeline *pipeline;
	struct image fisheye;
	struct canvas fisheye_canvas, background_canvas, after;
	double *reference; /* [height][width][3], encoded, 0..255 */
	struct image out;
};

static int canvas_of(struct canvas *canvas, const struct image *image, const char *path,
		     struct fault *fault)
{
	int err;

	if (!image->u8)
		return fault_say(fault, -EINVAL,
				 "%s: holds linear light, expected an 8-bit picture (PNG, JPEG)",
				 path);
	err = canvas_create(canvas, image->width, image->height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for %dx%d pixels", path,
				 image->width, image->height);
	/* libyuv's RAW is R, G, B in memory. */
	RAWToARGB(image->u8, 3 * image->width, canvas->pixels, (int)canvas->stride, image->width,
		  image->height);
	return 0;
}

static int say_view(struct fault *fault, int err, const char *path, const struct fault *reason)
{
	return fault_say(fault, err, "%s: %s", path, reason->text);
}

/* ---- light ---- */

static int light_from_file(struct still *s, struct fault *fault)
{
	int count = (int)s->basis.info.lights, err;
	float(*radiance)[3] = calloc((size_t)count, sizeof(*radiance));

	if (!radiance)
		return fault_say(fault, -ENOMEM, "not enough memory for %d lights", count);
	err = lights_file_read(s->settings->lights, radiance, count, fault);
	if (!err)
		pipeline_light_given(s->pipeline, radiance);
	free(radiance);
	return err;
}

static int light_from_fisheye(struct still *s, struct fault *fault)
{
	const char *path = s->settings->fisheye;
	struct view view = s->settings->config->fisheye.view.view;
	struct fault reason = {.text = ""};
	struct picture picture;
	int err = image_read(path, &s->fisheye, fault);

	if (err)
		return err;
	err = view_resolve(&view, s->fisheye.width, s->fisheye.height, &reason);
	if (err)
		return say_view(fault, err, path, &reason);
	if (s->fisheye.f32)
		return pipeline_light_linear(s->pipeline, &s->fisheye, &view, fault);
	err = canvas_of(&s->fisheye_canvas, &s->fisheye, path, fault);
	if (err)
		return err;
	picture = view_picture(&view, s->fisheye_canvas.pixels, s->fisheye_canvas.stride);
	return pipeline_light_picture(s->pipeline, &picture, fault);
}

static int choose_lights(struct still *s, struct fault *fault)
{
	const struct pipeline_choice choice = {
		.threshold = s->settings->threshold, .pose = s->settings->pose, .object = true};

	return pipeline_choose(s->pipeline, &choice, fault);
}

static int find_light(struct still *s, struct fault *fault)
{
	const int err = s->settings->lights ? light_from_file(s, fault)
					    : light_from_fisheye(s, fault);

	return err ? err : choose_lights(s, fault);
}

/* ---- picture ---- */

static int read_background(struct still *s, struct picture *picture, struct fault *fault)
{
	const char *path = s->settings->background;
	struct view view = s->settings->config->background.view.view;
	struct fault reason = {.text = ""};
	struct image image;
	int err = image_read(path, &image, fault);

	if (err)
		return err;
	err = view_resolve(&view, image.width, image.height, &reason);
	if (err)
		err = say_view(fault, err, path, &reason);
	else
		err = canvas_of(&s->background_canvas, &image, path, fault);
	image_free(&image);
	if (err)
		return err;
	*picture = view_picture(&view, s->background_canvas.pixels, s->background_canvas.stride);
	return 0;
}

/* Code value of one channel of the result; not rounded in reference mode. */
static double code_at(const struct still *s, int x, int y, int channel)
{
	size_t at = (size_t)y * (size_t)s->out.width + (size_t)x;

	if (s->reference)
		return s->reference[3 * at + (size_t)channel];
	return s->after.pixels[(size_t)y * s->after.stride + 4 * (size_t)x + 2 - (size_t)channel];
}

/* PNG holds code values, PFM and Radiance the linear light that they stand for. */
static void fill_out(struct still *s)
{
	const struct transfer_curve curve =
		config_background_curve(&s->settings->config->background);

	for (int y = 0; y < s->out.height; y++) {
		for (int x = 0; x < s->out.width; x++) {
			size_t at = 3 * ((size_t)y * (size_t)s->out.width + (size_t)x);

			for (int c = 0; c < 3; c++) {
				double code = code_at(s, x, y, c);

				if (s->out.u8)
					s->out.u8[at + (size_t)c] = (uint8_t)lrint(code);
				else
					s->out.f32[at + (size_t)c] =
						(float)transfer_curve_decode(&curve, code / 255);
			}
		}
	}
}

static int composite_still(struct still *s, const struct picture *background, struct fault *fault)
{
	size_t pixels = (size_t)background->width * (size_t)background->height;
	struct backdrop backdrop;
	int err;

	if (s->settings->mode == STILL_REFERENCE) {
		s->reference = malloc(3 * pixels * sizeof(*s->reference));
		if (!s->reference)
			return fault_say(fault, -ENOMEM, "not enough memory for the picture");
		return pipeline_reference(s->pipeline, background, s->reference, fault);
	}
	err = canvas_create(&s->after, background->width, background->height);
	if (err)
		return fault_say(fault, err, "not enough memory for the picture");
	backdrop = backdrop_of(background);
	return pipeline_composite(s->pipeline, &backdrop, s->after.pixels, s->after.stride, fault);
}

/* Light that the fisheye clips may be seen on the ground of the background. */
static int recover_light(struct still *s, const struct picture *background, struct fault *fault)
{
	const struct frame_reader reader = frame_reader_of(background);

	if (s->settings->lights)
		return 0;
	pipeline_recover(s->pipeline, &reader);
	return choose_lights(s, fault);
}

static int make_picture(struct still *s, struct fault *fault)
{
	struct picture background;
	int err = read_background(s, &background, fault);

	if (!err)
		err = recover_light(s, &background, fault);
	if (err)
		return err;
	err = composite_still(s, &background, fault);
	if (err)
		return err;
	err = image_name_linear(s->settings->out, fault) == 1
		      ? image_create_f32(&s->out, background.width, background.height)
		      : image_create_u8(&s->out, background.width, background.height);
	if (err)
		return fault_say(fault, err, "not enough memory for the picture");
	fill_out(s);
	return 0;
}

/* ---- all of it ---- */

static int open_still_basis(struct still *s, struct fault *fault)
{
	static const enum basis_part parts[] = {
		[STILL_FAST] = BASIS_SHOWN,
		[STILL_EXACT] = BASIS_WITH_EXACT,
		[STILL_REFERENCE] = BASIS_ALL,
	};
	const struct still_settings *settings = s->settings;

	return pipeline_open_basis(&s->basis, settings->basis, parts[settings->mode], fault);
}

static int make_still(struct still *s, struct fault *fault)
{
	const struct still_settings *settings = s->settings;
	struct pipeline_settings pipeline = pipeline_settings_of(settings->config);
	const char *const outputs[] = {settings->out, settings->lights_out};
	const char *const read[] = {settings->basis, settings->background, settings->fisheye,
				    settings->lights};
	int err = output_check(outputs, 2, read, 4, fault);

	if (!err)
		err = open_still_basis(s, fault);
	if (err)
		return err;
	pipeline.mode = settings->mode == STILL_EXACT ? COMPOSITOR_EXACT : COMPOSITOR_FAST;
	err = pipeline_create(&s->pipeline, &s->basis, &pipeline, fault);
	if (err)
		return err;
	err = find_light(s, fault);
	if (err)
		return err;
	err = make_picture(s, fault);
	if (err)
		return err;
	/* Files are written only after everything else has succeeded. */
	if (settings->lights_out)
		err = lights_file_write(settings->lights_out, pipeline_radiance(s->pipeline),
					(int)s->basis.info.lights, fault);
	return err ? err : image_write(settings->out, &s->out, fault);
}

int still_run(const struct still_settings *settings, struct fault *fault)
{
	struct still s = {.settings = settings};
	int err = make_still(&s, fault);

	image_free(&s.out);
	free(s.reference);
	canvas_free(&s.after);
	canvas_free(&s.background_canvas);
	canvas_free(&s.fisheye_canvas);
	image_free(&s.fisheye);
	pipeline_destroy(s.pipeline);
	basis_close(&s.basis);
	return err;
}
