/*
 * The kiosk: cameras to screen, for as long as it is wanted.
 *
 * A picture is made when the background camera has a new frame and the screen a free buffer, from
 * the newest frame of each camera; frames that come in between are given back undecoded. Cameras
 * that make frames on demand (struct camera, on_demand) are waited for, each of them once a
 * picture, so that a run with nothing but such cameras gives the same pictures every time.
 *
 * A camera that waiting can mend (absent, busy, silent) is tried again every second, and its last
 * picture stays. It ends on a signal, a button, a closed window, after settings->frames pictures,
 * or with an error when the screen is gone.
 */
#ifndef INLAY_APP_KIOSK_H
#define INLAY_APP_KIOSK_H

#include <stdint.h>

#include "config/config.h"
#include "hal/fault.h"

struct kiosk_settings {
	const struct config *config; /* checked */
	uint64_t frames;	     /* then it ends; 0: never */
	const char *stats;	     /* a file for JSON lines, or NULL */
};

/* 0: it ended as it was asked to. */
int kiosk_run(const struct kiosk_settings *settings, struct fault *fault);

#endif
