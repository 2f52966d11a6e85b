/* SPDX-License-Identifier: MIT */
/* Prints what bench has measured. */
#ifndef INLAY_APP_BENCH_BENCH_PRINT_H
#define INLAY_APP_BENCH_BENCH_PRINT_H

#include <stdio.h>

#include "app/bench/bench.h"

void bench_print_begin(struct table *table); /* the columns of rows */
void bench_print_row(struct table *table, const struct bench_row *row);

void bench_print_text(const struct bench_report *report, FILE *to);
void bench_print_json(const struct bench_report *report, FILE *to);

#endif
