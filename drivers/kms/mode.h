/* SPDX-License-Identifier: MIT */
/* Chooses one of the modes that a screen reports. Pure: touches no device. */
#ifndef INLAY_DRIVERS_KMS_MODE_H
#define INLAY_DRIVERS_KMS_MODE_H

#include <stdbool.h>
#include <xf86drmMode.h>

#include "drivers/kms/options.h"
#include "hal/device/display.h"

/*
 * Chooses a progressive mode. Width or height 0 accepts any; if both are 0, the size is that of the
 * preferred mode, else of the first one. Among the modes of that size the one nearest to rate_hz
 * wins; with a rate of 0 the preferred one, else the first. Returns its index, or -1: there is
 * none.
 */
int kms_mode_choose(const drmModeModeInfo *modes, int count, int width, int height, double rate_hz);

enum { KMS_RANK_BEST = 3 };

/* Ranks a connector by its state (DRM_MODE_CONNECTED ...) and number of modes: 3 connected, 2 state
 * unknown but with modes or kms.mode, 1 used only because of kms.force, 0 unusable. */
int kms_mode_rank(unsigned connection, int count, const struct kms_options *options);

/*
 * Picks the mode for a connector in this state. *computed: the mode is a timing from timing.h, not
 * one that the screen reported. 0; -ENOLINK: there is no screen; -EINVAL: no mode fits the
 * settings.
 */
int kms_mode_pick(const struct display_settings *settings, const struct kms_options *options,
		  unsigned connection, const drmModeModeInfo *modes, int count,
		  drmModeModeInfo *mode, bool *computed);

/* Whether both modes have the same timing; names and type flags do not count. */
bool kms_mode_same(const drmModeModeInfo *a, const drmModeModeInfo *b);

#endif
