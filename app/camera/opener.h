/* SPDX-License-Identifier: MIT */
/*
 * Opens a camera on a thread of its own, because a device may be slow: the event loop goes on with
 * the other cameras and the screen. Thread and descriptor last as long as the opener, so that a
 * camera which is tried again every second makes no new ones.
 */
#ifndef INLAY_APP_CAMERA_OPENER_H
#define INLAY_APP_CAMERA_OPENER_H

#include <stdbool.h>

#include "hal/device/camera.h"

struct opener;

/* 0 or -errno. The thread has all signals blocked. */
int opener_create(struct opener **opener);

/* Begins to open the camera. camera, settings and options belong to the opener until opener_take()
 * has returned true. Not while another camera is being opened. */
void opener_start(struct opener *opener, struct camera *camera, const struct camera_ops *ops,
		  const struct camera_settings *settings, void *options);

/* Polls readable when opener_take() will return true. */
int opener_descriptor(const struct opener *opener);

/* False: the camera is still being opened. True, once: opening has ended; *err and *fault are what
 * camera_open() returned. */
bool opener_take(struct opener *opener, int *err, struct fault *fault);

/* Waits for an opening that has begun; then the camera belongs to the caller, perhaps open. NULL is
 * harmless. */
void opener_destroy(struct opener *opener);

#endif
