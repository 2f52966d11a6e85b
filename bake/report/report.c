/* SPDX-License-Identifier: MIT */
#include "bake/report/report.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "hal/base/log.h"
#include "hal/measure/measure.h"

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

/* What the errors asked for are multiplied by. */
static const double errors[] = {0.5, 2, 4};

#define FEWER 4 /* factor between the samples of the setting in use and of the last bake */

/* The last bake is looked at in its exact layer alone, so its encoding may be coarser; but not
 * much, as the error that is asked for also decides which dim pixels are left out. */
#define COARSER 2

#define COUNT(array) (sizeof(array) / sizeof(*(array)))

static int given_or(int value, int usual)
{
	return value > 0 ? value : usual;
}

static void __attribute__((format(printf, 2, 3)))
say_step(const struct report *r, const char *format, ...)
{
	char text[256];
	va_list list;

	va_start(list, format);
	vsnprintf(text, sizeof(text), format, list);
	va_end(list);
	if (!r->settings->quiet)
		log_info("%s", text);
}

/* ---- surroundings ---- */

static int open_lightings(struct report *r)
{
	const struct report_settings *s = r->settings;
	int count = s->panoramas.count, err = 0;

	while (!s->panoramas.count && report_sky_names[count])
		count++;
	for (int k = 0; !err && k < count; k++) {
		const struct report_lighting_settings lighting = {.path = s->panoramas.text[k],
								  .made = k,
								  .fisheye_side = FISHEYE_SIDE,
								  .truth_samples = r->truth_samples,
								  .threads = r->threads,
								  .seed = SEED,
								  .quiet = s->quiet};

		say_step(r, "surrounding %d of %d", k + 1, count);
		r->stage.lightings = k + 1;
		err = report_lighting_open(&r->stage.lighting[k], r->scene, &lighting, r->fault);
	}
	return err;
}

/* ---- bakes ---- */

/* Plans a bake like that of the setting in use; the caller changes what differs. */
static struct report_bake *plan_bake(struct report *r)
{
	struct report_bake *bake = &r->bake[r->bakes++];

	bake->settings = r->bake[0].settings;
	return bake;
}

static void multiply_target(struct encode_target *target, double factor)
{
	target->rms *= factor;
	target->max *= factor;
	target->cell *= factor;
}

static void plan_bakes(struct report *r)
{
	const struct report_settings *s = r->settings;
	const int most = given_or(s->most_frequency, MOST_FREQUENCY);
	const int least = most < LEAST_FREQUENCY ? 1 : LEAST_FREQUENCY;
	struct render_settings *used = &r->bake[0].settings;
	struct report_bake *bake;

	*used = render_settings_of(r->scene);
	used->samples = given_or(s->samples, SAMPLES);
	used->noise_levels = 0;
	used->threads = r->threads;
	used->exact = true;
	used->pose = s->pose;
	used->quiet = s->quiet;
	snprintf(plan_bake(r)->name, sizeof(r->bake[0].name), "in use");
	for (size_t k = 0; k < COUNT(frequencies); k++) {
		const int f = frequencies[k];

		if (f < least || f > most || f == used->frequency)
			continue;
		bake = plan_bake(r);
		bake->settings.frequency = f;
		bake->settings.fine = NULL; /* beside whole domes */
		if (bake->settings.coarse > f)
			bake->settings.coarse = 0;
		snprintf(bake->name, sizeof(bake->name), "frequency = %d", f);
	}
	for (size_t k = 0; k < COUNT(errors); k++) {
		bake = plan_bake(r);
		bake->settings.exact = false;
		multiply_target(&bake->settings.target, errors[k]);
		snprintf(bake->name, sizeof(bake->name), "error = %.4g, cell_error = %.4g",
			 bake->settings.target.rms, bake->settings.target.cell);
	}
	bake = plan_bake(r);
	bake->settings.samples = used->samples > FEWER ? used->samples / FEWER : 1;
	bake->settings.seed = used->seed < 1 << 30 ? used->seed + 1 : 0;
	multiply_target(&bake->settings.target, COARSER);
	snprintf(bake->name, sizeof(bake->name), "samples = %d", bake->settings.samples);
}

static int make_bakes(struct report *r)
{
	int err = 0;

	plan_bakes(r);
	for (int k = 0; !err && k < r->bakes; k++) {
		say_step(r, "bake %d of %d: %s", k + 1, r->bakes, r->bake[k].name);
		err = report_bake_make(&r->bake[k], r->scene, &r->bake[0], &r->stage,
				       r->page.temporary, r->fault);
	}
	return err;
}

/* ---- noise ---- */

/* Mean square difference of two pictures over the pixels of the scope. */
static double pictures_differ(const struct scope *scope, const double *a, const double *b)
{
	double sum = 0;

	for (size_t at = 0; at < (size_t)scope->width * (size_t)scope->height; at++)
		for (size_t c = 3 * at; scope->pixel[at] != SCOPE_UNTOUCHED && c < 3 * at + 3; c++)
			sum += (a[c] - b[c]) * (a[c] - b[c]);
	return sum / fmax(3.0 * (double)(scope->objects + scope->shadows), 1);
}

/*
 * With S and s samples and independent random numbers, pictures differ by
 *     difference^2 = noise^2 (1 + S / s)        noise: of S samples
 * The truth is the mean of two halves, and has half the noise by which they differ.
 */
