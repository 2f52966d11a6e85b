/* SPDX-License-Identifier: MIT */
#include "bake/base/report_table.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/csv.h"
#include "hal/base/output.h"

void report_table_begin(struct report_table *t, const char *name)
{
	*t = (struct report_table){.name = name, .marked = -1};
}

void report_table_free(struct report_table *t)
{
	for (int k = 0; k < t->cells; k++)
		free(t->cell[k].text);
	free(t->cell);
	*t = (struct report_table){.marked = -1};
}

void report_table_column(struct report_table *t, const char *key, const char *heading,
			 const char *unit)
{
	struct report_column *column = &t->column[t->columns];

	if (t->columns == REPORT_COLUMNS_MAX) {
		t->err = -E2BIG;
		return;
	}
	t->columns++;
	snprintf(column->key, sizeof(column->key), "%s", key);
	snprintf(column->heading, sizeof(column->heading), "%s", heading ? heading : "");
	snprintf(column->unit, sizeof(column->unit), "%s", unit ? unit : "");
}

/* Returns the next cell, or NULL after an error. */
static struct report_cell *next_cell(struct report_table *t)
{
	if (!t->err && t->cells == t->room) {
		const int room = t->room ? 2 * t->room : 64;
		struct report_cell *cell = realloc(t->cell, (size_t)room * sizeof(*cell));

		if (!cell) {
			t->err = -ENOMEM;
		} else {
			t->cell = cell;
			t->room = room;
		}
	}
	return t->err ? NULL : &t->cell[t->cells++];
}

void report_text(struct report_table *t, const char *format, ...)
{
	struct report_cell *cell = next_cell(t);
	va_list list;

	if (!cell)
		return;
	*cell = (struct report_cell){.number = NAN};
	va_start(list, format);
	if (vasprintf(&cell->text, format, list) < 0) {
		cell->text = NULL;
		t->err = -ENOMEM;
	}
	va_end(list);
}

void report_number(struct report_table *t, double value)
{
	struct report_cell *cell = next_cell(t);

	if (cell)
		*cell = (struct report_cell){.number = value};
}

int report_table_rows(const struct report_table *t)
{
	return t->columns ? t->cells / t->columns : 0;
}

void report_table_mark(struct report_table *t)
{
	if (t->cells && t->columns)
		t->marked = (t->cells - 1) / t->columns;
}

void report_rounded(double value, char *text, size_t room)
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

/* ---- CSV ---- */

static void write_csv(const struct report_table *t, FILE *to)
{
	for (int c = 0; c < t->columns; c++) {
		csv_text(to, t->column[c].key);
		fputc(c + 1 < t->columns ? ',' : '\n', to);
	}
	for (int k = 0; k < t->cells; k++) {
		const struct report_cell *cell = &t->cell[k];

		if (cell->text)
			csv_text(to, cell->text);
		else
			csv_number(to, cell->number);
		fputc((k + 1) % t->columns ? ',' : '\n', to);
	}
}

int report_table_write_csv(const struct report_table *t, const char *folder, struct fault *fault)
{
	struct output out = {.stream = NULL};
	char path[PATH_MAX];
	int err = t->err;

	if (err)
		return fault_say(fault, err, "table %s: %s", t->name, strerror(-err));
	snprintf(path, sizeof(path), "%s/%s.csv", folder, t->name);
	err = output_open(&out, path, fault);
	if (err)
		return err;
	write_csv(t, out.stream);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}

/* ---- the page ---- */

void report_write_escaped(FILE *to, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '&':
			fputs("&amp;", to);
			break;
		case '<':
			fputs("&lt;", to);
			break;
		case '>':
			fputs("&gt;", to);
			break;
		case '"':
			fputs("&quot;", to);
			break;
		default:
			fputc(*text, to);
		}
	}
}

static void write_heading(const struct report_column *column, FILE *to)
{
	fputs("<th scope=\"col\">", to);
	report_write_escaped(to, column->heading);
	if (column->unit[0]) {
		fputs("<br><span class=\"unit\">", to);
		report_write_escaped(to, column->unit);
		fputs("</span>", to);
	}
	fputs("</th>", to);
}

static void write_cell(const struct report_cell *cell, FILE *to)
{
	char number[32];

	if (cell->text) {
		fputs("<td>", to);
		report_write_escaped(to, cell->text);
	} else {
		report_rounded(cell->number, number, sizeof(number));
		fprintf(to, "<td class=\"n\">%s", number);
	}
	fputs("</td>", to);
}

void report_table_write_html(const struct report_table *t, FILE *to)
{
	const int rows = report_table_rows(t);

	fprintf(to, "<table id=\"%s\">\n<thead><tr>", t->name);
	for (int c = 0; c < t->columns; c++)
		if (t->column[c].heading[0])
			write_heading(&t->column[c], to);
	fputs("</tr></thead>\n<tbody>\n", to);
	for (int r = 0; r < rows; r++) {
		fputs(r == t->marked ? "<tr class=\"used\">" : "<tr>", to);
		for (int c = 0; c < t->columns; c++)
			if (t->column[c].heading[0])
				write_cell(&t->cell[r * t->columns + c], to);
		fputs("</tr>\n", to);
	}
	fputs("</tbody>\n</table>\n", to);
	fprintf(to, "<p class=\"source\"><a href=\"%s.csv\">%s.csv</a>%s</p>\n", t->name, t->name,
		t->marked >= 0 ? "; the setting in use is shaded" : "");
}
