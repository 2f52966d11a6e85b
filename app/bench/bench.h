/* SPDX-License-Identifier: MIT */
/*
 * inlay bench: how long a frame of a basis takes, in every way that inlay has to make it, beside
 * the thesis's own algorithm; with the error of each way against double precision.
 *
 * All ways are timed in turns (A, B, C, A, B, C, ...), each after a few milliseconds of its own
 * that are not timed, so that noise of the machine meets all ways alike and each finds the caches
 * as it leaves them. Times of one thread are its processor time, those of several threads wall
 * clock time.
 */
#ifndef INLAY_APP_BENCH_BENCH_H
#define INLAY_APP_BENCH_BENCH_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/base/table.h"
#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"
#include "hal/measure/measure.h"
#include "hal/measure/thesis.h"
#include "hal/options/options.h"

struct bench_settings {
	const char *basis;
	const char *kernel;		      /* NULL: every one that the processor supports */
	struct option_list lights, panoramas; /* both empty: built-in lightings */
	int threads;
	int repeat;
	int cells; /* number of cells that are a lighting of their own, of the built-in ones */
	double threshold; /* linear radiance: lights below are left out; 0: none */
	double budget;	  /* above 0: share of white in place of threshold (compositor.h) */
	bool thesis;	  /* time the thesis's algorithm, too; its basis takes much memory */
};

/* A way to make the picture, under one lighting. Figures that do not apply are 0. */
struct bench_row {
	const char *lighting, *what, *kernel;
	int lights; /* lights in use, for one member of the lighting; -1: does not apply */
	double median_ms, least_ms;
	double speedup;	 /* the thesis's median over this one */
	double basis_mb; /* 10^6 bytes of the basis that the last frame read */
	double copies;	 /* least_ms / least time of copying the picture */
	bool has_error;
	struct composite_error error; /* largest of all members of the lighting */
};

struct bench_report {
	char basis[256];
	int width, height, lights, threads, repeat;
	long object_pixels, shadow_pixels;
	double shown_mb, exact_mb, dense_mb; /* layers; dense: one byte a value */
	const char *truth; /* layer that double precision took: "exact" or "shown" */
	/* Share of the timed turns in which the calling thread did not run. With one thread, that
	 * time is not counted, but the programs that ran use caches and memory, too. */
	double waited;
	struct table rows; /* of one lighting after the other; to be freed */
};

/* Fills in the report. -ENOMEM; what opening the files returns. Its table is to be freed in any
 * case. */
int bench_run(const struct bench_settings *settings, struct bench_report *report,
	      struct fault *fault);

/*
 * A whole frame as in a kiosk: from YUYV pictures of two cameras, of the basis's size, to a
 * picture. For bench alone.
 */

#define BENCH_CAMERA_BUFFERS 4
#define BENCH_SCREEN_BUFFERS 3

struct bench_frame;

/* Makes the background camera's picture from a canvas. pool: threads that measure the light;
 * borrowed. -ENOTSUP: the basis's lights are no dome's, so no lens can look at them. */
int bench_frame_create(struct bench_frame **frame, const struct basis *basis,
		       const struct canvas *background, struct pool *pool, struct fault *fault);

/* Makes the fisheye camera's picture: each cell shows min(its light, 1). 0 or -ENOMEM. */
int bench_frame_light(struct bench_frame *frame, const float (*radiance)[3]);

/* Sets what may be left out (struct light_selection, budget); 0, as created: the threshold
 * decides. */
void bench_frame_budget(struct bench_frame *frame, double budget);

/* Four lamps at places, 1.5 m from the origin, of which each gives the ground below a radiance of
 * about 0.1. */
extern const struct lamps bench_lamps;

/* Goes on to the next buffer of each camera; they hold the same pictures. */
void bench_frame_next(struct bench_frame *frame);

/* Parts of a frame: measures the light of all cells, and with `lamps` theirs, and chooses those in
 * use; converts the background. */
int bench_frame_measure(struct bench_frame *frame, bool lamps, double threshold,
			struct fault *fault);
void bench_frame_convert(const struct bench_frame *frame, struct canvas *out);

