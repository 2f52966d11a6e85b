/* SPDX-License-Identifier: MIT */
#ifndef INLAY_HAL_LOOK_MEDIAN_H
#define INLAY_HAL_LOOK_MEDIAN_H

/* Median of count > 0 values, which are put into another order (Hoare's selection). */
float select_median(float *value, int count);

#endif
