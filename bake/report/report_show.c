/* SPDX-License-Identifier: MIT */
/* The page: the setting in use, all ways in a table, pictures, how it was measured. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "hal/compositor/kernels/kernels.h"

/* ---- the setting in use ---- */

static double basis_mb(const struct report_trial *trial)
{
	const struct render_report *report = &trial->bake->report;

	return 1e-6 * (double)(trial->mode == COMPOSITOR_EXACT ? report->exact_bytes
							       : report->shown_bytes);
}

static void describe_use(struct report *r)
{
	const struct report_trial *used = &r->trial[0];
	const struct basis_info_chunk *info = &used->bake->basis.info;
	const double noise = r->bake_noise * r->bake_noise;
	const double rms = r->trial[0].truth.all.rms, other = rms * rms - noise;
	const long mirrored = basis_pose_mirrored(&used->bake->basis.poses[0]);

	report_paragraph(
		r->page.body,
		"In use: %u lights (frequency %u) read as means over their cells, no threshold, "
		"fast mode, columns cut at %.2g, one thread. It declares an RMS error of %.2g "
		"levels under skies and %.2g under single cells.",
		info->lights, info->dome_frequency, info->column_cut, info->sky_rms,
		info->cell_rms);
	report_paragraph(
		r->page.body,
		"It costs %.3g ms (quartiles %.3g to %.3g) a frame of %u x %u pixels, %.0f ns for "
		"each pixel that the object changes, and %.3g MB of memory. It is off from "
		"path-traced truth by an RMS of %.3g levels over what the object changes.",
		used->ms.median, used->ms.low, used->ms.high, info->width, info->height,
		1e6 * used->ms.median / (double)(r->scope.objects + r->scope.shadows),
		basis_mb(used), rms);
	if (mirrored)
		report_paragraph(
			r->page.body,
			"In %.0f %% of its pixels the object mirrors the fisheye's picture.",
			100.0 * (double)mirrored / (double)r->scope.objects);
	report_paragraph(
		r->page.body,
		"Of that error %.2g levels are noise of %d samples a pixel. Noise falls with the "
		"root of the samples, and adds to the rest of the error by squares: with %.0f "
		"samples it is as large as the rest.",
		r->bake_noise, used->bake->settings.samples,
		ceil(used->bake->settings.samples * noise / fmax(other, 0.01 * rms * rms)));
}

static void add_error_columns(struct table *t)
{
	table_column(t, "truth_rms_levels", "RMS", "to truth");
	table_column(t, "truth_psnr_db", NULL, NULL);
	table_column(t, "truth_max_levels", "largest", "levels");
	table_column(t, "truth_contrast_percent", "shadow", "%");
	table_column(t, "double_rms_levels", "RMS", "to double");
	table_column(t, "double_psnr_db", NULL, NULL);
	table_column(t, "double_max_levels", "largest", "levels");
	table_column(t, "double_contrast_percent", NULL, NULL);
}

static void add_error_cells(struct table *t, const struct composite_error *truth,
			    const struct composite_error *precise)
{
	const struct composite_error *const errors[] = {truth, precise};

	for (int k = 0; k < 2; k++) {
		table_number(t, errors[k]->rms);
		table_number(t, errors[k]->psnr_db);
		table_number(t, errors[k]->max);
		table_number(t, 100 * errors[k]->contrast);
	}
}

static int show_surroundings(struct report *r)
{
	struct table t;

	table_begin(&t, "surroundings");
	table_column(&t, "surrounding", "surrounding", NULL);
	add_error_columns(&t);
	table_column(&t, "truth_noise_levels", "noise", "of truth");
	table_column(&t, "bake_noise_levels", "noise", "of the bake");
	for (int l = 0; l < r->stage.lightings; l++) {
		const struct report_lighting *lighting = &r->stage.lighting[l];

		table_text(&t, "%s", lighting->name);
		add_error_cells(&t, &r->trial[0].truth.each[l], &r->trial[0].precise.each[l]);
		table_number(&t, lighting->truth_noise);
		table_number(&t, lighting->bake_noise);
	}
	return report_page_table(&r->page, &t, r->fault);
}

/* ---- all ways ---- */