static void measure_noise(struct report *r)
{
	const struct report_bake *used = &r->bake[0], *fewer = &r->bake[r->bakes - 1];
	const double share = (double)used->settings.samples / fewer->settings.samples;
	double truth = 0, bake = 0;

	for (int l = 0; l < r->stage.lightings; l++) {
		struct report_lighting *at = &r->stage.lighting[l];

		at->bake_noise =
			sqrt(pictures_differ(&r->scope, used->precise[l], fewer->precise[l]) /
			     (1 + share));
		at->truth_noise = sqrt(pictures_differ(&r->scope, at->half[0], at->half[1]) / 4);
		bake += at->bake_noise * at->bake_noise / r->stage.lightings;
		truth += at->truth_noise * at->truth_noise / r->stage.lightings;
	}
	r->bake_noise = sqrt(bake);
	r->truth_noise = sqrt(truth);
}

/* ---- ways ---- */

/* Adds a trial of a bake: means over cells, no threshold, fast mode, the file's cut. */
static struct report_trial *add_trial(struct report *r, const struct report_bake *bake,
				      const char *name)
{
	struct report_trial *trial = &r->trial[r->trials++];

	*trial = (struct report_trial){.bake = bake,
				       .threshold_mode = THRESHOLD_AMBIENT,
				       .mode = COMPOSITOR_FAST,
				       .column_cut = bake->basis.info.column_cut};
	snprintf(trial->name, sizeof(trial->name), "%s", name);
	return trial;
}

/* Those that need no other bake. */
static void add_other_ways(struct report *r)
{
	static const double cuts[] = {0, 0.25, 4, 16}; /* times the file's own */
	static const struct {
		const char *name;
		double level, share;
		enum threshold_mode mode;
	} thresholds[] = {
		{"threshold = 0.1%", 0, 0.001, THRESHOLD_AMBIENT},
		{"threshold = 1%", 0, 0.01, THRESHOLD_AMBIENT},
		{"threshold = 5%", 0, 0.05, THRESHOLD_AMBIENT},
		{"threshold = 48", 48, 0, THRESHOLD_AMBIENT},
		{"threshold = 128", 128, 0, THRESHOLD_AMBIENT},
		{"threshold = 208", 208, 0, THRESHOLD_AMBIENT},
		{"threshold = 48, threshold_mode = drop", 48, 0, THRESHOLD_DROP},
		{"threshold = 128, threshold_mode = drop", 128, 0, THRESHOLD_DROP},
		{"threshold = 208, threshold_mode = drop", 208, 0, THRESHOLD_DROP},
	};
	const struct report_bake *used = &r->bake[0];
	const double own = used->basis.info.column_cut;
	struct report_trial *trial;
	char name[64];

	for (size_t k = 0; k < COUNT(cuts); k++) {
		/* In thousandths where the basis cuts nothing; a scene may ask for 0.1 at most. */
		const double cut = fmin(cuts[k] * (own > 0 ? own : 1e-3), 0.1);

		snprintf(name, sizeof(name), "column_cut = %.2g", cut);
		add_trial(r, used, name)->column_cut = cut;
	}
	for (size_t k = 0; k < COUNT(thresholds); k++) {
		trial = add_trial(r, used, thresholds[k].name);
		trial->threshold = transfer_decode(TRANSFER_SRGB, thresholds[k].level / 255);
		trial->budget = thresholds[k].share;
		trial->threshold_mode = thresholds[k].mode;
	}
}

static int try_all(struct report *r)
{
	if (scope_create(&r->scope, &r->bake[0].basis, &r->bake[0].basis.poses[0].exact))
		return fault_say(r->fault, -ENOMEM, "not enough memory");
	measure_noise(r);
	for (int k = 0; k < r->bakes - 1; k++)
		add_trial(r, &r->bake[k], r->bake[k].name);
	for (int k = 0; k < r->bakes; k++) {
		char name[64];

		snprintf(name, sizeof(name), "%s, exact layer", r->bake[k].name);
		if (r->bake[k].settings.exact)
			add_trial(r, &r->bake[k], name)->mode = COMPOSITOR_EXACT;
	}
	add_other_ways(r);
	say_step(r, "times and errors of %d ways", r->trials);
	return report_trials_run(r->trial, r->trials, &r->stage, &r->scope, r->fault);
}

/* ---- the whole ---- */

static int report_make(struct report *r)
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
	r->stage.repeat = given_or(s->repeat, REPEAT);
	r->truth_samples = given_or(s->truth_samples, TRUTH_SAMPLES);
	err = open_lightings(r);
	if (!err)
		err = make_bakes(r);
	if (!err)
		err = try_all(r);
	return err ? err : report_show(r);
}

static void close_all(struct report *r)
{
	for (int k = r->bakes; k--;)
		report_bake_close(&r->bake[k]);
	for (int l = 0; l < r->stage.lightings; l++)
		report_lighting_close(&r->stage.lighting[l]);
	scope_free(&r->scope);
	scene_close(r->scene);
	pool_destroy(r->stage.all);
	report_page_abandon(&r->page);
}

int report_run(const struct report_settings *settings, struct fault *fault)
{
	struct report *r = calloc(1, sizeof(*r));
	char name[128], title[256];
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
		err = report_make(r);
	lighting_name(settings->input, name, sizeof(name));
	snprintf(title, sizeof(title), "%s: speed against error", name);
	if (!err)
		err = report_page_commit(&r->page, title, fault);
release:
	close_all(r);
	free(r);
	return err;
}