/* Makes a frame: light, then conversion and composite in one. *bytes: read of the basis. */
int bench_frame_run(struct bench_frame *frame, struct compositor *compositor, double threshold,
		    struct canvas *out, uint64_t *bytes, struct fault *fault);

/* The background as the cameras saw it, and the lights in use: for the error of the frame. */
struct picture bench_frame_background(const struct bench_frame *frame);
const struct light_selection *bench_frame_lights(const struct bench_frame *frame);

void bench_frame_destroy(struct bench_frame *frame); /* NULL is harmless */

/*
 * The ways to make a picture that bench compares. Each prepares itself, untimed, and then makes one
 * frame. For bench alone.
 */

/* What all ways share. */
struct bench_stage {
	const struct bench_settings *settings;
	const struct basis *basis;
	bool exact; /* the basis has an exact layer */
	struct pool *pool;
	/* As many buffers as a kiosk's cameras and screen have, so that a frame does not find the
	 * memory of the one before it in the caches. All backgrounds are the same picture. */
	struct canvas background[BENCH_CAMERA_BUFFERS], screen[BENCH_SCREEN_BUFFERS];
	struct picture background_picture; /* of the present buffer */
	struct canvas out;		   /* present buffer of the screen; borrowed */
	unsigned frames;
	struct thesis *thesis;		 /* NULL: left out */
	struct bench_frame *cameras;	 /* NULL: the basis's lights are no dome's */
	const struct lighting *lighting; /* the present one */
	const float (*seen)[3];		 /* member of it that the cameras show */
	struct light_selection lights;	 /* lights of the present member */
	int64_t timed_ns, ran_ns; /* sum over the timed turns: wall clock time, processor time */
};

enum bench_kind {
	BENCH_THESIS,
	BENCH_COMPOSITE,
	BENCH_FRAME,
	BENCH_LAMPS, /* the same with lamps at places; its error is not measured */
	/* The following make no picture of the object: */
	BENCH_LIGHT,
	BENCH_CONVERT,
	BENCH_COPY,
};

struct bench_way {
	enum bench_kind kind;
	struct bench_row row; /* what and kernel; the rest is filled in later */
	/* For BENCH_COMPOSITE, BENCH_FRAME and BENCH_LAMPS: */
	struct compositor *compositor;
	struct compositor_settings composite;
	uint64_t bytes; /* bytes of the basis that its last frame read */
	double *ms;	/* [repeat]: time of each turn; part of bench_ways.ms */
};

struct bench_ways {
	struct bench_way *way;
	int count;
	double *ms; /* [count][repeat] */
	struct compositor **compositors;
	int compositor_count;
};

int bench_ways_create(struct bench_ways *ways, const struct bench_stage *stage,
		      struct fault *fault);
void bench_ways_free(struct bench_ways *ways); /* idempotent; zeroed is fine */

/* Whether the way makes a picture of the object, which has an error. */
bool bench_way_shows(const struct bench_way *way);

/* Makes a member of the lighting the present one, for the cameras, too. 0 or -ENOMEM. */
int bench_stage_light(struct bench_stage *stage, int member, struct fault *fault);

/* Goes on to the next buffers of cameras and screen. */
void bench_stage_next(struct bench_stage *stage);

/* Prepares the way's frame, untimed. */
void bench_way_prepare(struct bench_way *way, struct bench_stage *stage);

/* Makes the frame, in stage->out, the next buffer of the screen. */
int bench_way_run(struct bench_way *way, struct bench_stage *stage, struct fault *fault);

/* Compares the picture of each way with double precision. For bench alone. */

/* Fills in the error of each way, the largest of all members of the stage's lighting. all: threads
 * for double precision, which takes long. -ENOMEM, or the error of a frame. */
int bench_truth(struct bench_ways *ways, struct bench_stage *stage, const struct scope *scope,
		struct pool *all, struct fault *fault);

/* Prints what bench has measured. */

void bench_print_begin(struct table *table); /* the columns of rows */
void bench_print_row(struct table *table, const struct bench_row *row);

void bench_print_text(const struct bench_report *report, FILE *to);
void bench_print_json(const struct bench_report *report, FILE *to);

/* The command of the program. */
extern const struct command command_bench;

#endif
