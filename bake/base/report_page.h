/* SPDX-License-Identifier: MIT */
/*
 * The folder of a report: a page that needs nothing beside it, and its tables, plots and pictures
 * as files. All of it is made in a folder of another name beside the one asked for, and takes its
 * place when it is whole.
 */
#ifndef INLAY_BAKE_BASE_REPORT_PAGE_H
#define INLAY_BAKE_BASE_REPORT_PAGE_H

#include <limits.h>
#include <stdio.h>

#include "bake/base/report_plot.h"
#include "bake/base/report_table.h"
#include "hal/image/image.h"

#define REPORT_PAGE_NAME "report.html"

struct report_page {
	char folder[PATH_MAX];	  /* as asked for */
	char temporary[PATH_MAX]; /* where everything goes until then; empty: nothing is open */
	FILE *head;		  /* what comes first, but is known last: title and summary */
	FILE *body;
	int lock; /* of that folder, held while it is written; 0, -1: none */
	char *head_text, *body_text;
	size_t head_bytes, body_bytes;
};

/* -EEXIST: the folder is there, and holds something that is no earlier report. -errno of making
 * the other one. */
int report_page_open(struct report_page *page, const char *folder, struct fault *fault);

/* Text is escaped. */
void report_heading(FILE *to, const char *format, ...) __attribute__((format(printf, 2, 3)));
void report_paragraph(FILE *to, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Each writes its file and shows it in the page. The plot is freed. */
int report_page_table(struct report_page *page, FILE *to, const struct report_table *table,
		      struct fault *fault);
int report_page_plot(struct report_page *page, FILE *to, struct report_plot *plot,
		     const char *caption, struct fault *fault);
int report_page_picture(struct report_page *page, FILE *to, const char *name,
			const struct image *picture, const char *caption, struct fault *fault);

/* Writes the page and moves everything to its place; an earlier report's files go. */
int report_page_commit(struct report_page *page, const char *title, struct fault *fault);

/* Takes away what is not committed. Idempotent; zeroed is fine. */
void report_page_abandon(struct report_page *page);

#endif
