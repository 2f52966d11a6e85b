/* SPDX-License-Identifier: MIT */
/*
 * A report: a folder with one HTML page, and its tables and pictures as files. Everything is
 * written to a temporary folder beside the one asked for, which takes its place when the report is
 * complete: a report that fails leaves an earlier one as it is.
 */
#ifndef INLAY_BAKE_BASE_REPORT_PAGE_H
#define INLAY_BAKE_BASE_REPORT_PAGE_H

#include <limits.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/base/table.h"
#include "hal/image/image.h"

#define REPORT_PAGE_NAME "report.html"
#define REPORT_PATH_MAX (2 * PATH_MAX)

struct report_page {
	char folder[PATH_MAX]; /* as asked for */
	/* where files are written until the commit; empty: no report is open */
	char temporary[PATH_MAX];
	FILE *body;
	char *text; /* what is written to body */
	size_t bytes;
};

/* Begins a report. -EEXIST: the folder holds files and no earlier report; or -errno of creating the
 * temporary folder. */
int report_page_open(struct report_page *page, const char *folder, struct fault *fault);

/* Write an HTML heading, paragraph or text. The text is escaped. */
void report_heading(FILE *to, const char *format, ...) __attribute__((format(printf, 2, 3)));
void report_paragraph(FILE *to, const char *format, ...) __attribute__((format(printf, 2, 3)));
void report_write_escaped(FILE *to, const char *text);

/* Write a table as CSV and free it, or a picture as PNG, and show it in the page. */
int report_page_table(struct report_page *page, struct table *table, struct fault *fault);
int report_page_picture(struct report_page *page, const char *name, const struct image *picture,
			const char *caption, struct fault *fault);

/* Where a file of the report is, and a picture there shown in the page. */
void report_page_path(const struct report_page *page, const char *name, const char *ending,
		      char path[REPORT_PATH_MAX]);
void report_page_show(struct report_page *page, const char *name, const char *caption);

/* Writes the page and moves the folder to its place; the files of an earlier report are removed.
 * The report is closed in any case. */
int report_page_commit(struct report_page *page, const char *title, struct fault *fault);

/* Removes what is not committed. Idempotent; zeroed is fine. */
void report_page_abandon(struct report_page *page);

#endif
