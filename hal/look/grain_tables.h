/* SPDX-License-Identifier: MIT */
/* Tables of noise for struct grain, with a sensor's correlations. */
#ifndef INLAY_HAL_LOOK_GRAIN_TABLES_H
#define INLAY_HAL_LOOK_GRAIN_TABLES_H

#include "hal/compositor/live/grain.h"
#include "hal/look/sensor_noise.h"

struct grain_tables {
	int8_t n[3][GRAIN_SIDE][GRAIN_SIDE];
	double across, down, channels; /* what they were made for */
	bool made;
};

/* Makes the tables where the model's correlations have moved by more than a twentieth, and sets
 * everything of *grain but its seed. The tables have mean 0 and variance 1 within a hundredth, and
 * are the same on every machine. */
void grain_tables_fit(struct grain_tables *tables, const struct sensor_noise_model *model,
		      struct grain *grain);

#endif
