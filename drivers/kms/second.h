/* SPDX-License-Identifier: MIT */
/*
 * A second screen of the same card that shows the same buffers, at a mode of its own. It comes and
 * goes without the first one noticing.
 */
#ifndef INLAY_DRIVERS_KMS_SECOND_H
#define INLAY_DRIVERS_KMS_SECOND_H

#include "drivers/kms/connector.h"
#include "drivers/kms/state.h"

struct kms_second {
	struct kms_path path; /* card borrowed; connector 0: not found yet */
	struct kms_properties properties;
	struct kms_state before, ours;
	struct kms_connector connector;
	bool kept;  /* before is filled in */
	bool shown; /* it shows what the first one shows, with each flip */
};

/* Finds the connector that *first does not use and shows a framebuffer of width x height on it.
 * Nothing happens if it is shown already, or if there is no screen. A failure is logged. */
void kms_second_show(struct kms_second *second, const struct kms_options *options,
		     const struct kms_path *first, uint32_t framebuffer);

/* Looks whether the screen has come or gone, or has other modes, and shows or leaves it. probe: as
 * for kms_connector_read(). */
void kms_second_look(struct kms_second *second, const struct kms_options *options,
		     const struct kms_path *first, uint32_t framebuffer, bool probe);

/* Switches it off; waits for a pending flip. */
void kms_second_hide(struct kms_second *second);

/* Restores what was found. Idempotent. */
void kms_second_release(struct kms_second *second);

#endif
