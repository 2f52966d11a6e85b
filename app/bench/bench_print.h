/* SPDX-License-Identifier: MIT */
/* What inlay bench found, for people and for programs. */
#ifndef INLAY_APP_BENCH_BENCH_PRINT_H
#define INLAY_APP_BENCH_BENCH_PRINT_H

#include <stdio.h>

#include "app/bench/bench.h"

void bench_print_table(const struct bench_report *report, FILE *to);

/* The same figures, all of them, in both. What does not apply is null, or empty. */
void bench_print_json(const struct bench_report *report, FILE *to);
void bench_print_csv(const struct bench_report *report, FILE *to);

#endif
