/* SPDX-License-Identifier: MIT */
/* inlay still: one picture through the pipeline, from files to a file. */
#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline.h"
#include "app/pipeline/pipeline_config.h"
#include "app/settings.h"
#include "hal/base/log.h"
#include "hal/base/output.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"
#include "hal/image/image.h"
#include "hal/lights/lights_file.h"

/* Fast and exact as in compositor.h; reference: double precision, of the exact layer where the
 * basis has one. */
enum still_mode { STILL_FAST, STILL_EXACT, STILL_REFERENCE };

static const char *const still_mode_names[] = {"fast", "exact", "reference", NULL};

struct still_options {
	struct settings settings;
	const char *basis, *background, *fisheye, *lights, *lights_out, *out;
	struct ini_level threshold; /* value NAN: as configured */
	int pose;		    /* -1: as configured */
	int mode;		    /* -1: as configured */
};

static int take_threshold(void *field, const char *option, const char *text, struct fault *fault)
{
	if (!ini_level_read(text, 255, field))
		return 0;
	return fault_say(fault, -EINVAL,
			 "%s: \"%s\", expected a grey level 0..255 or a percentage 0%%..100%%",
			 option, text);
}

#define AT(field) .place = offsetof(struct still_options, field)

static const struct option_row rows[] = {
	SETTINGS_ROWS,
	{"basis", OPTION_TEXT, AT(basis), .argument = "FILE",
	 .help = "the basis file; else the configuration's"},
	{"background", OPTION_TEXT, AT(background), .argument = "IMG",
	 .help = "the background camera's picture, 8-bit"},
	{"fisheye", OPTION_TEXT, AT(fisheye), .argument = "IMG",
	 .help = "the fisheye camera's picture, 8-bit or linear (.hdr, .pfm, .exr)"},
	{"lights", OPTION_TEXT, AT(lights), .argument = "FILE",
	 .help = "light colours instead of a fisheye: a line of \"r g b\" for each light, in dome order"},
	{"lights-out", OPTION_TEXT, AT(lights_out), .argument = "FILE",
	 .help = "write the measured light colours"},
	{"threshold", OPTION_OTHER, AT(threshold), .take = take_threshold, .argument = "LEVEL",
	 .help = "leave out lights below this grey level, 0..255, or what changes no pixel by more of white: 1%"},
	{"pose", OPTION_INT, AT(pose), .max = 65535, .argument = "N",
	 .help = "which pose of the basis, from 0"},
	{"mode", OPTION_CHOICE, AT(mode), .choices = still_mode_names, .argument = "MODE",
	 .help = "fast or exact, as [composite] mode; reference: in double precision, exact where the basis is"},
	{"out", OPTION_TEXT, AT(out), .argument = "FILE",
	 .help = "where the picture goes: .png, .pfm or .hdr"},
	{.name = NULL}};

/* What is wrong with the usage, or NULL. */
static const char *still_wrong(const struct still_options *o)
{
	if (o->out && image_name_linear(o->out, NULL) < 0)
		return "-o: expected a name that ends in .png, .pfm or .hdr";
	if (!o->background)
		return "--background IMG is missing";
	if (!o->out)
		return "-o FILE is missing";
	return !o->fisheye == !o->lights ? "expected one of --fisheye IMG and --lights FILE" : NULL;
}

struct still {
	const struct still_options *o;
	const struct config *config;
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
	err = lights_file_read(s->o->lights, radiance, count, fault);
	if (!err)
		pipeline_light_given(s->pipeline, radiance);
	free(radiance);
	return err;
}

static int light_from_fisheye(struct still *s, struct fault *fault)
{
	const char *path = s->o->fisheye;
	struct view view = s->config->fisheye.view.view;
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
		.threshold = s->o->threshold, .pose = s->o->pose, .object = true};

	return pipeline_choose(s->pipeline, &choice, fault);
}

static int find_light(struct still *s, struct fault *fault)
{
	const int err = s->o->lights ? light_from_file(s, fault) : light_from_fisheye(s, fault);

	return err ? err : choose_lights(s, fault);
}

