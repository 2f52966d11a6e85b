/* SPDX-License-Identifier: MIT */
/* Writes the report of inlay bench, for people and for programs. */
#ifndef INLAY_APP_BENCH_BENCH_PRINT_H
#define INLAY_APP_BENCH_BENCH_PRINT_H

#include <stdio.h>

#include "app/bench/bench.h"

void bench_print_table(const struct bench_report *report, FILE *to);

/* All figures. What does not apply is null in JSON and empty in CSV. */
void bench_print_json(const struct bench_report *report, FILE *to);
void bench_print_csv(const struct bench_report *report, FILE *to);

#endif
