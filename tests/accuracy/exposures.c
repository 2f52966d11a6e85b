/* SPDX-License-Identifier: MIT */
/*
 * exposures BASIS SCENE HDRI [--quick]
 *
 * How right the light is that an 8-bit fisheye measures in a place with lamps: with one exposure,
 * with one and what the ground tells, and with three in turn. A simulated camera (black level,
 * noise, sRGB, clipping, a control that is obeyed 0 to 6 frames later) lies in the project's room
 * and in the panorama files of the folder HDRI, and goes the way of `inlay run`: exposures are
 * asked for, their delay is measured, each picture gets its own. The background is a grey card
 * under that light, taken by another 8-bit camera with noise.
 *
 * Prints a table: the worst error of the sky's total irradiance in any channel, and the composite
 * of SCENE's object, which BASIS holds, against double precision with the true lights and, in
 * panoramas, against the path-traced truth. Then a table of random places (exposures_random.h);
 * fails where the ground makes too many of them worse. --quick: two of the places, three delays,
 * no path tracing, fewer random places.
 */
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/camera/eye.h"
#include "app/pipeline/pipeline_config.h"
#include "app/settings.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "tests/accuracy/exposures_random.h"

#define DELAYS 7 /* 0..6 frames */
#define WAIT_MS 10000

static const struct exposures_place places[] = {
	{"museum", "st_fagans_interior_1k.hdr", 0.585, 32},
	{"sunset", "venice_sunset_1k.hdr", 0.856, 64},
	{"lamps", "studio_small_03_1k.hdr", 0.136, 32},
	{"room", NULL, 0.6, 4},
};

enum way { ONE, ONE_RECOVERED, THREE, THREE_RECOVERED, UNCLIPPED, WAYS };

static const char *const way_names[] = {"one exposure", "one, recovered", "three exposures",
					"three, recovered", "a camera without limits"};

/* The camera at a place, and what the program makes of its pictures. */
struct exposures_rig {
	struct config *config;
	struct pipeline *pipeline;
	struct source source;
	struct eye eye;
	struct exposing exposing;
};

/* ---- what is measured ---- */

__attribute__((format(printf, 2, 3))) static void set(struct config *config, const char *format,
						      ...)
{
	struct ini_report report = {.count = 0};
	char text[INI_PATH_MAX + 64];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	must(config_set(config, text, &report), &report.first);
}

static void configure(struct exposures_rig *rig, const struct table *t,
		      const struct exposures_place *place, enum way way, int delay)
{
	struct config *config;
	struct fault fault = {.text = "not enough memory"};

	must(config_create(&config, driver_list()), &fault);
	rig->config = config;
	set(config, "camera.fisheye.driver=sim");
	set(config, "camera.fisheye.width=480");
	set(config, "camera.fisheye.height=480");
	set(config, "camera.fisheye.rate=%g", RATE_HZ);
	set(config, "camera.fisheye.sim.clock=frames");
	set(config, "camera.fisheye.sim.exposure=%g", place->exposure);
	set(config, "camera.fisheye.sim.black_level=16");
	set(config, "camera.fisheye.sim.read_noise=0.4");
	set(config, "camera.fisheye.sim.shot_noise=2");
	set(config, "camera.fisheye.sim.control_delay=%d", delay);
	if (place->file) {
		set(config, "camera.fisheye.sim.source=panorama");
		set(config, "camera.fisheye.sim.file=%s/%s", t->folder, place->file);
	}
	set(config, "fisheye.black_level=16");
	set(config, "lights.follow=0");
	if (way == UNCLIPPED)
		set(config, "camera.fisheye.format=RGBF");
	if (way == THREE || way == THREE_RECOVERED) {
		set(config, "fisheye.exposures=%.9g %.9g %.9g", place->exposure,
		    place->exposure / place->step, place->exposure / place->step / place->step);
		set(config, "fisheye.exposure_control=exposure");
	}
	if (way == ONE_RECOVERED || way == THREE_RECOVERED) {
		set(config, "background.ground_patch=4 4 40 30");
		set(config, "background.ground_reflectance=%g %g %g", CARD, CARD, CARD);
	}
}

