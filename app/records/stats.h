/* SPDX-License-Identifier: MIT */
/*
 * Statistics of a run: one JSON object a line, one line a second. app/kiosk/README.md describes
 * each key.
 */
#ifndef INLAY_APP_RECORDS_STATS_H
#define INLAY_APP_RECORDS_STATS_H

#include <stdint.h>

#include "app/camera/source.h"
#include "app/pipeline/pipeline.h"
#include "hal/base/fault.h"

enum stage { STAGE_DECODE, STAGE_SAMPLE, STAGE_PEOPLE, STAGE_COMPOSITE, STAGE_SHOW, STAGE_COUNT };

#define STATS_TEXT_MAX 3072
#define STATS_IN_FLIGHT 4 /* pictures submitted and not on the screen yet */

/* Figures since the line before. */
struct stats_figures {
	double t_s, fps;
	double latency_mean_ms, latency_max_ms;
	uint64_t late;
	double stage_ms[STAGE_COUNT], look_ms[PIPELINE_LOOKS];
};

struct stats {
	const char *path;	   /* NULL: no lines are written */
	int file;		   /* -1: not open at present; the next line opens it */
	uint64_t lines_lost;	   /* lines that could not be written, since the start */
	int64_t start_ns, line_ns; /* when the run began; when the last line was written */
	uint64_t frames;	   /* pictures shown since the start */
	/* Since the start, but for the peak, which whoever uses it sets to 0: */
	uint64_t timed_total, late_total;
	int64_t latency_total_ns, latency_peak_ns;
	struct stats_figures last; /* what the last line said */
	/* Since the last line: */
	uint64_t line_frames, made, timed, late;
	int64_t latency_sum_ns, latency_max_ns;
	int64_t stage_ns[STAGE_COUNT], look_ns[PIPELINE_LOOKS];
	/* The last pictures made: time of capture, and of the work on them. */
	struct {
		int64_t captured_ns, work_ns;
	} flying[STATS_IN_FLIGHT];
	unsigned next_flying;
};

/* Opens the file and empties it. path NULL: counts, but writes nothing. A named pipe need not have
 * a reader yet. */
int stats_open(struct stats *stats, const char *path, struct fault *fault);
/* The next line opens path again: the old file may have been renamed (logrotate). */
void stats_reopen(struct stats *stats);
void stats_start(struct stats *stats, int64_t now_ns); /* sets time 0 of the run */
void stats_close(struct stats *stats);		       /* idempotent */

/* Counts a picture that was made of a frame captured at that time (0: of no new frame), with the
 * time spent in each stage, and of it for the camera's look. */
void stats_made(struct stats *stats, int64_t captured_ns, const int64_t stage_ns[STAGE_COUNT],
		const int64_t look_ns[PIPELINE_LOOKS]);

/*
 * Counts a picture that has reached the screen. It is late where
 *
 *     shown_ns - captured_ns > period_ns + time of the work on it
 *
 * period_ns: of a frame, of the camera or the screen, whichever is slower. captured_ns 0: the
 * picture has no latency.
 */
void stats_shown(struct stats *stats, int64_t captured_ns, int64_t shown_ns, int64_t period_ns);

/* Writes a line and begins the next. Never waits: a line that cannot be written whole, because the
 * disk is full or a pipe's reader is slow or absent, is left out and counted. The log says so
 * once. */
void stats_line(struct stats *stats, int64_t now_ns, const struct pipeline_report *report,
		const struct source *sources, int source_count);

/* Writes the line without its braces: the figures of the last line, everything else as it is now.
 * threshold: the report's, or the one of the next frame. */
void stats_text(const struct stats *stats, const struct pipeline_report *report,
		const struct ini_level *threshold, const struct source *sources, int source_count,
		char text[STATS_TEXT_MAX]);

/* Returns how many frames of all cameras were not used. */
uint64_t stats_drops(const struct source *sources, int source_count);

#endif
