/* SPDX-License-Identifier: MIT */
/* Lists cards, connectors and modes for people. */
#ifndef INLAY_DRIVERS_KMS_LIST_H
#define INLAY_DRIVERS_KMS_LIST_H

#include "hal/device/display.h"

/* display_ops.list of KMS: calls found() for each card. Returns their number, or -ENOMEM. */
int kms_list(void (*found)(void *context, const struct display_listing *listing), void *context);

#endif