static void exposures_start(struct exposures_rig *rig, const struct table *t)
{
	const struct pipeline_settings settings = pipeline_settings_of(rig->config);
	struct config_camera *camera = config_camera_named(rig->config, "fisheye");
	const int driver = config_driver_index(rig->config, CONFIG_CAMERA, "sim");
	const struct source_settings source = {
		.name = camera->name,
		.ops = camera_drivers[driver],
		.camera = camera->settings,
		.options = config_options(rig->config, CONFIG_CAMERA, camera, driver),
		.curve = config_fisheye_curve(&rig->config->fisheye),
	};
	struct fault fault = {.text = ""};

	must(pipeline_create(&rig->pipeline, &t->basis, &settings, &fault), &fault);
	must(source_create(&rig->source, &source), &fault);
	rig->eye = (struct eye){.section = "fisheye",
				.source = &rig->source,
				.wanted = rig->config->fisheye.view.view};
	exposing_start(&rig->exposing, &rig->config->fisheye);
	source_open(&rig->source);
}

static void exposures_stop(struct exposures_rig *rig)
{
	source_destroy(&rig->source);
	pipeline_destroy(rig->pipeline);
	config_destroy(rig->config);
}

/* Waits for the next picture and measures its light. */
static void exposures_look(struct exposures_rig *rig)
{
	struct source *source = &rig->source;
	struct fault fault = {.text = ""};
	struct picture picture;
	int err;

	while (!source_has_news(source)) {
		struct pollfd wait = {.fd = source_descriptor(source), .events = POLLIN};

		if (poll(&wait, 1, WAIT_MS) != 1)
			die("the camera gives nothing");
		must(source_take(source, clock_now_ns(), &fault), &fault);
	}
	if (!source_decode(source, clock_now_ns()))
		die("a frame does not decode");
	pipeline_expose(rig->pipeline, exposing_take(&rig->exposing, source, clock_now_ns()),
			rig->exposing.ratio);
	must(eye_fit(&rig->eye, &fault), &fault);
	if (source->is_linear) {
		err = pipeline_light_linear(rig->pipeline, &source->linear, &rig->eye.view, &fault);
	} else {
		picture = eye_picture(&rig->eye);
		err = pipeline_light_picture(rig->pipeline, &picture, &fault);
	}
	if (err != -ESTALE)
		must(err, &fault);
	exposing_judge(&rig->exposing, source, pipeline_report(rig->pipeline).level, !err);
}

/* ---- the table ---- */

struct exposures_figures {
	double worst[3]; /* largest error of the irradiance over the delays, by channel, signed */
	double clipped;
	struct composite_error composite, traced;
	int unfit;
	bool wrong_delay;
};

static double worst_of(const double v[3])
{
	return fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
}

static void judge(const struct table *t, struct exposures_rig *rig,
		  const struct exposures_truth *truth, struct exposures_figures *f)
{
	const struct picture card = whole(&truth->card);
	const struct backdrop backdrop = backdrop_of(&card);
	struct fault fault = {.text = ""};
	struct composite_error error;
	double got[3], off[3];
	struct canvas out;

	irradiance_of(pipeline_dome(rig->pipeline), pipeline_radiance(rig->pipeline), got);
	for (int c = 0; c < 3; c++)
		off[c] = got[c] / truth->irradiance[c] - 1;
	if (worst_of(off) >= worst_of(f->worst))
		memcpy(f->worst, off, sizeof(off));
	f->clipped = fmax(f->clipped, pipeline_report(rig->pipeline).clipped);
	f->unfit += (int)pipeline_report(rig->pipeline).unfit;
	must(canvas_create(&out, card.width, card.height), &fault);
	choose(rig->pipeline);
	must(pipeline_composite(rig->pipeline, &backdrop, out.pixels, out.stride, &fault), &fault);
	error = error_measure(&t->scope, truth->composite, &out, &card, TRANSFER_SRGB);
	error_worse(&f->composite, &error);
	if (truth->traced) {
		error = error_measure(&t->scope, truth->traced, &out, &card, TRANSFER_SRGB);
		error_worse(&f->traced, &error);
	}
	canvas_free(&out);
}

