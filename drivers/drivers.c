/* SPDX-License-Identifier: MIT */
#include "drivers/drivers.h"

#include <stddef.h>

const struct camera_ops *const camera_drivers[] = {
	&camera_v4l2,
#if WITH_LIBCAMERA
	&camera_libcamera,
#endif
	&camera_sim,
	NULL,
};

const struct display_ops *const display_drivers[] = {
#if WITH_KMS
	&display_kms,
#endif
#if WITH_SDL
	&display_window,
#endif
	&display_file,	 &display_null, NULL,
};

const struct buttons_ops *const buttons_drivers[] = {
#if WITH_GPIO
	&buttons_gpio,	   &buttons_encoder,
#endif
	&buttons_keyboard, &buttons_script,  NULL,
};
