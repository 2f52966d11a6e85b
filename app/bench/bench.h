/* SPDX-License-Identifier: MIT */
/*
 * inlay bench: what a frame of a basis takes, every way that there is, beside the thesis's own
 * algorithm and what memory allows; with the error of each against double precision.
 *
 * All ways are timed in turns (A, B, C, A, B, C, ...), each after a few milliseconds of its own
 * that are not timed, so that noise of the machine meets all alike and each finds its caches as it
 * leaves them. Times of one thread are what it had of the processor, those of several are by the
 * clock.
 */
#ifndef INLAY_APP_BENCH_BENCH_H
#define INLAY_APP_BENCH_BENCH_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/measure/error.h"

#define BENCH_FILES_MAX 16

struct bench_settings {
	const char *basis;
	const char *kernel; /* NULL: each that the processor supports */
	const char *lights[BENCH_FILES_MAX], *panoramas[BENCH_FILES_MAX];
	int light_files, panorama_files; /* both 0: built-in lightings */
	int threads;
	int repeat;
	int cells;	  /* of the built-in single ones */
	double threshold; /* linear radiance: lights below are left out; 0: none */
	double budget;	  /* above 0, in its place: of white, as compositor.h has it */
	bool thesis;	  /* its basis takes much memory */
};

/* One way to make the picture, under one lighting. What does not apply is 0. */
struct bench_row {
	char lighting[64];
	char what[48];
	char kernel[24];
	int lights; /* used, of one member of the lighting; -1: does not apply */
	double median_ms, least_ms;
	double speedup;	   /* the thesis's median over this one */
	double basis_mb;   /* of 1,000,000 bytes, read in the last frame */
	double read_ms;	   /* the least that only reading as much takes */
	double read_ratio; /* least_ms over it */
	double copies;	   /* least_ms over the least of copying the picture */
	bool has_error;
	struct composite_error error; /* the worst of the lighting's members */
};

struct bench_report {
	char basis[256];
	int width, height, lights, threads, repeat;
	long object_pixels, shadow_pixels;
	double shown_mb, exact_mb, dense_mb; /* fast and exact layer; a byte for each value */
	const char *truth;   /* the layer that double precision took: "exact", ... */
	const char *vectors; /* that memory is read with */
	/* Share of the timed turns in which the calling thread did not run. With one thread: others
	 * did, which is in no time here, but they use caches and memory too. */
	double waited;
	struct bench_row *row;
	int count;
};

/* Rows are those of one lighting after the other. -ENOMEM, -EIO (two ways that ought to give the
 * same bits do not), what opening the files gives. The report is to be freed in any case. */
int bench_run(const struct bench_settings *settings, struct bench_report *report,
	      struct fault *fault);
void bench_report_free(struct bench_report *report); /* idempotent; zeroed is fine */

#endif
