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

#include "hal/base/fault.h"
#include "hal/base/table.h"
#include "hal/measure/error.h"
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

#endif
