/* SPDX-License-Identifier: MIT */
/*
 * A configuration for the devices that are plugged in, as `inlay devices --sample` writes it. It is
 * made of what the drivers list; of the lines in a listing it reads these:
 *
 *     cameras   "X FORMAT ...", where FORMAT is a pixel format of inlay; "link /dev/v4l/by-id/..."
 *     screens   "link /dev/dri/by-path/..."; "NAME: connected", and after it
 *               "  WxH RATE Hz (preferred)"
 *     buttons   "CHIP [LABEL], N lines" of the driver gpio
 *     any       "no permission", "Permission denied", "not for this user"
 */
#ifndef INLAY_APP_DEVICES_SAMPLE_H
#define INLAY_APP_DEVICES_SAMPLE_H

#include <stdio.h>

#include "hal/device/camera.h"
#include "hal/device/display.h"

struct devices_sample;

struct devices_sample *sample_create(void); /* NULL: no memory */
void sample_destroy(struct devices_sample *sample);

/* Add a device as its driver lists it; copied. Devices beyond the sample's room are counted
 * only. */
void sample_add_camera(struct devices_sample *sample, const char *driver,
		       const struct camera_listing *listing);
void sample_add_screen(struct devices_sample *sample, const char *driver,
		       const struct display_listing *listing);
void sample_add_buttons(struct devices_sample *sample, const char *driver, const char *line);

/* Number of devices that this user may not open, so that the sample leaves them out. */
int sample_refused(const struct devices_sample *sample);

/* Writes the configuration. Every key in it is valid; only the basis is left to the reader. */
void sample_write(const struct devices_sample *sample, FILE *stream);

#endif
