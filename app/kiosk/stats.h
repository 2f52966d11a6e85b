/* SPDX-License-Identifier: MIT */
/*
 * What a run tells about itself: one JSON object a line, a line a second. README.md says what each
 * number means.
 */
#ifndef INLAY_APP_KIOSK_STATS_H
#define INLAY_APP_KIOSK_STATS_H

#include <stdint.h>

#include "app/camera/source.h"
#include "app/pipeline/pipeline.h"
#include "hal/base/fault.h"

enum stage { STAGE_DECODE, STAGE_SAMPLE, STAGE_COMPOSITE, STAGE_SHOW, STAGE_COUNT };

#define STATS_TEXT_MAX 2048
#define STATS_IN_FLIGHT 4 /* pictures that were submitted and are not on the screen yet */

/* Since the line before. */
struct stats_figures {
	double t_s, fps;
	double latency_mean_ms, latency_max_ms;
	uint64_t late;
	double stage_ms[STAGE_COUNT];
};

struct stats {
	const char *path;	   /* NULL: no lines are written */
	int file;		   /* -1: not open at present */
	uint64_t lines_lost;	   /* could not be written, since the start */
	int64_t start_ns, line_ns; /* of the run; of the last line */
	uint64_t frames;	   /* shown since the start */
	struct stats_figures last; /* what the last line said */
	/* Since the last line: */
	uint64_t line_frames, made, timed, late;
	int64_t latency_sum_ns, latency_max_ns;
	int64_t stage_ns[STAGE_COUNT];
	/* What making them took: */
	struct {
		int64_t captured_ns, work_ns;
	} flying[STATS_IN_FLIGHT];
	unsigned next_flying;
};

/* Begins the file anew. path NULL: count, but write nothing. A named pipe may have its reader
 * later.
 */
int stats_open(struct stats *stats, const char *path, struct fault *fault);
/* The next line goes to what has that name by then: the old file may have been moved away. */
void stats_reopen(struct stats *stats);
void stats_start(struct stats *stats, int64_t now_ns); /* the run's time 0 */
void stats_close(struct stats *stats);		       /* idempotent */

/* A picture has been made of a frame captured then (0: of no new one), and spent so long in each
 * stage. */
void stats_made(struct stats *stats, int64_t captured_ns, const int64_t stage_ns[STAGE_COUNT]);

/* The picture of that frame is on the screen. It is late when more time has passed than one frame,
 * period_ns, and what making it took. A picture of no new frame has no latency. */
void stats_shown(struct stats *stats, int64_t captured_ns, int64_t shown_ns, int64_t period_ns);

/* Writes a line and begins the next. Never waits: what cannot be written whole, because the disk is
 * full or a pipe's reader slow or absent, is left out and counted, which is said once. */
void stats_line(struct stats *stats, int64_t now_ns, const struct pipeline_report *report,
		const struct source *sources, int source_count);

/* What the line holds, without its braces: the figures of the last one, the rest as it is now.
 * threshold: the report's, or what it will be in the next frame. */
void stats_text(const struct stats *stats, const struct pipeline_report *report,
		const struct ini_level *threshold, const struct source *sources, int source_count,
		char text[STATS_TEXT_MAX]);

/* Frames of all cameras that were not used. */
uint64_t stats_drops(const struct source *sources, int source_count);

#endif
