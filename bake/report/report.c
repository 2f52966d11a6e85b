/* SPDX-License-Identifier: MIT */
#include "bake/report/report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"
#include "bake/report/report_sky.h"
#include "hal/base/input.h"
#include "hal/compositor/kernels/kernels.h"

/* Defaults. With them a report takes minutes on two cores. */
#define WIDTH 128
#define HEIGHT 96
#define SAMPLES 16
#define TRUTH_SAMPLES 1024
#define REPEAT 9
#define FISHEYE_SIDE 1024

#define QUICK_WIDTH 48
#define QUICK_HEIGHT 36
#define QUICK_SAMPLES 4
#define QUICK_TRUTH_SAMPLES 32
#define QUICK_FREQUENCY 3
#define QUICK_REPEAT 3
#define QUICK_SIDE 192

#define SEED 1

static const int frequencies[] = {1, 2, 3, 4, 6, 9, 18, 36};

static int given_or(int value, bool quick, int small, int usual)
{
	return value > 0 ? value : quick ? small : usual;
}

/* ---- surroundings and bakes ---- */

static int open_lightings(struct report *r)
{
	const struct report_settings *s = r->settings;
	const int samples = given_or(s->truth_samples, s->quick, QUICK_TRUTH_SAMPLES,
				     TRUTH_SAMPLES);
	int count = s->panoramas, err = 0;

	while (!s->panoramas && report_sky_names[count])
		count++;
	for (int k = 0; !err && k < count; k++) {
		const struct report_lighting_settings lighting = {
			.path = s->panorama[k],
			.made = k,
			.fisheye_side = s->quick ? QUICK_SIDE : FISHEYE_SIDE,
			.truth_samples = r->scene ? samples : 0,
			.threads = r->threads,
			.seed = SEED,
			.quiet = s->quiet};

		report_step(r, "surrounding %d of %d", k + 1, count);
		r->stage.lightings = k + 1;
		err = report_lighting_open(&r->stage.lighting[k], r->scene, r->stage.width,
					   r->stage.height, &lighting, r->fault);
	}
	r->truth = r->scene;
	return err;
}

/* Fills `to` with the dome frequencies to try, ascending, with that of the setting in use among
 * them. Returns their number. */
static int choose_frequencies(const struct report *r, int *to)
{
	const int most = given_or(r->settings->most_frequency, r->settings->quick, QUICK_FREQUENCY,
				  frequencies[sizeof(frequencies) / sizeof(*frequencies) - 1]);
	const int used = r->render.frequency;
	bool there = false;
	int count = 0;

	for (size_t k = 0; k < sizeof(frequencies) / sizeof(*frequencies); k++) {
		const int f = frequencies[k];

		if (!there && used <= f) {
			to[count++] = used;
			there = true;
		}
		if (f <= most && f != used)
			to[count++] = f;
	}
	if (!there)
		to[count++] = used;
	return count;
}

static int make_bakes(struct report *r)
{
	int frequency[REPORT_SWEEP_MAX];
	const int count = choose_frequencies(r, frequency);
	int err = 0;

	for (int k = 0; !err && k < count; k++) {
		struct render_settings settings = r->render;

		settings.frequency = frequency[k];
		if (settings.coarse > settings.frequency)
			settings.coarse = 0;
		report_step(r, "bake of frequency %d", frequency[k]);
		r->bakes = k + 1;
		err = report_bake_make(&r->bake[k], r->scene, &settings, r->page.temporary,
				       r->fault);
		if (frequency[k] == r->render.frequency)
			r->used = &r->bake[k];
	}
	return err;
}

static int report_open_scene(struct report *r)
{
	const struct report_settings *s = r->settings;
	int width = s->width, height = s->height, err;

	if (!width) {
		width = s->quick ? QUICK_WIDTH : WIDTH;
		height = s->quick ? QUICK_HEIGHT : HEIGHT;
	}
	err = scene_open(&r->scene, s->input, width, height, r->fault);
	if (!err)
		err = scene_find_pose(r->scene, s->pose, r->fault);
	if (err)
		return err;
	r->stage.width = r->scene->camera.width;
	r->stage.height = r->scene->camera.height;
	r->render = render_settings_of(r->scene);
	r->render.samples = given_or(s->samples, s->quick, QUICK_SAMPLES, SAMPLES);
	r->render.noise_levels = 0;
	r->render.threads = r->threads;
	r->render.exact = true;
	r->render.pose = s->pose;
	r->render.quiet = s->quiet;
	return s->basis ? report_given_open(r) : 0;
}

static int report_open_basis(struct report *r)
{
	int err;

	if (r->settings->basis || r->settings->pose)
		return fault_say(r->fault, -EINVAL, "%s: a basis file; --%s goes with a scene",
				 r->settings->input, r->settings->basis ? "basis" : "pose");
	r->bakes = 1;
	r->used = &r->bake[0];
	err = report_bake_open(r->used, r->settings->input, r->fault);
	if (err)
		return err;
	r->stage.width = (int)r->used->basis.info.width;
	r->stage.height = (int)r->used->basis.info.height;
	r->used->settings.frequency = (int)r->used->basis.info.dome_frequency;
	r->used->report.seconds = NAN;
	r->used->report.info = r->used->basis.info;
	return 0;
}

static bool is_basis(const char *path)
{
	char magic[sizeof(BASIS_MAGIC) - 1];
	FILE *file;
	const bool is = !input_stream(path, &file, NULL) &&
			fread(magic, sizeof(magic), 1, file) == 1 &&
			!memcmp(magic, BASIS_MAGIC, sizeof(magic));

	if (file)
		fclose(file);
	return is;
}

