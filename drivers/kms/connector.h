/* SPDX-License-Identifier: MIT */
/* Reads the state of a connector while pictures flow. */
#ifndef INLAY_DRIVERS_KMS_CONNECTOR_H
#define INLAY_DRIVERS_KMS_CONNECTOR_H

#include <stdbool.h>
#include <stdint.h>
#include <xf86drmMode.h>

enum { KMS_MODES_MAX = 256 };

struct kms_connector {
	uint32_t id;
	uint32_t link_property; /* id of link-status, set by the caller; 0: the card has none */
	unsigned connection;	/* DRM_MODE_CONNECTED ... */
	bool link_failed;	/* the screen gets no picture until its mode is set again */
	int count;		/* modes */
	drmModeModeInfo modes[KMS_MODES_MAX];
};

/* Reads the state without allocating. probe: the kernel asks the screen, which may take tens of
 * milliseconds; otherwise it reports what it last knew. 0; -ENOENT, -ENODEV: the connector or card
 * is gone; -E2BIG: more than KMS_MODES_MAX modes, and modes are not filled in. */
int kms_connector_read(int card, uint32_t id, bool probe, struct kms_connector *connector);

#endif
