/* SPDX-License-Identifier: MIT */
/* Live pictures for calibration, from one view of the kiosk, opened as its configuration says. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_H

#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/colour/transfer.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"

enum live_view { LIVE_BACKGROUND, LIVE_FISHEYE };

struct live;

/* Reads the kiosk's configuration, opens and starts the camera that the view names. Faults name the
 * file, or the camera and its situation. -ENOENT, -EINVAL, -ENODEV, ...; -ENOMEM. */
int live_open(struct live **live, const char *config, enum live_view view, struct fault *fault);
void live_close(struct live *live); /* NULL is harmless */

/* Size of the upright picture: flips are undone; the squash is not, because lens models include
 * it. */
int live_width(const struct live *live);
int live_height(const struct live *live);

/*
 * Waits for the next frame, at most timeout_ms, and copies it into an upright 8-bit picture, which
 * is allocated at the first call and reused. captured_ns: CLOCK_MONOTONIC, from the camera.
 * -ETIMEDOUT; -ENODEV: the camera is gone; -ENOMEM.
 */
int live_next(struct live *live, int timeout_ms, struct image *picture, int64_t *captured_ns,
	      struct fault *fault);

/* The fisheye's lens, and the curve of the pictures that live_next() gives, by the configuration
 * and the calibration files that it names. Faults name the file. */
int live_lens(struct live *live, struct fisheye_settings *lens, struct transfer_curve *curve,
	      struct fault *fault);

/* Drops queued frames, so that the next frame is newer than this call. */
int live_flush(struct live *live, struct fault *fault);

#endif
