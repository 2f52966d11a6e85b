/* SPDX-License-Identifier: MIT */
/*
 * Linear radiance in floats to 8-bit code values:
 *
 *     code = encode[floor(65535 * min(max(radiance, 0), 1) + 1/2)]
 *
 * with encode[] of struct transfer_tables (transfer.h).
 */
#ifndef INLAY_HAL_COLOUR_ENCODE_ROW_H
#define INLAY_HAL_COLOUR_ENCODE_ROW_H

#include <stdint.h>

#include "hal/colour/transfer.h"

/* Encodes a row. rgb[3 * pixels]: R, G, B of each pixel, 1 is white; any float is allowed, NaN and
 * negative values become black. bgrx[4 * pixels]: B, G, R, 255; does not overlap rgb. */
void encode_row(const struct transfer_tables *tables, const float *rgb, int pixels, uint8_t *bgrx);

#endif
