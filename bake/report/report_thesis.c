/* SPDX-License-Identifier: MIT */
/* The thesis's own measurements, made again: its table 4.1 and its threshold (section 4.2.2). */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"

/* The thesis's screen of 720 x 486 pixels shows four pictures of this size. */
#define WIDTH 360
#define HEIGHT 243

/* The thesis's table 4.1, with every light used, on six processors of 195 MHz. frequency: of the
 * dome with as many lights, or nearly. */
static const struct {
	int lights;
	double mb;
	int threads;
	double seconds;
	int frequency;
} table41[] = {
	{6, 0.61, 1, 0.09, 1}, {25, 4.9, 3, 0.2, 2},  {88, 37, 8, 0.33, 4},
	{191, 77, 7, 0.55, 6}, {406, 200, 9, 1.3, 9},
};

#define ROWS ((int)(sizeof(table41) / sizeof(*table41)))

/* About 180 of the thesis's 406 lights reached its threshold, and 1.3 s became about 0.4 s. */
#define THRESHOLD_LIGHTS 180
#define THRESHOLD_SECONDS 0.4

enum { THESIS_ONE, THESIS_MORE, FAST_ONE, FAST_MORE, COLUMNS };

struct thesis_rerun {
	struct report *report;
	struct scene *scene;
	struct report_stage stage; /* one lighting; the pool is the report's */
	struct render_settings settings;
	struct report_table table;
	struct report_table threshold;
};

int report_thesis_bakes(void)
{
	return ROWS;
}

static int threads_of(const struct thesis_rerun *a, int row)
{
	const int most = a->report->threads;

	return table41[row].threads < most ? table41[row].threads : most;
}

static void fill_thesis_row(struct thesis_rerun *a, int row, const struct report_bake *bake,
			    const struct report_trial *trial)
{
	struct report_table *t = &a->table;

	report_number(t, table41[row].lights);
	report_number(t, table41[row].mb);
	report_number(t, table41[row].threads);
	report_number(t, 1000 * table41[row].seconds);
	report_number(t, bake->basis.info.lights);
	report_number(t, trial[THESIS_ONE].read_mb);
	report_number(t, trial[THESIS_ONE].ms.median);
	report_number(t, threads_of(a, row));
	report_number(t, trial[THESIS_MORE].ms.median);
	report_number(t, bake->shown_mb);
	report_number(t, trial[FAST_ONE].ms.median);
	report_number(t, trial[FAST_MORE].ms.median);
	report_number(t, trial[THESIS_ONE].ms.median / trial[FAST_ONE].ms.median);
}

static int try_row(struct thesis_rerun *a, int row, struct report_bake *bake)
{
	struct report_trial trial[COLUMNS] = {{.read_mb = 0}};
	int err;

	for (int k = 0; k < COLUMNS; k++) {
		trial[k].way = report_way_plain(bake);
		trial[k].way.thesis = k == THESIS_ONE || k == THESIS_MORE;
		trial[k].way.threads = k == THESIS_MORE || k == FAST_MORE ? threads_of(a, row) : 1;
	}
	err = report_trials_run(trial, COLUMNS, &a->stage, NULL, a->report->fault);
	if (!err)
		fill_thesis_row(a, row, bake, trial);
	return err;
}

/* ---- the threshold ---- */

static int float_descending(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x < y) - (x > y);
}

/* Finds the threshold that THRESHOLD_LIGHTS lights reach: the brightest channel of the last of
 * them. */
static int find_threshold(struct thesis_rerun *a, struct report_bake *bake, double *threshold)
{
	const int lights = (int)bake->basis.info.lights;
	const float(*radiance)[3] = report_bake_radiance(bake, &a->stage, INPUT_CELL, 0,
							 a->report->fault);
	float *peak = radiance ? malloc((size_t)lights * sizeof(*peak)) : NULL;

	if (!peak)
		return radiance ? fault_say(a->report->fault, -ENOMEM, "not enough memory") : -EIO;
	for (int i = 0; i < lights; i++) {
		peak[i] = 0;
		for (int c = 0; c < 3; c++)
			peak[i] = radiance[i][c] > peak[i] ? radiance[i][c] : peak[i];
	}
	qsort(peak, (size_t)lights, sizeof(*peak), float_descending);
	*threshold = (double)peak[THRESHOLD_LIGHTS - 1];
	free(peak);
	return 0;
}

