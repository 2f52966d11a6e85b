/* SPDX-License-Identifier: MIT */
#include "hal/base/table.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void table_begin(struct table *t, const char *name)
{
	*t = (struct table){.name = name, .marked = -1};
}

void table_free(struct table *t)
{
	for (int k = 0; k < t->cells; k++)
		free(t->cell[k].text);
	free(t->cell);
	*t = (struct table){.marked = -1};
}

void table_column(struct table *t, const char *key, const char *heading, const char *unit)
{
	struct table_column *column = &t->column[t->columns];

	if (t->columns == TABLE_COLUMNS_MAX) {
		t->err = -E2BIG;
		return;
	}
	t->columns++;
	snprintf(column->key, sizeof(column->key), "%s", key);
	snprintf(column->heading, sizeof(column->heading), "%s", heading ? heading : "");
	snprintf(column->unit, sizeof(column->unit), "%s", unit ? unit : "");
}

/* Returns the next cell, or NULL after an error. */
static struct table_cell *next_cell(struct table *t)
{
	if (!t->err && t->cells == t->room) {
		const int room = t->room ? 2 * t->room : 64;
		struct table_cell *cell = realloc(t->cell, (size_t)room * sizeof(*cell));

		if (!cell) {
			t->err = -ENOMEM;
		} else {
			t->cell = cell;
			t->room = room;
		}
	}
	return t->err ? NULL : &t->cell[t->cells++];
}

void table_text(struct table *t, const char *format, ...)
{
	struct table_cell *cell = next_cell(t);
	va_list list;

	if (!cell)
		return;
	*cell = (struct table_cell){.number = NAN};
	va_start(list, format);
	if (vasprintf(&cell->text, format, list) < 0) {
		cell->text = NULL;
		t->err = -ENOMEM;
	}
	va_end(list);
}

void table_number(struct table *t, double value)
{
	struct table_cell *cell = next_cell(t);

	if (cell)
		*cell = (struct table_cell){.number = value};
}

int table_rows(const struct table *t)
{
	return t->columns ? t->cells / t->columns : 0;
}

void table_mark(struct table *t)
{
	if (t->cells && t->columns)
		t->marked = (t->cells - 1) / t->columns;
}

void table_rounded(double value, char *text, size_t room)
{
	const double size = fabs(value);

	if (!isfinite(value))
		snprintf(text, room, "%s", "");
	else if (size >= 99.5 || (size < 1e6 && value == rint(value)))
		snprintf(text, room, "%.0f", value);
	else if (size >= 9.995)
		snprintf(text, room, "%.1f", value);
	else if (size >= 0.9995)
		snprintf(text, room, "%.2f", value);
	else
		snprintf(text, room, size >= 0.0995 ? "%.3f" : "%.2g", value);
}

/* ---- for programs ---- */

/* Quotes a text that holds a comma, a quote or a line end. */
static void write_field(FILE *to, const char *text)
{
	const char *quote = strpbrk(text, ",\"\n\r") ? "\"" : "";

	fputs(quote, to);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', to);
		fputc(*text, to);
	}
	fputs(quote, to);
}

void table_write_csv(const struct table *t, FILE *to)
{
	for (int c = 0; c < t->columns; c++) {
		write_field(to, t->column[c].key);
		fputc(c + 1 < t->columns ? ',' : '\n', to);
	}
	for (int k = 0; k < t->cells; k++) {
		const struct table_cell *cell = &t->cell[k];

		if (cell->text)
			write_field(to, cell->text);
		else if (isfinite(cell->number))
			fprintf(to, "%.7g", cell->number);
		fputc((k + 1) % t->columns ? ',' : '\n', to);
	}
}

void table_write_json(const struct table *t, struct json *json)
{
	json_array(json, t->name);
	for (int k = 0; k < t->cells; k++) {
		const char *key = t->column[k % t->columns].key;

		if (k % t->columns == 0)
			json_object_line(json, NULL);
		if (t->cell[k].text)
			json_text(json, key, t->cell[k].text);
		else
			json_number(json, key, t->cell[k].number);
		if ((k + 1) % t->columns == 0)
			json_end(json);
	}
	json_end(json);
}

/* ---- for people ---- */

/* The text of a cell in a row, or of its column's heading in row -1. */
static const char *shown_text(const struct table *t, int row, int c, char number[32])
{
	const struct table_cell *cell;

	if (row < 0)
		return t->column[c].heading;
	cell = &t->cell[row * t->columns + c];
	if (cell->text)
		return cell->text;
	table_rounded(cell->number, number, 32);
	return *number ? number : "-";
}

static void write_line(const struct table *t, int row, const int *width, FILE *to)
{
	const char *between = "";
	char number[32];

	for (int c = 0; c < t->columns; c++) {
		if (!t->column[c].heading[0])
			continue;
		fprintf(to, "%s%*s", between, t->cell[c].text ? -width[c] : width[c],
			shown_text(t, row, c, number));
		between = "  ";
	}
	fputc('\n', to);
}

void table_write_text(const struct table *t, FILE *to)
{
	const bool grouped = !t->column[0].heading[0];
	int width[TABLE_COLUMNS_MAX] = {0};
	char number[32];

	for (int row = -1; row < table_rows(t); row++)
		for (int c = 0; c < t->columns; c++)
			width[c] = (int)fmax(width[c],
					     (double)strlen(shown_text(t, row, c, number)));
	for (int row = 0; row < table_rows(t); row++) {
		const struct table_cell *first = &t->cell[row * t->columns];
		const bool begins = !row ||
				    (grouped && strcmp(first->text, first[-t->columns].text) != 0);

		if (grouped && begins)
			fprintf(to, "\n%s\n", first->text);
		if (begins)
			write_line(t, -1, width, to);
		write_line(t, row, width, to);
	}
}
