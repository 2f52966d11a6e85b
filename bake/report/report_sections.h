/* SPDX-License-Identifier: MIT */
/*
 * The sections of a report. Those that vary a single choice (threshold, input bits, column cut,
 * kernels, threads) are in report_choices.c, report_declared_error() is in
 * report_error.c, and each other one in the file of its name. Sections do not call each other. Those
 * that advise something choose by report_trial_choose().
 */
#ifndef INLAY_BAKE_REPORT_REPORT_SECTIONS_H
#define INLAY_BAKE_REPORT_REPORT_SECTIONS_H

#include "bake/report/report_parts.h"

/* Opens the basis file in use. The settings that it was baked with go to report->render. */
int report_given_open(struct report *report);

/* Makes the bake of fewer samples and sets the noise of bakes and truth in *report. */
int report_samples_measure(struct report *report);

/* The number of bakes that report_declared_error() and report_thesis() make. */
int report_error_bakes(const struct report *report);
int report_thesis_bakes(void);

/* Write one section each, in the order of the page. 0, or -errno with report->fault. */
int report_lights(struct report *report);
int report_samples(struct report *report);
int report_threshold(struct report *report);
int report_input_bits(struct report *report);
int report_declared_error(struct report *report);
int report_column_cut(struct report *report);
int report_kernels(struct report *report);
int report_thread_counts(struct report *report);
int report_together(struct report *report);
int report_thesis(struct report *report);
int report_given(struct report *report);
int report_pictures(struct report *report);

/* Writes the summary. It stands first in the page, but needs the results of all sections. */
int report_summary(struct report *report);

#endif
