/* SPDX-License-Identifier: MIT */
/* How far each way's picture is from double precision, and whether ways that ought to give the same
 * bits do. For bench alone. */
#ifndef INLAY_APP_BENCH_BENCH_TRUTH_H
#define INLAY_APP_BENCH_BENCH_TRUTH_H

#include "app/bench/bench_ways.h"
#include "hal/measure/error.h"

/* Fills in the error of each way, the worst of all members of the stage's lighting. all: threads
 * that double precision may use; it takes long. -EIO: two ways differ. */
int bench_truth(struct bench_ways *ways, struct bench_stage *stage, const struct scope *scope,
		struct pool *all, struct fault *fault);

#endif
