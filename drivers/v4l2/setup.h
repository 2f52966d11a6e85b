/* Bringing a V4L2 device to the point where buffers can be asked for. */
#ifndef INLAY_DRIVERS_V4L2_SETUP_H
#define INLAY_DRIVERS_V4L2_SETUP_H

#include "drivers/v4l2/formats.h"
#include "hal/camera.h"

/* Selects the input (-1: as it is) and takes over the television standard or HDMI timings that it
 * receives. -ENOLINK, -ENOLCK: there is no signal. */
int v4l2_setup_input(int fd, int input, struct fault *fault);

/* Chooses and sets format, size and rate as near to the settings as the device can, and reads back
 * what it really does; rate_hz is 0 when the device does not say. type is V4L2_BUF_TYPE_*. */
int v4l2_setup_picture(int fd, unsigned type, const struct camera_settings *settings,
		       struct v4l2_picture *picture, double *rate_hz, struct fault *fault);

#endif
