/* SPDX-License-Identifier: MIT */
/* Finds the card, connector, CRTC and plane that show the picture. */
#ifndef INLAY_DRIVERS_KMS_FIND_H
#define INLAY_DRIVERS_KMS_FIND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <xf86drmMode.h>

#include "drivers/kms/options.h"
#include "hal/base/fault.h"
#include "hal/device/display.h"

enum { KMS_CARDS = 16 }; /* /dev/dri/card0 to card15 are looked at */

/* The path that a picture takes: plane, CRTC, connector. */
struct kms_path {
	int card;	 /* descriptor; -1: none */
	char device[64]; /* path of the card, for messages */
	uint32_t connector, crtc, plane;
	char connector_name[32];
	drmModeModeInfo mode;
	bool computed; /* the screen has not reported this mode */
	/* Those that another screen uses; 0: none. */
	uint32_t taken_connector, taken_crtc, taken_plane;
};

/* Opens a card, non-blocking. Returns a descriptor that the caller closes, or -errno. */
int kms_card_open(const char *path);

/* Writes advice for a card that may not be opened: " (is the user in the group ...?)". */
void kms_card_remedy(const char *device, char *text, size_t room);

/* Writes the connector's name, like "HDMI-A-1". */
void kms_connector_name(const drmModeConnector *connector, char *name, size_t room);

/*
 * Opens the card of the settings, or the one with the best screen, and fills in the path. Returns
 * the descriptor (non-blocking; the caller closes it), or -errno with a fault that says what to do:
 * -ENODEV or -ENOENT no card, -ENOLINK no screen, -EINVAL no mode, -EACCES no permission, -ENOTSUP
 * the card lacks something that is needed.
 */
int kms_find(const struct display_settings *settings, const struct kms_options *options,
	     struct kms_path *path, struct fault *fault);

/* Fills in the path to that screen of the options' two which *first is not, on the same card: with
 * a mode of the first one's size where it has one. *path keeps the connector even if there is no
 * screen. 0 or -errno as above. */
int kms_find_second(const struct kms_options *options, const struct kms_path *first,
		    struct kms_path *path, struct fault *fault);

#endif
