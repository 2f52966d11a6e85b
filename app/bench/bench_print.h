/* SPDX-License-Identifier: MIT */
/* Prints what bench has measured. */
#ifndef INLAY_APP_BENCH_BENCH_PRINT_H
#define INLAY_APP_BENCH_BENCH_PRINT_H

#include <stdio.h>

#include "app/bench/bench.h"
#include "hal/base/table.h"

int bench_print_fill(const struct bench_report *report, struct table *table); /* -ENOMEM */
void bench_print_text(const struct bench_report *report, const struct table *table, FILE *to);
void bench_print_json(const struct bench_report *report, const struct table *table, FILE *to);

#endif
