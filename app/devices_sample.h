/* SPDX-License-Identifier: MIT */
/*
 * A configuration for what is plugged in: what `inlay devices --sample` writes.
 *
 * It is made of what the drivers list, so a driver that says more makes a better sample. Of the
 * lines that listings hold for people, it looks for these:
 *     cameras   "X FORMAT ...", FORMAT one of ours; "link /dev/v4l/by-id/..."
 *     screens   "NAME: connected", and after it "  WxH RATE Hz (preferred)"
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

/* As the drivers list them; copied. What memory has no room for is left out. */
void sample_add_camera(struct devices_sample *sample, const char *driver,
		       const struct camera_listing *listing);
void sample_add_screen(struct devices_sample *sample, const char *driver,
		       const struct display_listing *listing);
void sample_add_buttons(struct devices_sample *sample, const char *driver, const char *line);

/* How many devices are there that this user may not open: the sample knows nothing of them. */
int sample_refused(const struct devices_sample *sample);

/* Every key that is written is valid; only the basis is left to the reader. */
void sample_write(const struct devices_sample *sample, FILE *stream);

#endif