/* Returns the difference of errors that noise hides, in levels. The noise e of truth and bake, one
 * number a pixel, leaves the square of an error over all pixels uncertain by
 *     2 e rms / sqrt(pixels)
 * and so the difference of two by twice that. */
static double hidden_levels(const struct report *r)
{
	const double pixels = (double)(r->scope.objects + r->scope.shadows) * r->stage.lightings;

	return sqrt(4 * hypot(r->truth_noise, r->bake_noise) * r->trial[0].truth.all.rms /
		    sqrt(pixels));
}

static void add_row(const struct report *r, const struct report_trial *trial, bool front,
		    struct table *t)
{
	const struct report_bake *bake = trial->bake;
	const struct basis_info_chunk *info = &bake->basis.info;

	table_text(t, "%s", trial->name);
	table_number(t, info->lights);
	table_number(t, bake->settings.frequency);
	table_text(t, "%s", trial->mode == COMPOSITOR_EXACT ? "exact" : "fast");
	table_number(t, bake->seconds);
	table_number(t, basis_mb(trial));
	table_number(t, trial->ms.median);
	table_number(t, trial->ms.low);
	table_number(t, trial->ms.high);
	table_number(t, trial->read_mb);
	table_number(t, trial->used_percent);
	add_error_cells(t, &trial->truth.all, &trial->precise.all);
	table_number(t, info->sky_rms);
	table_number(t, info->cell_rms);
	for (int l = 0; l < r->stage.lightings; l++) {
		table_number(t, trial->truth.each[l].rms);
		table_number(t, trial->precise.each[l].rms);
	}
	table_number(t, hidden_levels(r));
	table_text(t, "%s", front ? "yes" : "");
	if (trial == r->trial)
		table_mark(t);
}

static int show_settings(struct report *r, const bool *front)
{
	struct table t;

	table_begin(&t, "settings");
	table_column(&t, "setting", "setting", NULL);
	table_column(&t, "lights", "lights", NULL);
	table_column(&t, "frequency", NULL, NULL);
	table_column(&t, "way", NULL, NULL);
	table_column(&t, "bake_s", "bake", "processor s");
	table_column(&t, "basis_mb", "basis", "MB");
	table_column(&t, "median_ms", "time", "ms");
	table_column(&t, "low_ms", "1st quartile", "ms");
	table_column(&t, "high_ms", "3rd", "ms");
	table_column(&t, "read_mb", "read", "MB");
	table_column(&t, "lights_used_percent", "lights", "% used");
	add_error_columns(&t);
	table_column(&t, "declared_sky_rms", NULL, NULL);
	table_column(&t, "declared_cell_rms", NULL, NULL);
	for (int l = 0; l < r->stage.lightings; l++) {
		char key[80];

		snprintf(key, sizeof(key), "truth_rms_levels:%.60s", r->stage.lighting[l].name);
		table_column(&t, key, NULL, NULL);
		snprintf(key, sizeof(key), "double_rms_levels:%.60s", r->stage.lighting[l].name);
		table_column(&t, key, NULL, NULL);
	}
	table_column(&t, "noise_levels", NULL, NULL);
	table_column(&t, "front", "Pareto front", NULL);
	for (int k = 0; k < r->trials; k++)
		add_row(r, &r->trial[k], front[k], &t);
	return report_page_table(&r->page, &t, r->fault);
}

/* ---- pictures ---- */

#define PANELS 3
#define GAP 4  /* pixels between them */
#define GAIN 8 /* factor of the difference */

static uint8_t level_code(double level)
{
	return (uint8_t)lround(fmin(fmax(level, 0), 255));
}

