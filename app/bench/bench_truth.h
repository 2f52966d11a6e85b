/* SPDX-License-Identifier: MIT */
/* Compares the picture of each way with double precision. For bench alone. */
#ifndef INLAY_APP_BENCH_BENCH_TRUTH_H
#define INLAY_APP_BENCH_BENCH_TRUTH_H

#include "app/bench/bench_ways.h"
#include "hal/measure/error.h"

/* Fills in the error of each way, the largest of all members of the stage's lighting. all: threads
 * for double precision, which takes long. -ENOMEM, or the error of a frame. */
int bench_truth(struct bench_ways *ways, struct bench_stage *stage, const struct scope *scope,
		struct pool *all, struct fault *fault);

#endif
