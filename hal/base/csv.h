/* SPDX-License-Identifier: MIT */
/* Fields of CSV (RFC 4180). The caller writes commas and line ends. */
#ifndef INLAY_HAL_BASE_CSV_H
#define INLAY_HAL_BASE_CSV_H

#include <stdio.h>

/* Quotes a text that holds a comma, a quote or a line end. */
void csv_text(FILE *to, const char *text);

/* 7 digits; an empty field where value is not finite. */
void csv_number(FILE *to, double value);

#endif
