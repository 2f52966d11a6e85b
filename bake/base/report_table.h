/* SPDX-License-Identifier: MIT */
/* Tables of a report: filled cell by cell, written as CSV whole and into the page rounded. */
#ifndef INLAY_BAKE_BASE_REPORT_TABLE_H
#define INLAY_BAKE_BASE_REPORT_TABLE_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/base/fault.h"

#define REPORT_COLUMNS_MAX 64

struct report_column {
	char key[80];	  /* in the CSV, unit included: median_ms */
	char heading[64]; /* in the page; empty: in the CSV alone */
	char unit[16];
};

struct report_cell {
	char *text; /* NULL: a number */
	double number;
};

struct report_table {
	const char *name; /* of its files: NAME.csv */
	struct report_column column[REPORT_COLUMNS_MAX];
	int columns;
	struct report_cell *cell; /* [cells], row by row */
	int cells, room;
	int marked; /* row of the setting in use; -1: none */
	int err;    /* the first that failed; the rest does nothing */
};

void report_table_begin(struct report_table *table, const char *name);
void report_table_free(struct report_table *table); /* idempotent; zeroed is fine */

/* All columns come before the first cell. heading and unit may be NULL. */
void report_table_column(struct report_table *table, const char *key, const char *heading,
			 const char *unit);

/* The next cell. NaN: does not apply, and is empty. */
void report_text(struct report_table *table, const char *format, ...)
	__attribute__((format(printf, 2, 3)));
void report_number(struct report_table *table, double value);

int report_table_rows(const struct report_table *table);

/* The cell of a row; NaN for texts. */
double report_table_value(const struct report_table *table, int row, const char *key);

/* The row that is being filled, or was last, is the setting in use. */
void report_table_mark(struct report_table *table);

/* What a reader needs of a number, three digits or so: as the page shows it. */
void report_rounded(double value, char *text, size_t room);

/* -ENOMEM if a cell could not be kept; what writing gives. */
int report_table_write_csv(const struct report_table *table, const char *folder,
			   struct fault *fault);
void report_table_write_html(const struct report_table *table, FILE *to);

/* Text as HTML has it. */
void report_write_escaped(FILE *to, const char *text);

#endif
