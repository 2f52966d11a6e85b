/* SPDX-License-Identifier: MIT */
/* Comparisons for qsort(), ascending. */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_ORDER_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_ORDER_H

int order_doubles(const void *a, const void *b);
int order_floats(const void *a, const void *b);

#endif