static int report_open_all(struct report *r)
{
	int frequency[REPORT_SWEEP_MAX];
	int err = is_basis(r->settings->input) ? report_open_basis(r) : report_open_scene(r);

	if (err)
		return err;
	r->stage.repeat = given_or(r->settings->repeat, r->settings->quick, QUICK_REPEAT, REPEAT);
	r->steps = (r->settings->panoramas ? r->settings->panoramas : 3) + 7;
	if (r->scene)
		r->steps += choose_frequencies(r, frequency) + (r->settings->quick ? 2 : 6) + 5;
	else
		r->steps--;
	r->steps += r->settings->basis != NULL;
	err = open_lightings(r);
	if (!err && r->scene)
		err = make_bakes(r);
	if (!err && scope_create(&r->scope, &r->used->basis, report_bake_layer(r->used)))
		err = fault_say(r->fault, -ENOMEM, "not enough memory");
	return err;
}

/* ---- the page ---- */

static void processor_name(char *name, size_t room)
{
	FILE *file = fopen("/proc/cpuinfo", "r");
	char line[256];

	snprintf(name, room, "a processor without a name");
	while (file && fgets(line, sizeof(line), file)) {
		const char *colon = strchr(line, ':');

		if (strncmp(line, "model name", 10) != 0 || !colon)
			continue;
		line[strcspn(line, "\n")] = '\0';
		snprintf(name, room, "%s", colon + 2);
		break;
	}
	if (file)
		fclose(file);
}

static int show_method(struct report *r)
{
	const struct report_settings *s = r->settings;
	const double waited = r->stage.timed_ns > r->stage.ran_ns
				      ? 100 - 100 * (double)r->stage.ran_ns /
							(double)r->stage.timed_ns
				      : 0;
	char processor[200];

	processor_name(processor, sizeof(processor));
	report_heading(r->page.body, "How was it measured?");
	report_paragraph(
		r->page.body,
		"inlay-bake %s on %s, kernel %s. Pictures of %d x %d pixels; %ld of them "
		"changed by the object, of which %ld show shadow alone; times grow with that "
		"number.%s%s%s%s",
		INLAY_VERSION, processor, kernels_choose(NULL)->name, r->stage.width,
		r->stage.height, r->scope.objects + r->scope.shadows, r->scope.shadows,
		s->pose ? " Of the scene's poses it is " : "", s->pose ? s->pose : "",
		s->pose ? "." : "",
		s->quick ? " This is a quick run: its figures show that it works, no more." : "");
	report_paragraph(
		r->page.body,
		"Times are medians of %d frames under each surrounding, all ways of a "
		"section in turns, each after frames that do not count. Of one thread it is "
		"the time that it had of the processor (%.0f %% of the time it had to wait "
		"for it); of several it is the clock's, and too long where the machine had "
		"other work.",
		r->stage.repeat, waited);
	report_paragraph(
		r->page.body,
		"Errors are in 8-bit sRGB levels over the pixels that the object changes. "
		"RMS and PSNR are over all surroundings' pixels, the largest is of all, and "
		"shadow is the mean error of the shadow's ratio, weighted by the light "
		"behind it. Double precision is not rounded: 8 bits alone are 0.29 levels, "
		"58.9 dB. The surroundings' own figures are in the CSV files.");
	if (r->truth)
		report_paragraph(
			r->page.body,
			"Bakes have %d samples a pixel and an estimated noise of %.2g levels in "
			"the "
			"setting in use; truth is path traced without lights, basis or compositor "
			"(%d samples a pixel). No error against truth can be told from these "
			"noises "
			"when it is less.",
			r->render.samples, r->used->report.info.noise_levels,
			given_or(s->truth_samples, s->quick, QUICK_TRUTH_SAMPLES, TRUTH_SAMPLES));
	return 0;
}

static int write_sections(struct report *r)
{
	static int (*const sections[])(struct report * r) = {
		report_lights,	   report_threshold,   report_input_bits, report_declared_error,
		report_column_cut, report_incremental, report_kernels,	  report_thread_counts,
		report_thesis,	   report_given,       report_pictures,	  show_method,
		report_summary};
	int err = 0;

	for (size_t k = 0; !err && k < sizeof(sections) / sizeof(*sections); k++)
		err = sections[k](r);
	return err;
}

static void close_all(struct report *r)
{
	for (int k = 0; k < r->bakes; k++)
		report_bake_close(&r->bake[k]);
	for (int l = 0; l < r->stage.lightings; l++)
		report_lighting_close(&r->stage.lighting[l]);
	report_bake_close(&r->given);
	scope_free(&r->scope);
	scene_close(r->scene);
	pool_destroy(r->stage.all);
	report_page_abandon(&r->page);
}

/* The name of a file without its folders. */
static const char *base_of(const char *path)
{
	const char *slash = strrchr(path, '/');

	return slash ? slash + 1 : path;
}

int report_run(const struct report_settings *settings, struct fault *fault)
{
	struct report *r = calloc(1, sizeof(*r));
	char title[256];
	int err;

	if (!r)
		return fault_say(fault, -ENOMEM, "not enough memory");
	r->settings = settings;
	r->fault = fault;
	err = pool_create(&r->stage.all, settings->threads);
	if (err) {
		fault_say(fault, err, "cannot start threads: %s", strerror(-err));
		goto release;
	}
	r->threads = pool_threads(r->stage.all);
	err = report_page_open(&r->page, settings->folder, fault);
	if (!err)
		err = report_open_all(r);
	if (!err)
		err = write_sections(r);
	snprintf(title, sizeof(title), "%s: speed against error", base_of(settings->input));
	if (!err)
		err = report_page_commit(&r->page, title, fault);
release:
	close_all(r);
	free(r);
	return err;
}
