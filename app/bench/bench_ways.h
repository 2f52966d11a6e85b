/* SPDX-License-Identifier: MIT */
/*
 * The ways to make a picture that bench compares. Each prepares itself, untimed, and then makes one
 * frame. For bench alone.
 */
#ifndef INLAY_APP_BENCH_BENCH_WAYS_H
#define INLAY_APP_BENCH_BENCH_WAYS_H

#include "app/bench/bench.h"
#include "app/bench/bench_frame.h"
#include "hal/compositor/compositor.h"
#include "hal/measure/lightings.h"
#include "hal/measure/thesis.h"

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
	/* The following make no picture of the object: */
	BENCH_LIGHT,
	BENCH_CONVERT,
	BENCH_COPY,
};

struct bench_way {
	enum bench_kind kind;
	struct bench_row row; /* what and kernel; the rest is filled in later */
	/* For BENCH_COMPOSITE and BENCH_FRAME: */
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

#endif
