/* SPDX-License-Identifier: MIT */
/*
 * The ways to make a picture that bench compares: each prepares itself, untimed, and then makes one
 * frame. For bench alone.
 */
#ifndef INLAY_APP_BENCH_BENCH_WAYS_H
#define INLAY_APP_BENCH_BENCH_WAYS_H

#include "app/bench/bench.h"
#include "app/bench/bench_frame.h"
#include "app/bench/bench_memory.h"
#include "hal/compositor/compositor.h"
#include "hal/measure/lightings.h"
#include "hal/measure/thesis.h"

/* What all ways share. */
struct bench_stage {
	const struct bench_settings *settings;
	const struct basis *basis;
	bool exact; /* there is an exact layer */
	struct pool *pool;
	/* As many buffers as a kiosk's cameras and screen have: a frame finds other memory than the
	 * one before it left in the caches. All backgrounds are the same picture. */
	struct canvas background[BENCH_CAMERA_BUFFERS], screen[BENCH_SCREEN_BUFFERS];
	struct picture background_picture; /* whose turn it is */
	struct canvas out;		   /* the same; borrowed */
	unsigned frames;
	struct thesis *thesis;	     /* NULL: left out */
	struct bench_frame *cameras; /* NULL: the basis's lights are no dome's */
	struct bench_reading reading;
	const struct lighting *lighting; /* of this round */
	const float (*seen)[3];		 /* the member of it that the cameras show */
	struct light_selection lights;	 /* of the member whose turn it is */
	struct light_selection before;	 /* the same, but for some */
	float (*scratch)[3];		 /* [lights] */
	int64_t timed_ns, ran_ns;	 /* in all timed turns: by the clock, by the processor */
};

enum bench_kind {
	BENCH_THESIS,
	BENCH_COMPOSITE,
	BENCH_FRAME,
	/* these make no picture of the object */
	BENCH_LIGHT,
	BENCH_CONVERT,
	BENCH_READ,
	BENCH_COPY,
};

#define BENCH_CHANGE_ALL (-1)

struct bench_way {
	enum bench_kind kind;
	struct bench_row row; /* what and kernel; the rest when it is known */
	/* BENCH_COMPOSITE, BENCH_FRAME */
	struct compositor *compositor;
	struct compositor_settings composite;
	int changed;	/* lights that differ from the frame before it: 0, n, BENCH_CHANGE_ALL */
	uint64_t bytes; /* of the basis, read by its last frame */
	/* BENCH_READ: as many bytes as that way has read */
	const struct bench_way *like;
	double *ms; /* [repeat], of the list's own memory */
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

/* Whether it makes a picture of the object, so that there is an error to measure. */
bool bench_way_shows(const struct bench_way *way);

/* Makes a member of the lighting the one whose turn it is, for the cameras too. -ENOMEM. */
int bench_stage_light(struct bench_stage *stage, int member, struct fault *fault);

/* The next of the cameras' and the screen's buffers. */
void bench_stage_next(struct bench_stage *stage);

/* Untimed: what has to be so before this way's frame, the frame that it starts from included. */
int bench_way_prepare(struct bench_way *way, struct bench_stage *stage, int turn,
		      struct fault *fault);

/* The frame, into stage->out, which is the next of the screen's buffers. */
int bench_way_run(struct bench_way *way, struct bench_stage *stage, struct fault *fault);

#endif
