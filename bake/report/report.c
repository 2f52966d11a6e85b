/* SPDX-License-Identifier: MIT */
#include "bake/report/report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sky.h"
#include "hal/base/input.h"
#include "hal/compositor/kernels/kernels.h"

/* Defaults. With them a report takes minutes on two cores; bake/README.md says how many. */
#define WIDTH 96
#define HEIGHT 72
#define SAMPLES 16
#define TRUTH_SAMPLES 256
#define REPEAT 9
#define FISHEYE_SIDE 512

#define SEED 1

/* Domes that are tried, up to --frequency; below LEAST_FREQUENCY only where that is below it. */
static const int frequencies[] = {1, 2, 3, 4, 6, 9, 18, 36};

#define LEAST_FREQUENCY 4
#define MOST_FREQUENCY 18

static int given_or(int value, int usual)
{
	return value > 0 ? value : usual;
}

/* ---- surroundings and bakes ---- */

static int open_lightings(struct report *r)
{
	const struct report_settings *s = r->settings;
	int count = s->panoramas, err = 0;

	while (!s->panoramas && report_sky_names[count])
		count++;
	for (int k = 0; !err && k < count; k++) {
		const struct report_lighting_settings lighting = {
			.path = s->panorama[k],
			.made = k,
			.fisheye_side = FISHEYE_SIDE,
			.truth_samples = given_or(s->truth_samples, TRUTH_SAMPLES),
			.threads = r->threads,
			.seed = SEED,
			.quiet = s->quiet};

		report_step(r, "surrounding %d of %d", k + 1, count);
		r->stage.lightings = k + 1;
		err = report_lighting_open(&r->stage.lighting[k], r->scene, &lighting, r->fault);
	}
	return err;
}

/* Fills `to` with the dome frequencies to try, ascending, with that of the setting in use among
 * them. Returns their number. */
static int choose_frequencies(const struct report *r, int *to)
{
	const struct report_settings *s = r->settings;
	const int most = given_or(s->most_frequency, MOST_FREQUENCY);
	const int least = most < LEAST_FREQUENCY ? 1 : LEAST_FREQUENCY;
	const int used = r->render.frequency;
	bool there = false;
	int count = 0;

	for (size_t k = 0; k < sizeof(frequencies) / sizeof(*frequencies); k++) {
		const int f = frequencies[k];

		if (!there && used <= f) {
			to[count++] = used;
			there = true;
		}
		if (f >= least && f <= most && f != used)
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
		if (frequency[k] != r->render.frequency)
			settings.fine = NULL; /* beside whole domes */
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
	int err = scene_open(&r->scene, s->input, given_or(s->width, WIDTH),
			     given_or(s->height, HEIGHT), r->fault);

	if (!err)
		err = scene_find_pose(r->scene, s->pose, r->fault);
	if (err)
		return err;
	r->stage.width = r->scene->camera.width;
	r->stage.height = r->scene->camera.height;
	r->render = render_settings_of(r->scene);
	r->render.samples = given_or(s->samples, SAMPLES);
	r->render.noise_levels = 0;
	r->render.threads = r->threads;
	r->render.exact = true;
	r->render.pose = s->pose;
	r->render.quiet = s->quiet;
	r->stage.repeat = given_or(s->repeat, REPEAT);
	return 0;
}

/* The steps that report_step() will log: what takes long. */
static int count_steps(const struct report *r)
{
	const struct report_settings *s = r->settings;
	int frequency[REPORT_SWEEP_MAX];
	int steps = 1 + s->panoramas;

	while (!s->panoramas && report_sky_names[steps - 1])
		steps++;
	return steps + choose_frequencies(r, frequency) + 1 + report_error_bakes();
}

static int report_open_all(struct report *r)
{
	int err = report_open_scene(r);

	if (err)
		return err;
	r->steps = count_steps(r);
	err = open_lightings(r);
	if (!err)
		err = make_bakes(r);
	if (!err && scope_create(&r->scope, &r->used->basis, report_bake_layer(r->used)))
		err = fault_say(r->fault, -ENOMEM, "not enough memory");
	if (!err)
		err = report_samples_measure(r);
	r->advised_frequency = r->render.frequency;
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
		"changed by the object, of which %ld show shadow alone; times grow with that number.%s%s%s",
		INLAY_VERSION, processor, kernels_choose(NULL)->name, r->stage.width,
		r->stage.height, r->scope.objects + r->scope.shadows, r->scope.shadows,
		s->pose ? " Of the scene's poses it is " : "", s->pose ? s->pose : "",
		s->pose ? "." : "");
	report_paragraph(
		r->page.body,
		"Times are medians of %d frames under each surrounding, with their quartiles: half "
		"of the frames took a time between these. All ways of a "
		"section take turns, each after frames that do not count, with one thread: a time "
		"is that which it had of the processor (%.0f %% of the time it had to wait for "
		"it). Times whose quartiles overlap, or whose medians are within 5 %%, count as equal.",
		r->stage.repeat, waited);
	report_paragraph(
		r->page.body,
		"Errors are in 8-bit sRGB levels over the pixels that the object changes. "
		"RMS and PSNR are over all surroundings' pixels, the largest is of all, and "
		"shadow is the mean error of the shadow's ratio, weighted by the light "
		"behind it. Double precision is not rounded: 8 bits alone are 0.29 levels, 58.9 dB. PSNR and the surroundings' own figures are in the CSV files.");
	report_paragraph(
		r->page.body,
		"Truth is path traced without lights, basis or compositor, %d samples a "
		"pixel in two halves, whose difference tells its noise: %.2g levels. RMS "
		"and PSNR are without that noise, the largest error holds it. Bakes have "
		"%d samples a pixel and a noise of %.2g levels in these surroundings, "
		"measured between two bakes with different random numbers. Errors count "
		"as equal if their squares differ by no more than the square of the noise "
		"that the advised samples leave (%.2g levels), plus what truth and bake, being noisy, leave uncertain of such a difference.",
		given_or(s->truth_samples, TRUTH_SAMPLES), r->truth_noise, r->render.samples,
		r->bake_noise, r->hidden);
	return 0;
}

static int write_sections(struct report *r)
{
	static int (*const sections[])(struct report * r) = {
		report_samples,	  report_lights,   report_declared_error, report_column_cut,
		report_threshold, report_pictures, show_method,		  report_summary,
	};
	int err = 0;

	report_step(r, "times and errors");
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
	report_bake_close(&r->fewer);
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
