/* SPDX-License-Identifier: MIT */
/* Tables: filled cell by cell; written as CSV (RFC 4180), as JSON, and rounded for people. */
#ifndef INLAY_HAL_BASE_TABLE_H
#define INLAY_HAL_BASE_TABLE_H

#include <stdbool.h>
#include <stdio.h>

#include "hal/base/json.h"

#define TABLE_COLUMNS_MAX 64

struct table_column {
	char key[80];	  /* name in CSV and JSON, with the unit: median_ms */
	char heading[64]; /* for people; empty: the column is for programs alone */
	char unit[16];
};

struct table_cell {
	char *text; /* NULL: a number */
	double number;
};

struct table {
	const char *name;
	struct table_column column[TABLE_COLUMNS_MAX];
	int columns;
	struct table_cell *cell; /* [cells], row by row */
	int cells, room;
	int marked; /* row of the setting in use; -1: none */
	int err;    /* the first error, -ENOMEM or -E2BIG; later calls do nothing */
};

void table_begin(struct table *table, const char *name);
void table_free(struct table *table); /* idempotent; zeroed is fine */

/* Adds a column. All columns are added before the first cell. heading and unit may be NULL. */
void table_column(struct table *table, const char *key, const char *heading, const char *unit);

/* Append the next cell. NaN means "does not apply": the cell is empty. */
void table_text(struct table *table, const char *format, ...) __attribute__((format(printf, 2, 3)));
void table_number(struct table *table, double value);

int table_rows(const struct table *table);

/* Marks the row of the last cell as that of the setting in use. */
void table_mark(struct table *table);

/* Writes a number for people, with about three digits; NaN and infinity give an empty text. */
void table_rounded(double value, char *text, size_t room);

void table_write_csv(const struct table *table, FILE *to);	     /* numbers with 7 digits */
void table_write_json(const struct table *table, struct json *json); /* an array of this name */

/* Writes columns of text. Rows whose first cell differs from that of the row before begin a group
 * of this title, if the first column has no heading. */
void table_write_text(const struct table *table, FILE *to);

#endif