/* Cases: the thesis's algorithm or ours, with all lights or the brightest, the light of others
 * dropped or given back. */
static const struct {
	const char *name;
	bool thesis, all;
	enum threshold_mode mode;
	double seconds; /* in the thesis; 0: not given */
} cases[] = {
	{"thesis's algorithm, all lights", true, true, THRESHOLD_DROP, 1.3},
	{"thesis's algorithm, threshold", true, false, THRESHOLD_DROP, THRESHOLD_SECONDS},
	{"fast, all lights", false, true, THRESHOLD_DROP, 0},
	{"fast, threshold, dropped", false, false, THRESHOLD_DROP, 0},
	{"fast, threshold, given back", false, false, THRESHOLD_AMBIENT, 0},
};

#define CASES ((int)(sizeof(cases) / sizeof(*cases)))

static int try_threshold(struct thesis_rerun *a, struct report_bake *bake)
{
	struct report_trial trial[CASES] = {{.read_mb = 0}};
	struct report_table *t = &a->threshold;
	struct scope scope;
	double threshold = 0;
	int err = find_threshold(a, bake, &threshold);

	if (err)
		return err;
	if (scope_create(&scope, &bake->basis, report_bake_layer(bake)))
		return fault_say(a->report->fault, -ENOMEM, "not enough memory");
	for (int k = 0; k < CASES; k++) {
		trial[k].way = report_way_plain(bake);
		trial[k].way.thesis = cases[k].thesis;
		trial[k].way.threshold = cases[k].all ? 0 : threshold;
		trial[k].way.threshold_mode = cases[k].mode;
	}
	err = report_trials_run(trial, CASES, &a->stage, &scope, a->report->fault);
	scope_free(&scope);
	for (int k = 0; !err && k < CASES; k++) {
		const struct composite_error *error = &trial[k].precise.all;

		report_text(t, "%s", cases[k].name);
		report_number(t, cases[k].seconds > 0 ? 1000 * cases[k].seconds : NAN);
		report_number(t, trial[k].lights[0]);
		report_number(t, trial[k].ms.median);
		report_number(t,
			      100 * trial[k].ms.median / trial[cases[k].thesis ? 0 : 2].ms.median);
		/* the thesis's errors would be against its own choice of lights */
		report_number(t, cases[k].thesis ? NAN : error->rms);
		report_number(t, cases[k].thesis ? NAN : error->psnr_db);
		report_number(t, cases[k].thesis ? NAN : error->max);
	}
	return err;
}

/* ---- all of it ---- */

static void add_columns(struct thesis_rerun *a)
{
	struct report_table *t = &a->table;

	report_table_begin(t, "thesis-table");
	report_table_column(t, "thesis_lights", "thesis: lights", NULL);
	report_table_column(t, "thesis_mb", "data", "MB");
	report_table_column(t, "thesis_threads", "threads", NULL);
	report_table_column(t, "thesis_ms", "time", "ms");
	report_table_column(t, "lights", "here: lights", NULL);
	report_table_column(t, "algorithm_mb", "its data", "MB");
	report_table_column(t, "algorithm_ms", "its way", "ms, 1 thread");
	report_table_column(t, "threads", "threads", NULL);
	report_table_column(t, "algorithm_threads_ms", "its way", "ms, threads");
	report_table_column(t, "fast_mb", "fast basis", "MB");
	report_table_column(t, "fast_ms", "fast", "ms, 1 thread");
	report_table_column(t, "fast_threads_ms", "fast", "ms, threads");
	report_table_column(t, "speedup", "its way / fast", "1 thread");
	t = &a->threshold;
	report_table_begin(t, "thesis-threshold");
	report_table_column(t, "way", "way", NULL);
	report_table_column(t, "thesis_ms", "in the thesis", "ms");
	report_table_column(t, "lights_used", "lights used", NULL);
	report_table_column(t, "median_ms", "here", "ms");
	report_table_column(t, "percent_of_all", "of all lights", "%");
	report_table_column(t, "double_rms_levels", "RMS", "levels");
	report_table_column(t, "double_psnr_db", "PSNR", "dB");
	report_table_column(t, "double_max_levels", "largest", "levels");
}

