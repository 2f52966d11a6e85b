/* SPDX-License-Identifier: MIT */
/* Tables of a report: filled cell by cell, written as CSV with 7 digits and into the page
 * rounded. */
#ifndef INLAY_BAKE_BASE_REPORT_TABLE_H
#define INLAY_BAKE_BASE_REPORT_TABLE_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/base/fault.h"

#define REPORT_COLUMNS_MAX 64

struct report_column {
	char key[80];	  /* name in the CSV, with the unit: median_ms */
	char heading[64]; /* heading in the page; empty: the column is in the CSV alone */
	char unit[16];
};

struct report_cell {
	char *text; /* NULL: a number */
	double number;
};

struct report_table {
	const char *name; /* of its file, NAME.csv */
	struct report_column column[REPORT_COLUMNS_MAX];
	int columns;
	struct report_cell *cell; /* [cells], row by row */
	int cells, room;
	int marked; /* row of the setting in use; -1: none */
	int err;    /* the first error; later calls do nothing */
};

void report_table_begin(struct report_table *table, const char *name);
void report_table_free(struct report_table *table); /* idempotent; zeroed is fine */

/* Adds a column. All columns are added before the first cell. heading and unit may be NULL. */
void report_table_column(struct report_table *table, const char *key, const char *heading,
			 const char *unit);

/* Append the next cell. NaN means "does not apply": the cell is empty. */
void report_text(struct report_table *table, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
void report_number(struct report_table *table, double value);

int report_table_rows(const struct report_table *table);

/* Marks the row of the last cell as that of the setting in use. */
void report_table_mark(struct report_table *table);

/* Writes a number as the page shows it, with about three digits; NaN and infinity give an empty
 * text. */
void report_rounded(double value, char *text, size_t room);

/* Writes FOLDER/NAME.csv. Returns the table's first error, or -errno of writing. */
int report_table_write_csv(const struct report_table *table, const char *folder,
			   struct fault *fault);
void report_table_write_html(const struct report_table *table, FILE *to);

/* Writes text with HTML's special characters escaped. */
void report_write_escaped(FILE *to, const char *text);

#endif
