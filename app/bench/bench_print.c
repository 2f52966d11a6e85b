/* SPDX-License-Identifier: MIT */
#include "app/bench/bench_print.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "hal/base/csv.h"
#include "hal/base/json.h"

/* Share of the time that other programs ran above which times cannot be trusted. */
#define WAITED_MUCH 0.03

/* A column of the table; key names it in JSON and CSV. */
struct column {
	const char *key;
	const char *title; /* NULL: not in the table */
	int width;
	int digits; /* digits behind the point in the table */
	enum { OF_TEXT, OF_COUNT, OF_NUMBER, OF_ERROR } kind;
	size_t at; /* offset in struct bench_row */
};

#define ROW_AT(field) offsetof(struct bench_row, field)

static const struct column columns[] = {
	{"lighting", NULL, 0, 0, OF_TEXT, ROW_AT(lighting)},
	{"what", "what", -36, 0, OF_TEXT, ROW_AT(what)},
	{"kernel", "kernel", -12, 0, OF_TEXT, ROW_AT(kernel)},
	{"lights", "lights", 6, 0, OF_COUNT, ROW_AT(lights)},
	{"median_ms", "median ms", 10, 3, OF_NUMBER, ROW_AT(median_ms)},
	{"least_ms", "least ms", 10, 3, OF_NUMBER, ROW_AT(least_ms)},
	{"speedup", "x thesis", 9, 1, OF_NUMBER, ROW_AT(speedup)},
	{"basis_mb", "read MB", 9, 2, OF_NUMBER, ROW_AT(basis_mb)},
	{"copies", "x copy", 7, 1, OF_NUMBER, ROW_AT(copies)},
	{"psnr_db", "PSNR dB", 8, 1, OF_ERROR, ROW_AT(error.psnr_db)},
	{"rms", "RMS", 6, 2, OF_ERROR, ROW_AT(error.rms)},
	{"max", "max", 6, 1, OF_ERROR, ROW_AT(error.max)},
	{"frame_psnr_db", NULL, 0, 0, OF_ERROR, ROW_AT(error.frame_psnr_db)},
	{"contrast", "contrast", 9, 4, OF_ERROR, ROW_AT(error.contrast)},
};

#define COLUMN_COUNT (sizeof(columns) / sizeof(*columns))

/* Returns NaN where the figure does not apply. */
static double field_number(const struct bench_row *row, const struct column *column)
{
	const char *at = (const char *)row + column->at;
	double value;

	if (column->kind == OF_COUNT) {
		int count;

		memcpy(&count, at, sizeof(count));
		return count < 0 ? NAN : count;
	}
	memcpy(&value, at, sizeof(value));
	if (column->kind == OF_ERROR)
		return row->has_error ? value : NAN;
	return value > 0 ? value : NAN;
}

static const char *text_of(const struct bench_row *row, const struct column *column)
{
	return (const char *)row + column->at;
}

/* ---- for people ---- */

static void print_titles(FILE *to)
{
	for (size_t k = 0; k < COLUMN_COUNT; k++) {
		if (columns[k].title)
			fprintf(to, "%s%*s", k > 1 ? " " : "", columns[k].width, columns[k].title);
	}
	fputc('\n', to);
}

static void print_report_row(const struct bench_row *row, FILE *to)
{
	for (size_t k = 0; k < COLUMN_COUNT; k++) {
		const struct column *c = &columns[k];

		if (!c->title)
			continue;
		if (k > 1)
			fputc(' ', to);
		if (c->kind == OF_TEXT)
			fprintf(to, "%*s", c->width, text_of(row, c));
		else if (isnan(field_number(row, c)))
			fprintf(to, "%*s", c->width, "-");
		else
			fprintf(to, "%*.*f", c->width, c->digits, field_number(row, c));
	}
	fputc('\n', to);
}

void bench_print_table(const struct bench_report *r, FILE *to)
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
	for (int k = 0; k < r->count; k++) {
		if (!k || strcmp(r->row[k].lighting, r->row[k - 1].lighting) != 0) {
			fprintf(to, "\n%s\n", r->row[k].lighting);
			print_titles(to);
		}
		print_report_row(&r->row[k], to);
	}
}

/* ---- for programs ---- */

static void write_json_row(struct json *json, const struct bench_row *row)
{
	json_object_line(json, NULL);
	for (size_t k = 0; k < COLUMN_COUNT; k++) {
		const struct column *c = &columns[k];

		if (c->kind == OF_TEXT)
			json_text(json, c->key, text_of(row, c));
		else
			json_number(json, c->key, field_number(row, c));
	}
	json_end(json);
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
	json_array(&json, "rows");
	for (int k = 0; k < r->count; k++)
		write_json_row(&json, &r->row[k]);
	json_end(&json);
	json_end(&json);
}

void bench_print_csv(const struct bench_report *r, FILE *to)
{
	for (size_t k = 0; k < COLUMN_COUNT; k++)
		fprintf(to, "%s%s", k ? "," : "", columns[k].key);
	fputc('\n', to);
	for (int n = 0; n < r->count; n++) {
		for (size_t k = 0; k < COLUMN_COUNT; k++) {
			const struct column *c = &columns[k];

			if (k)
				fputc(',', to);
			if (c->kind == OF_TEXT)
				csv_text(to, text_of(&r->row[n], c));
			else
				csv_number(to, field_number(&r->row[n], c));
		}
		fputc('\n', to);
	}
}
