/* SPDX-License-Identifier: MIT */
/*
 * Arrays of all drivers, in the order in which they are listed and tried. NULL ends each array.
 * Drivers that are left out of the build (WITH_X=0 in the Makefile) are missing.
 */
#ifndef INLAY_DRIVERS_DRIVERS_H
#define INLAY_DRIVERS_DRIVERS_H

#include "hal/device/buttons.h"
#include "hal/device/camera.h"
#include "hal/device/display.h"

extern const struct camera_ops *const camera_drivers[];
extern const struct display_ops *const display_drivers[];
extern const struct buttons_ops *const buttons_drivers[];

/* The drivers themselves, for the arrays and for tests; programs go through the arrays. */
extern const struct camera_ops camera_v4l2, camera_libcamera, camera_sim;
extern const struct display_ops display_kms, display_window, display_file, display_null;
extern const struct buttons_ops buttons_gpio, buttons_encoder, buttons_keyboard, buttons_script;

/* Tells the television behind a CEC adapter, like /dev/cec0, to wake or to go to standby. Blocks
 * until it has answered, mostly for some tenths of a second, or the kernel gives up, after a few
 * seconds. 0 or -errno. */
int cec_switch(const char *device, bool on, struct fault *fault);

#endif
