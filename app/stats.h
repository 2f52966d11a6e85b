/*
 * What a run tells about itself: one JSON object a line, a line a second. README.md says what each
 * number means.
 */
#ifndef INLAY_APP_STATS_H
#define INLAY_APP_STATS_H

#include <stdint.h>
#include <stdio.h>

#include "app/pipeline.h"
#include "app/source.h"
#include "hal/fault.h"

enum stage { STAGE_DECODE, STAGE_SAMPLE, STAGE_COMPOSITE, STAGE_SHOW, STAGE_COUNT };

struct stats {
	FILE *stream;	   /* NULL: nobody reads them */
	char buffer[4096]; /* of the stream, which would else allocate its own at the first line */
	const char *path;
	int64_t start_ns, line_ns; /* of the run; of the last line */
	uint64_t frames;	   /* shown since the start */
	/* Since the last line: */
	uint64_t line_frames, made;
	int64_t latency_sum_ns, latency_max_ns;
	int64_t stage_ns[STAGE_COUNT];
};

/* path NULL: count, but write nothing. */
int stats_open(struct stats *stats, const char *path, struct fault *fault);
void stats_start(struct stats *stats, int64_t now_ns); /* the run's time 0 */
void stats_close(struct stats *stats);		       /* idempotent */

/* A picture has been made, and spent so long in each stage. */
void stats_made(struct stats *stats, const int64_t stage_ns[STAGE_COUNT]);

/* A picture is on the screen, so long after its background was captured. */
void stats_shown(struct stats *stats, int64_t latency_ns);

/* Writes a line and begins the next. A disk that is full is said once, and ends the file. */
void stats_line(struct stats *stats, int64_t now_ns, const struct pipeline *pipeline,
		const struct source *sources, int source_count);

#endif
