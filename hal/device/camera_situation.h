/* SPDX-License-Identifier: MIT */
/* What an error of a camera's device means for whoever looks at the screen. */
#ifndef INLAY_HAL_DEVICE_CAMERA_SITUATION_H
#define INLAY_HAL_DEVICE_CAMERA_SITUATION_H

#include "hal/device/camera.h"

/* err is negative, as Linux's drivers of cameras answer. */
enum camera_situation camera_situation_of(int err);

/* Of an opening that ended so: whether it would always, but for another configuration: what is no
 * camera, has no such format, or does not know what it is asked for. All else waiting may mend, as
 * what a USB camera says while the bus finds its order, or a digitizer before its source has. */
bool camera_is_hopeless(enum camera_situation situation, int err);

#endif