static void run_way(const struct table *t, const struct exposures_place *place, enum way way,
		    int delay, const struct exposures_truth *truth, struct exposures_figures *f)
{
	struct exposures_rig rig = {.config = NULL};

	configure(&rig, t, place, way, delay);
	exposures_start(&rig, t);
	for (int k = 0; k < PICTURES; k++)
		exposures_look(&rig);
	f->wrong_delay |= rig.exposing.count > 1 && rig.exposing.schedule.delay != delay;
	look_at_card(rig.pipeline, truth);
	judge(t, &rig, truth, f);
	exposures_stop(&rig);
}

static void print_row(const struct exposures_place *place, enum way way,
		      const struct exposures_figures *f, bool traced)
{
	printf("| %s | %s | %+.1f %+.1f %+.1f | %.2f | %.2f | %.1f | ", place->name, way_names[way],
	       100 * f->worst[0], 100 * f->worst[1], 100 * f->worst[2], 100 * f->clipped,
	       f->composite.rms, f->composite.max);
	if (traced)
		printf("%.2f | ", f->traced.rms);
	else
		printf("| ");
	printf("%d%s |\n", f->unfit, f->wrong_delay ? ", a wrong delay" : "");
	fflush(stdout);
}

static void print_place(const struct table *t, const struct exposures_place *place)
{
	struct exposures_truth truth;

	find_truth(t, place, &truth);
	for (enum way way = ONE; way < WAYS; way++) {
		const bool alternates = way == THREE || way == THREE_RECOVERED;
		struct exposures_figures f = {
			.composite = {.psnr_db = INFINITY, .frame_psnr_db = INFINITY},
			.traced = {.psnr_db = INFINITY, .frame_psnr_db = INFINITY}};

		for (int delay = 0; delay < (alternates ? DELAYS : 1); delay += t->quick ? 3 : 1)
			run_way(t, place, way, delay, &truth, &f);
		print_row(place, way, &f, truth.traced != NULL);
	}
	free_truth(&truth);
}

int main(int argc, char **argv)
{
	struct table t = {.quick = argc == 5 && !strcmp(argv[4], "--quick")};
	struct fault fault = {.text = ""};
	bool improves;

	if (argc != 4 && !t.quick) {
		fputs("usage: exposures BASIS SCENE HDRI [--quick]\n", stderr);
		return 2;
	}
	log_setup("exposures", LOG_LEVEL_WARNING);
	t.folder = argv[3];
	must(basis_open(&t.basis, argv[1], BASIS_SHOWN, &fault), &fault);
	must(scene_open(&t.scene, argv[2], (int)t.basis.info.width, (int)t.basis.info.height,
			&fault),
	     &fault);
	must(scope_create(&t.scope, &t.basis, &t.basis.poses[0].shown), &fault);
	puts("| place | light from | error of irradiance, % R G B | sky clipped, % | against double precision: RMS | max | against truth: RMS | unfit pictures |\n"
	     "|---|---|---|---|---|---|---|---|");
	for (size_t k = 0; k < sizeof(places) / sizeof(*places); k++)
		if (!t.quick || k == 1 || k == 2)
			print_place(&t, &places[k]);
	improves = random_places(&t);
	scope_free(&t.scope);
	scene_close(t.scene);
	basis_close(&t.basis);
	if (!improves)
		die("what the ground tells makes more than 5 %% of the random places worse");
	return 0;
}
