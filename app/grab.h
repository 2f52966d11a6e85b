/* SPDX-License-Identifier: MIT */
/* Still pictures of a camera of the configuration, for calibration. */
#ifndef INLAY_APP_GRAB_H
#define INLAY_APP_GRAB_H

#include "config/config.h"
#include "hal/image/image.h"

struct grab;

/*
 * Opens a camera. name: fisheye, background or scene, which is the upright view of its camera as
 * the kiosk cuts it out, or the name of a [camera NAME]; as_sent: its whole picture, as the camera
 * sends it. The configuration is borrowed. 0; -EINVAL: there is no such view or camera; or why it
 * cannot be opened.
 */
int grab_open(struct grab **grab, struct config *config, const char *name, bool as_sent,
	      struct fault *fault);
void grab_close(struct grab *grab); /* NULL is harmless */

/* Sets a control. 0 or -errno, as camera_set_control(). */
int grab_control(struct grab *grab, const char *name, const char *value, struct fault *fault);

/* Waits until exposure and white balance have settled after opening or after a control, and takes a
 * picture, R'G'B' of 8 bits, which the caller frees. 0; -ETIMEDOUT, -ENODEV ...: there was none. */
int grab_take(struct grab *grab, struct image *image, struct fault *fault);

#endif
