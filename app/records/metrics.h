/* SPDX-License-Identifier: MIT */
/*
 * Figures of a running kiosk for Prometheus: a text file that its node exporter collects. README.md
 * lists them. The file appears whole, by rename. It is not synced, as the loop must not wait for a
 * disk and nobody needs the figures of before a power cut.
 */
#ifndef INLAY_APP_RECORDS_METRICS_H
#define INLAY_APP_RECORDS_METRICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "app/camera/source.h"
#include "app/pipeline/pipeline.h"
#include "app/records/stats.h"

#define METRICS_EVERY_S 15
#define METRICS_TEXT_MAX 16384

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
	const char *sysfs; /* SUPPLY_SYSFS; has the kernel's thermal zones, too */
};

/* Writes the text; the figures that no longer fit are left out whole. Returns its length. */
size_t metrics_text(const struct metrics_facts *facts, char text[METRICS_TEXT_MAX]);

/* Writes the file, if the last time is METRICS_EVERY_S ago. An empty path: nothing. A failure is
 * logged once until it passes. Returns whether a new file is there. */
bool metrics_write(struct metrics *metrics, const char *path, const struct metrics_facts *facts,
		   int64_t now_ns);

#endif
