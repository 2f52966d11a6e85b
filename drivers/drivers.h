/*
 * Every driver there is, in the order in which they are listed and tried. Each array ends with
 * NULL. A driver that was left out of the build (WITH_X=0 in the Makefile) is not in it.
 */
#ifndef INLAY_DRIVERS_DRIVERS_H
#define INLAY_DRIVERS_DRIVERS_H

#include "hal/buttons.h"
#include "hal/camera.h"
#include "hal/display.h"

extern const struct camera_ops *const camera_drivers[];
extern const struct display_ops *const display_drivers[];
extern const struct buttons_ops *const buttons_drivers[];

#endif
