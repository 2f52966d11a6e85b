/* SPDX-License-Identifier: MIT */
/*
 * Opens a camera on a thread of its own, because a device may take its time: the event loop goes on
 * meanwhile with the other cameras and the screen. The thread and its descriptor last as long as
 * the opener, so that a camera which is tried again every second costs neither.
 */
#ifndef INLAY_APP_CAMERA_OPENER_H
#define INLAY_APP_CAMERA_OPENER_H

#include <stdbool.h>

#include "hal/device/camera.h"

struct opener;

/* 0 or -errno. The thread has all signals blocked. */
int opener_create(struct opener **opener);

/* camera is the opener's, as are settings and options, until opener_take() says that it ended. Not
 * while another one is being opened. */
void opener_start(struct opener *opener, struct camera *camera, const struct camera_ops *ops,
		  const struct camera_settings *settings, void *options);

/* Polls readable when opener_take() will tell the result. */
int opener_descriptor(const struct opener *opener);

/* False: it is still being opened. True, once: err and fault are what camera_open() said. */
bool opener_take(struct opener *opener, int *err, struct fault *fault);

/* Waits until an opening that has begun has ended; the camera is the caller's then, perhaps open.
 * NULL is harmless. */
void opener_destroy(struct opener *opener);

#endif
