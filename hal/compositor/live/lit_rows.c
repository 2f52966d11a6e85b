/* SPDX-License-Identifier: MIT */
#include "hal/compositor/live/lit_rows.h"

#include "hal/compositor/kernels/kernels.h"

void lit_rows_apply(int32_t (*values)[BASIS_TILE * BASIS_TILE], const int32_t (*rows)[3],
		    int height)
{
	for (int c = 0; c < 3; c++)
		for (int y = 0; y < height; y++) {
			int32_t *value = values[c] + y * BASIS_TILE;

			for (int x = 0; x < BASIS_TILE; x++) {
				const int64_t v = (value[x] * (int64_t)rows[y][c] + 32768) >> 16;

				value[x] = (int32_t)(v > KERNEL_LIMIT	 ? KERNEL_LIMIT
						     : v < -KERNEL_LIMIT ? -KERNEL_LIMIT
									 : v);
			}
		}
}
