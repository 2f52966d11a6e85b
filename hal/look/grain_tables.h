/* SPDX-License-Identifier: MIT */
/* Makes tables of noise for struct grain, correlated as a sensor's noise is. */
#ifndef INLAY_HAL_LOOK_GRAIN_TABLES_H
#define INLAY_HAL_LOOK_GRAIN_TABLES_H

#include "hal/compositor/live/grain.h"
#include "hal/look/sensor_noise.h"

struct grain_tables {
	int8_t n[3][GRAIN_SIDE][GRAIN_SIDE];
	double across, down, channels; /* the correlations that n was made with */
	bool made;
};

/* Sets all of *grain but its seed. Makes the tables anew if a correlation of the model has moved by
 * more than a twentieth. They have mean 0 and variance 1 within a hundredth, and are the same on
 * every machine. */
void grain_tables_fit(struct grain_tables *tables, const struct sensor_noise_model *model,
		      struct grain *grain);

#endif
