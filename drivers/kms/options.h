/* SPDX-License-Identifier: MIT */
/* The keys of the KMS display: [screen] kms.*. */
#ifndef INLAY_DRIVERS_KMS_OPTIONS_H
#define INLAY_DRIVERS_KMS_OPTIONS_H

#include <stdbool.h>

#include "hal/ini/ini.h"

enum kms_scaling { KMS_SCALING_AUTO, KMS_SCALING_NEVER };
enum kms_range { KMS_RANGE_AUTO, KMS_RANGE_FULL, KMS_RANGE_LIMITED };

struct kms_options {
	char connector[INI_TEXT_MAX]; /* like HDMI-A-1; empty: the first with a screen */
	char second[INI_TEXT_MAX];    /* the connector of a second screen; empty: none */
	char mode[INI_TEXT_MAX];      /* size and rate, or a modeline; empty: one of the screen's */
	bool force;		      /* use a connector that reports no screen */
	int buffers;		      /* framebuffers, 2 or 3 */
	int scaling;		      /* enum kms_scaling */
	int range;		      /* enum kms_range */
	char vt[INI_TEXT_MAX];	      /* "/dev/tty1" or "auto"; empty: no console is taken */
};

#endif