/* Shows the composite, the truth, and their difference about a middle grey, side by side. */
static int show_picture(struct report *r, int lighting, struct image *out)
{
	const struct report_lighting *l = &r->stage.lighting[lighting];
	const int width = r->stage.width;
	char name[128], caption[256];

	memset(out->u8, 255, 3 * (size_t)out->width * (size_t)out->height);
	for (int y = 0; y < r->stage.height; y++) {
		for (int x = 0; x < width; x++) {
			const uint8_t *is = l->composite.pixels + (size_t)y * l->composite.stride +
					    (size_t)x * 4;
			const double *was = l->truth + 3 * ((size_t)y * (size_t)width + (size_t)x);
			uint8_t *to = out->u8 + 3 * ((size_t)y * (size_t)out->width + (size_t)x);

			for (int c = 0; c < 3; c++) {
				to[c] = is[2 - c];
				to[3 * (width + GAP) + c] = level_code(was[c]);
				to[6 * (width + GAP) + c] =
					level_code(128 + GAIN * (is[2 - c] - was[c]));
			}
		}
	}
	snprintf(name, sizeof(name), "picture-%d", lighting + 1);
	snprintf(
		caption, sizeof(caption),
		"%s: the setting in use, path-traced truth, and %d times their difference (grey: none).",
		l->name, GAIN);
	return report_page_picture(&r->page, name, out, caption, r->fault);
}

static int show_pictures(struct report *r)
{
	struct image out = {.width = 0};
	int err = image_create_u8(&out, PANELS * r->stage.width + (PANELS - 1) * GAP,
				  r->stage.height);

	if (err)
		return fault_say(r->fault, err, "not enough memory for a picture");
	for (int l = 0; !err && l < r->stage.lightings; l++)
		err = show_picture(r, l, &out);
	image_free(&out);
	return err;
}

/* ---- how it was measured ---- */

static void show_method(struct report *r)
{
	const struct report_stage *stage = &r->stage;
	const double waited = stage->timed_ns > stage->ran_ns
				      ? 100 - 100 * (double)stage->ran_ns / (double)stage->timed_ns
				      : 0;

	report_heading(r->page.body, "How was it measured?");
	report_paragraph(
		r->page.body,
		"inlay-bake %s, kernel %s. Pictures of %d x %d pixels; %ld of them changed by the object, of which %ld show shadow alone.%s%s%s",
		INLAY_VERSION, kernels_choose(NULL)->name, stage->width, stage->height,
		r->scope.objects + r->scope.shadows, r->scope.shadows,
		r->settings->pose ? " Pose: " : "", r->settings->pose ? r->settings->pose : "",
		r->settings->pose ? "." : "");
	report_paragraph(
		r->page.body,
		"Times are medians of %d frames under each surrounding, with their quartiles. All "
		"ways take turns, each after frames that do not count, with one thread: a time is "
		"that which it had of the processor (%.0f %% of the time it had to wait for it). "
		"Times whose quartiles overlap, or whose medians are within 5 %%, count as equal.",
		stage->repeat, waited);
	report_paragraph(
		r->page.body,
		"Errors are in 8-bit sRGB levels over the pixels that the object changes, in all "
		"surroundings; shadow is the mean error of the shadow's ratio, weighted by the "
		"light behind it. Double precision is of the exact layer with all lights, read as "
		"means over their cells, and not rounded: 8 bits alone are 0.29 levels. Truth is path traced without lights, basis "
		"or compositor, %d samples a pixel in two halves, whose difference tells its "
		"noise, %.2g levels, of which RMS is free. Errors count as equal if their squares "
		"differ by no more than the square of %.2g levels, which that noise and the bake's "
		"leave uncertain; the bake's is measured between two bakes with different random "
		"numbers.",
		r->truth_samples, r->truth_noise, hidden_levels(r));
	report_paragraph(
		r->page.body,
		"Frequency is a key of [dome] in the scene file; error, cell_error, samples and "
		"column_cut are of its [render]. In the kiosk's configuration threshold and "
		"threshold_mode are keys of [lights].");
}

int report_show(struct report *r)
{
	struct report_result result[REPORT_TRIALS_MAX];
	bool front[REPORT_TRIALS_MAX];
	int err;

	for (int k = 0; k < r->trials; k++)
		result[k] = report_result_of(&r->trial[k]);
	for (int k = 0; k < r->trials; k++)
		front[k] = report_is_front(result, r->trials, k, hidden_levels(r));
	describe_use(r);
	err = show_surroundings(r);
	if (!err)
		err = show_pictures(r);
	report_heading(r->page.body, "What do other settings cost and bring?");
	report_paragraph(
		r->page.body,
		"Of those on the Pareto front no other is faster and as near to the truth, or nearer and as fast; as fast and as near is what noise and spread cannot tell apart.");
	if (!err)
		err = show_settings(r, front);
	show_method(r);
	return err;
}
