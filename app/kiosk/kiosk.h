/* SPDX-License-Identifier: MIT */
/*
 * The kiosk: cameras to screen, for as long as it is wanted.
 *
 * A picture is made when the background camera has a new frame and the screen a free buffer, from
 * the newest frame of each camera; frames that come in between are given back undecoded. Cameras
 * that make frames on demand (struct camera, on_demand) are waited for, each of them once a
 * picture, so that a run with nothing but such cameras gives the same pictures every time. Where no
 * frame comes the picture is drawn again every second, so that the text on it is true.
 *
 * What waiting can mend (a camera, a screen, buttons that are absent, busy, silent) is tried again
 * every second, and the last picture stays. It ends on a signal, a button, a closed window, after
 * settings->frames pictures, or with an error: at the start what waiting cannot mend, later a
 * screen that cannot come back, such as a file on a full disk.
 */
#ifndef INLAY_APP_KIOSK_KIOSK_H
#define INLAY_APP_KIOSK_KIOSK_H

#include <stdint.h>

#include "config/config.h"
#include "hal/base/fault.h"

struct kiosk_settings {
	struct config *config; /* checked; a reload changes it */
	uint64_t frames;       /* then it ends; 0: never */
	const char *stats;     /* a file for JSON lines, or NULL */
	/* Reads and checks the configuration again, at SIGHUP. 0 and the caller's own, or -errno
	 * and nothing. Every fault goes to the report. */
	int (*reread)(void *context, struct config **fresh, struct ini_report *report);
	void *context;
};

/* 0: it ended as it was asked to. */
int kiosk_run(const struct kiosk_settings *settings, struct fault *fault);

#endif
