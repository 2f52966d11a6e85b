/* SPDX-License-Identifier: MIT */
#ifndef INLAY_HAL_LOOK_MEDIAN_H
#define INLAY_HAL_LOOK_MEDIAN_H

/* Returns the median of count > 0 values (Hoare's selection). Their order changes. */
float select_median(float *value, int count);

#endif