/* ---- picture ---- */

static int read_background(struct still *s, struct picture *picture, struct fault *fault)
{
	const char *path = s->o->background;
	struct view view = s->config->background.view.view;
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
	const struct transfer_curve curve = config_background_curve(&s->config->background);

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

	if (s->o->mode == STILL_REFERENCE) {
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

	if (s->o->lights)
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
	err = image_name_linear(s->o->out, fault) == 1
		      ? image_create_f32(&s->out, background.width, background.height)
		      : image_create_u8(&s->out, background.width, background.height);
	if (err)
		return fault_say(fault, err, "not enough memory for the picture");
	fill_out(s);
	return 0;
}

/* ---- all of it ---- */

static int make_still(struct still *s, struct fault *fault)
{
	static const enum basis_part parts[] = {
		[STILL_FAST] = BASIS_SHOWN,
		[STILL_EXACT] = BASIS_WITH_EXACT,
		[STILL_REFERENCE] = BASIS_ALL,
	};
	const struct still_options *o = s->o;
	struct pipeline_settings pipeline = pipeline_settings_of(s->config);
	const char *const outputs[] = {o->out, o->lights_out};
	const char *const read[] = {o->basis, o->background, o->fisheye, o->lights};
	int err = output_check(outputs, 2, read, 4, fault);

	if (!err)
		err = pipeline_open_basis(&s->basis, o->basis, parts[o->mode], fault);
	if (err)
		return err;
	pipeline.mode = o->mode == STILL_EXACT ? COMPOSITOR_EXACT : COMPOSITOR_FAST;
	err = pipeline_create(&s->pipeline, &s->basis, &pipeline, fault);
	if (!err)
		err = find_light(s, fault);
	if (!err)
		err = make_picture(s, fault);
	if (err)
		return err;
	/* Files are written only after everything else has succeeded. */
	if (o->lights_out)
		err = lights_file_write(o->lights_out, pipeline_radiance(s->pipeline),
					(int)s->basis.info.lights, fault);
	return err ? err : image_write(o->out, &s->out, fault);
}

/* Fills in what the configuration says where no option does. */
static int run_config(struct still_options *o, const struct config *config, struct fault *fault)
{
	struct still s = {.o = o, .config = config};
	int err;

	if (!o->basis)
		o->basis = config->basis.file;
	if (isnan(o->threshold.value))
		o->threshold = config->lights.threshold;
	if (o->pose < 0)
		o->pose = config->basis.pose;
	if (o->mode < 0)
		o->mode = config->composite.mode == COMPOSITOR_EXACT ? STILL_EXACT : STILL_FAST;
	if (!*o->basis)
		return fault_say(
			fault, -EINVAL,
			"still: no basis file, expected --basis FILE or [basis] file in the configuration");
	err = make_still(&s, fault);
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

static int still_command_run(const struct command *command, int argc, char **argv)
{
	struct still_options options = {.threshold = {.value = NAN}, .pose = -1, .mode = -1};
	struct ini_report report = {.count = 0};
	struct config *config = NULL;
	int code = command_read_all(command, argc, argv, rows, &options), err;

	if (code != COMMAND_GOES_ON)
		return code;
	if (still_wrong(&options))
		return command_wrong(command, "%s", still_wrong(&options));
	err = settings_read(&options.settings, &config, &report);
	if (!err)
		err = run_config(&options, config, &report.first);
	if (err)
		log_error("%s", report.first.text);
	config_destroy(config);
	return err ? EXIT_FAILURE : EXIT_SUCCESS;
}

const struct command command_still = {
	.name = "still",
	.usage = "--basis FILE --background IMG (--fisheye IMG | --lights FILE) -o OUT",
	.summary = "one picture through the pipeline, from files to a file",
	.help = "\nA .png holds 8-bit code values; a .pfm or .hdr the linear light that they stand for, not\n"
		"rounded in reference mode. [fisheye] and [background] of the configuration say how the\n"
		"pictures are to be read: lens, view, transfer.\n",
	.run = still_command_run,
};
