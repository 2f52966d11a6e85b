/* Why libcamera sees no camera. */
#ifndef INLAY_DRIVERS_LIBCAMERA_ABSENCE_H
#define INLAY_DRIVERS_LIBCAMERA_ABSENCE_H

#include "hal/fault.h"

/* -EACCES: there are devices, but not for this user; -ENODEV: anything else. */
int libcamera_absence(struct fault *fault);

#endif
