/* SPDX-License-Identifier: MIT */
/* The situation that an error of a camera's device stands for. */
#ifndef INLAY_HAL_DEVICE_CAMERA_SITUATION_H
#define INLAY_HAL_DEVICE_CAMERA_SITUATION_H

#include "hal/device/camera.h"

/* err: negative errno of a Linux camera driver. */
enum camera_situation camera_situation_of(int err);

/* Whether an opening that failed like this would always fail under this configuration: the device
 * is no camera, or does not know the setting. Other failures may pass with time,
 * such as those of a USB camera while its bus starts or of a digitizer while its source starts. */
bool camera_is_hopeless(enum camera_situation situation, int err);

#endif
