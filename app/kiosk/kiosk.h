/* SPDX-License-Identifier: MIT */
/*
 * The kiosk: cameras to screen, until it is told to end.
 *
 * It makes a picture when the background camera has a new frame and the screen has a free buffer,
 * from the newest frame of each camera. Frames that were superseded by then are given back
 * undecoded. Cameras that make frames on demand (struct camera, on_demand) are asked once for each
 * picture, and the kiosk waits for all of them, so that a run with such cameras alone gives the
 * same pictures every time. Where no frame comes, the kiosk draws the picture again every second,
 * so that the text on it stays true.
 *
 * Troubles that may pass (a camera, a screen or buttons that are absent, busy or silent) are tried
 * again every second, and the last picture stays. The kiosk ends on a signal, a button, a closed
 * window, after settings->frames pictures, or with an error: at the start one that waiting cannot
 * mend, later a screen that cannot come back, such as a file on a full disk.
 */
#ifndef INLAY_APP_KIOSK_KIOSK_H
#define INLAY_APP_KIOSK_KIOSK_H

#include <stdint.h>

#include "config/config.h"
#include "hal/base/fault.h"

struct kiosk_settings {
	struct config *config; /* checked; a reload changes it */
	uint64_t frames;       /* pictures on the screen after which it ends; 0: it goes on */
	const char *stats;     /* file for JSON lines (records.h), or NULL */
	/* Reads and checks the configuration again, at SIGHUP. 0 and a configuration that the
	 * caller owns, or -errno and none. Every fault goes to the report. */
	int (*reread)(void *context, struct config **fresh, struct ini_report *report);
	void *context;
};

/* 0: it ended as it was asked to; else -errno. */
int kiosk_run(const struct kiosk_settings *settings, struct fault *fault);

#endif
