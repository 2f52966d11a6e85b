/* SPDX-License-Identifier: MIT */
/* Properties of the connector that describe the panel behind it. */
#ifndef INLAY_DRIVERS_KMS_PANEL_H
#define INLAY_DRIVERS_KMS_PANEL_H

#include <stdint.h>

#include "drivers/kms/find.h"
#include "hal/frame/frame.h"

/* By how much a picture has to be turned to be upright on the panel, as it is built in ("panel
 * orientation"). Upright where the kernel does not know. */
enum picture_turn kms_panel_turn(const struct kms_path *path);

/* Finds the value of an enumerated property by its name. 0 or -ENOENT. */
int kms_panel_value(int card, uint32_t property, const char *name, uint64_t *value);

/* The name in "Broadcast RGB" of a range of [screen] kms.range. */
const char *kms_range_name(enum kms_range range);

#endif
