/* SPDX-License-Identifier: MIT */
/* What outlasts or leaves the kiosk: what was chosen, what was learned, statistics, metrics. */
#ifndef INLAY_APP_RECORDS_RECORDS_H
#define INLAY_APP_RECORDS_RECORDS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "app/camera/source.h"
#include "app/pipeline/pipeline.h"
#include "config/config.h"
#include "hal/base/fault.h"

/*
 * A thread that replaces files whole (hal/base/output.h), because a disk may be slow. A failure is
 * logged once until it passes. Calls come from one thread.
 */

enum keeper_file { KEEPER_STATE, KEEPER_PLACE, KEEPER_FILES };
enum keeper_condition { KEEPER_DONE, KEEPER_BUSY, KEEPER_FAILED };

struct keeper;

int keeper_create(struct keeper **keeper); /* 0 or -errno */

/* Has bytes, which the keeper frees, written to a file, in place of those that wait for it; those
 * of KEEPER_PLACE are sealed. bytes NULL: the file is removed. */
void keeper_put(struct keeper *keeper, enum keeper_file file, const char *path, void *bytes,
		size_t count);

/* What has become of what was put last. */
enum keeper_condition keeper_look(struct keeper *keeper, enum keeper_file file);

void keeper_destroy(struct keeper *keeper); /* writes what waits; NULL is harmless */

/*
 * Keeps what was chosen with the buttons over a power cut: threshold, view and pose, in a small INI
 * file that is written at most once an interval and at the end.
 */

struct state_values {
	struct ini_level threshold; /* 0..255 or 0..100 % */
	int view;		    /* enum config_show */
	int pose;		    /* at least 0; the caller checks whether the basis has it */
};

/* Reads the file. Keys that are missing leave their value alone; so does any fault, which names
 * file and line. -ENOENT: there is no file. */
int state_read(const char *path, struct state_values *values, struct fault *fault);

/* The same for the text of a file, in memory. */
int state_read_memory(const char *text, size_t bytes, const char *name, struct state_values *values,
		      struct fault *fault);

struct state;

/* now: what the file holds, or need not hold. The keeper is borrowed. 0 or -ENOMEM. */
int state_create(struct state **state, struct keeper *keeper, const struct config_state *settings,
		 const struct state_values *now);

/* Writes to another file or at another interval from now on. NULL is harmless, here and below. */
void state_move(struct state *state, const struct config_state *settings);

/* Has the values written; never waits. */
void state_keep(struct state *state, const struct state_values *values);

/* Once a second: has written what had to wait for its interval, and tries again what could not be
 * written (a full disk, a missing folder). */
void state_look(struct state *state);

/* Has written what has not been yet. */
void state_destroy(struct state *state);

/*
 * Keeps over a power cut what was learned of the place without people (hal/people), beside the file
 * of [state] and under its name with .place: at most 20 MB. It is first written 4 intervals of
 * [state] after learning began, then every 360, and at the end. What is written is copied part by
 * part between pictures.
 */

struct learned;

/* The keeper is borrowed. 0 or -ENOMEM. NULL is harmless in all other calls. */
int learned_create(struct learned **learned, struct keeper *keeper,
		   const struct config_state *settings);

/* Gives what is kept to a pipeline that has not looked at a frame yet; it does nothing to others. A
 * file that is damaged or of another place is logged and not used. To be called for each new
 * pipeline, and when its settings have changed. */
void learned_restore(struct learned *learned, struct pipeline *pipeline);

/* Has it written when it is time to; never waits. To be called after each picture. */
void learned_keep(struct learned *learned, const struct pipeline *pipeline);

/* Another file or interval counts from now on. */
void learned_move(struct learned *learned, const struct config_state *settings);

/* What is seen was taken as the place: it is written soon. */
void learned_soon(struct learned *learned);

/* Removes the file. */
void learned_forget(struct learned *learned);

/* Has written what was learned. pipeline NULL: nothing was. */
void learned_destroy(struct learned *learned, const struct pipeline *pipeline);

/*
 * Statistics of a run: one JSON object a line, one line a second. app/kiosk/README.md describes
 * each key.
 */

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

/* ---- supply.c: what a Raspberry Pi says of its power supply and its heat: either makes it slower
 * and pictures late ---- */

#define SUPPLY_SYSFS "/sys"

struct supply {
	bool told; /* by this machine; else the rest is false */
	bool undervoltage, throttled;
	bool undervoltage_before, throttled_before; /* since the machine started */
};

/* Asks the firmware, else the kernel's monitor, which tells of the voltage alone. */
struct supply supply_read(const char *sysfs);

/*
 * Figures of a running kiosk for Prometheus: a text file that its node exporter collects. README.md
 * lists them. The file appears whole, by rename. It is not synced: nobody needs the figures of
 * before a power cut.
 */

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
	const char *sysfs; /* SUPPLY_SYSFS */
};

void metrics_print(const struct metrics_facts *facts, FILE *to);

/* Writes the file, if the last time is METRICS_EVERY_S ago. An empty path: nothing. A failure is
 * logged once until it passes. Returns whether a new file is there. */
bool metrics_write(struct metrics *metrics, const char *path, const struct metrics_facts *facts,
		   int64_t now_ns);

#endif
