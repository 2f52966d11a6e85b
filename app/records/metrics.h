/* SPDX-License-Identifier: MIT */
/*
 * Figures of a running kiosk for Prometheus: a text file that its node exporter collects. README.md
 * lists them. The file appears whole, by rename. It is not synced: nobody needs the figures of
 * before a power cut.
 */
#ifndef INLAY_APP_RECORDS_METRICS_H
#define INLAY_APP_RECORDS_METRICS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "app/camera/source.h"
#include "app/pipeline/pipeline.h"
#include "app/records/stats.h"

#define METRICS_EVERY_S 15

struct metrics {
	int64_t written_ns; /* when it was written last, or failed to be; 0: never */
	bool failed;	    /* that it cannot be written has been logged */
};

/* What is written; all borrowed. */
struct metrics_facts {
	const struct stats *stats;
	const struct pipeline_report *report;
	const struct source *sources;
	int source_count;
	const char *screen; /* its situation */
	bool screen_is_fine, resting;
};

void metrics_print(const struct metrics_facts *facts, FILE *to);

/* Writes the file, if the last time is METRICS_EVERY_S ago. An empty path: nothing. A failure is
 * logged once until it passes. Returns whether a new file is there. */
bool metrics_write(struct metrics *metrics, const char *path, const struct metrics_facts *facts,
		   int64_t now_ns);

#endif
