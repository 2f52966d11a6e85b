/* What an error of a camera's device means for whoever looks at the screen. */
#ifndef INLAY_HAL_CAMERA_SITUATION_H
#define INLAY_HAL_CAMERA_SITUATION_H

#include "hal/camera.h"

/* err is negative, as Linux's drivers of cameras answer. */
enum camera_situation camera_situation_of(int err);

#endif