static int measure_rows(struct thesis_rerun *a)
{
	struct report *r = a->report;
	int err = 0;

	for (int k = 0; !err && k < ROWS; k++) {
		struct report_bake bake = {.exact = false};

		a->settings.frequency = table41[k].frequency;
		report_step(r, "the thesis's picture, frequency %d", a->settings.frequency);
		err = report_bake_make(&bake, a->scene, &a->settings, r->page.temporary, r->fault);
		if (!err)
			err = try_row(a, k, &bake);
		if (!err && k == ROWS - 1)
			err = try_threshold(a, &bake);
		report_bake_close(&bake);
	}
	return err;
}

static int plot_table(struct report *r, const struct report_table *t)
{
	static const struct {
		const char *name, *x, *y;
		int colour;
	} lines[] = {{"thesis", "thesis_lights", "thesis_ms", 0},
		     {"its algorithm here", "lights", "algorithm_ms", 2},
		     {"fast", "lights", "fast_ms", 1}};
	struct report_plot plot;

	report_plot_begin(&plot, "thesis-time", "number of lights", "time of a frame, ms");
	plot.x_log = plot.y_log = true;
	for (size_t k = 0; k < sizeof(lines) / sizeof(*lines); k++) {
		report_plot_series(&plot, lines[k].name, STYLE_LINE, lines[k].colour);
		for (int row = 0; row < report_table_rows(t); row++)
			report_plot_point(&plot, report_table_value(t, row, lines[k].x),
					  report_table_value(t, row, lines[k].y));
	}
	return report_page_plot(&r->page, r->page.body, &plot,
				"Table 4.1: the thesis's own times with 1 to 9 threads, and this "
				"machine's with one.",
				r->fault);
}

static int show_thesis(struct thesis_rerun *a)
{
	struct report *r = a->report;
	int err;

	report_heading(r->page.body, "What has become of the thesis's figures?");
	report_paragraph(
		r->page.body,
		"Its table 4.1 (every light used; six processors of 195 MHz) beside the same "
		"algorithm and ours on this machine, at %d x %d pixels%s, under \"%s\". Its "
		"data are a byte for each light, pixel and channel, two in shadow; it lists "
		"25, 88 and 191 lights where rounding decided which lie on the horizon. Its "
		"times include taking the video.",
		a->stage.width, a->stage.height,
		r->settings->quick ? " (a quarter of its picture's sides)" : ", its picture's",
		a->stage.lighting[0].name);
	err = plot_table(r, &a->table);
	if (!err)
		err = report_page_table(&r->page, r->page.body, &a->table, r->fault);
	report_paragraph(r->page.body,
			 "Its threshold experiment: 406 lights, of which about %d reach the "
			 "threshold; the threshold here is what as many reach. Errors are against "
			 "double precision with every light.",
			 THRESHOLD_LIGHTS);
	return err ? err : report_page_table(&r->page, r->page.body, &a->threshold, r->fault);
}

static int open_thesis_stage(struct thesis_rerun *a)
{
	struct report *r = a->report;
	const struct report_settings *s = r->settings;
	const struct report_lighting_settings lighting = {
		.path = s->panorama[0],
		.made = 2,
		.fisheye_side = r->stage.lighting[0].fisheye.width};
	const int share = s->quick ? 4 : 1;
	int err = scene_open(&a->scene, s->input, WIDTH / share, HEIGHT / share, r->fault);

	if (!err)
		err = scene_find_pose(a->scene, s->pose, r->fault);
	if (err)
		return err;
	a->stage = (struct report_stage){.width = WIDTH / share,
					 .height = HEIGHT / share,
					 .all = r->stage.all,
					 .repeat = r->stage.repeat};
	a->stage.lightings = 1;
	return report_lighting_open(&a->stage.lighting[0], a->scene, a->stage.width,
				    a->stage.height, &lighting, r->fault);
}

int report_thesis(struct report *r)
{
	struct thesis_rerun a = {.report = r, .settings = r->used->settings};
	int err;

	if (!r->scene)
		return 0;
	a.settings.exact = true;
	a.settings.fine = NULL; /* the thesis's domes are whole */
	/* noise does not matter for time */
	a.settings.samples = a.settings.samples / 2 + 1;
	add_columns(&a);
	err = open_thesis_stage(&a);
	if (!err)
		err = measure_rows(&a);
	if (!err)
		err = show_thesis(&a);
	report_table_free(&a.table);
	report_table_free(&a.threshold);
	report_lighting_close(&a.stage.lighting[0]);
	scene_close(a.scene);
	return err;
}
