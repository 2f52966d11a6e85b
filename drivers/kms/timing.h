/* SPDX-License-Identifier: MIT */
/* Computes and parses modes that the screen has not reported. Pure: touches no device. */
#ifndef INLAY_DRIVERS_KMS_TIMING_H
#define INLAY_DRIVERS_KMS_TIMING_H

#include <stdbool.h>
#include <xf86drmMode.h>

/* Refresh rate in Hz, from the pixel clock and the totals; 0: the mode has no totals. */
double kms_mode_rate(const drmModeModeInfo *mode);

/* Makes a progressive mode: the standard timing for the size and rate if there is one (VESA DMT,
 * CTA-861), else VESA CVT with reduced blanking. */
void kms_timing(int width, int height, double rate_hz, drmModeModeInfo *mode);

/*
 * Reads "1920x1080", "1920x1080@50", or a modeline as cvt(1) prints it: clock in MHz, four numbers
 * across, four down, +hsync or -hsync, +vsync or -vsync. "Modeline" and a quoted name may stand
 * before it. *exact: the text was a modeline. 0, or -EINVAL: the text is neither.
 */
int kms_timing_parse(const char *text, drmModeModeInfo *mode, bool *exact);

#endif
