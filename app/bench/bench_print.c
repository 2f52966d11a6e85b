/* SPDX-License-Identifier: MIT */
#include "app/bench/bench.h"

#include <math.h>

/* Share of the time that other programs ran above which times cannot be trusted. */
#define WAITED_MUCH 0.03

static double applies(double value)
{
	return value > 0 ? value : NAN;
}

void bench_print_begin(struct table *t)
{
	table_begin(t, "rows");
	table_column(t, "lighting", NULL, NULL);
	table_column(t, "what", "what", NULL);
	table_column(t, "kernel", "kernel", NULL);
	table_column(t, "lights", "lights", NULL);
	table_column(t, "median_ms", "median ms", NULL);
	table_column(t, "least_ms", "least ms", NULL);
	table_column(t, "speedup", "x thesis", NULL);
	table_column(t, "basis_mb", "read MB", NULL);
	table_column(t, "copies", "x copy", NULL);
	table_column(t, "psnr_db", "PSNR dB", NULL);
	table_column(t, "rms", "RMS", NULL);
	table_column(t, "max", "max", NULL);
	table_column(t, "frame_psnr_db", NULL, NULL);
	table_column(t, "contrast", "contrast", NULL);
}

void bench_print_row(struct table *t, const struct bench_row *row)
{
	const struct composite_error *e = &row->error;
	const double figures[] = {applies(row->median_ms), applies(row->least_ms),
				  applies(row->speedup), applies(row->basis_mb),
				  applies(row->copies)};
	const double errors[] = {e->psnr_db, e->rms, e->max, e->frame_psnr_db, e->contrast};

	table_text(t, "%s", row->lighting);
	table_text(t, "%s", row->what);
	table_text(t, "%s", row->kernel);
	table_number(t, row->lights >= 0 ? row->lights : NAN);
	for (size_t n = 0; n < sizeof(figures) / sizeof(*figures); n++)
		table_number(t, figures[n]);
	for (size_t n = 0; n < sizeof(errors) / sizeof(*errors); n++)
		table_number(t, row->has_error ? errors[n] : NAN);
}

void bench_print_text(const struct bench_report *r, FILE *to)
{
	fprintf(to,
		"%s: %dx%d, %d lights; %ld pixels of the object, %ld of its shadow\n"
		"fast layer %.2f MB, exact layer %.2f MB; a byte for each value would be %.2f MB\n"
		"threads: %d; repeated: %d times\n"
		"errors: against the %s layer in double precision, 8-bit levels, of the pixels that the object changes\n",
		r->basis, r->width, r->height, r->lights, r->object_pixels, r->shadow_pixels,
		r->shown_mb, r->exact_mb, r->dense_mb, r->threads, r->repeat, r->truth);
	if (r->threads == 1 && r->waited > WAITED_MUCH)
		fprintf(to,
			"the machine was busy: others had the processor in %.0f %% of the time; that is not counted, but they\n"
			"use caches and memory too, so that times are longer than on an idle machine\n",
			100 * r->waited);
	table_write_text(&r->rows, to);
}

void bench_print_json(const struct bench_report *r, FILE *to)
{
	struct json json;

	json_begin(&json, to);
	json_text(&json, "basis", r->basis);
	json_number(&json, "width", r->width);
	json_number(&json, "height", r->height);
	json_number(&json, "lights", r->lights);
	json_number(&json, "object_pixels", (double)r->object_pixels);
	json_number(&json, "shadow_pixels", (double)r->shadow_pixels);
	json_number(&json, "shown_mb", r->shown_mb);
	json_number(&json, "exact_mb", r->exact_mb);
	json_number(&json, "dense_mb", r->dense_mb);
	json_number(&json, "threads", r->threads);
	json_number(&json, "repeat", r->repeat);
	json_text(&json, "truth", r->truth);
	json_number(&json, "waited", r->waited);
	table_write_json(&r->rows, &json);
	json_end(&json);
}
