/* SPDX-License-Identifier: MIT */
#include "hal/colour/encode_row.h"

static uint8_t code_of_linear(const struct transfer_tables *tables, float linear)
{
	/* Written so that a NaN is black. */
	if (!(linear > 0))
		return tables->encode[0];
	return tables->encode[linear < 1 ? (int)(linear * 65535 + 0.5f) : 65535];
}

void encode_row(const struct transfer_tables *tables, const float *rgb, int pixels, uint8_t *bgrx)
{
	for (int x = 0; x < pixels; x++, rgb += 3, bgrx += 4) {
		bgrx[0] = code_of_linear(tables, rgb[2]);
		bgrx[1] = code_of_linear(tables, rgb[1]);
		bgrx[2] = code_of_linear(tables, rgb[0]);
		bgrx[3] = 255;
	}
}
