/* SPDX-License-Identifier: MIT */
#include "hal/measure/background.h"

/* A bright floor that darkens to the left, tiles on it, grain, a dark quarter and a white bar. */
void background_fill(struct canvas *canvas)
{
	uint32_t grain = 1;

	for (int y = 0; y < canvas->height; y++) {
		for (int x = 0; x < canvas->width; x++) {
			uint8_t *to = canvas->pixels + (size_t)y * canvas->stride + (size_t)x * 4;
			const int across = 180 * x / canvas->width;
			const int down = 60 * y / canvas->height;
			const int tile = (x / 24 + y / 24) % 2 * 12;
			const int bar = x % 200 < 10;

			grain = grain * 1664525 + 1013904223;
			for (int c = 0; c < 3; c++) {
				int v = across + down + tile + (int)(grain >> (8 * c + 2) & 7);

				v -= c * (255 - v) / 16; /* warmer where it is dark */
				if (x < canvas->width / 2 && y > canvas->height / 2)
					v /= 4;
				v = bar ? 255 : v;
				to[2 - c] = (uint8_t)(v < 0 ? 0 : v > 255 ? 255 : v);
			}
			to[3] = 255;
		}
	}
}

struct compositor_settings background_settings(enum compositor_mode mode)
{
	return (struct compositor_settings){
		.mode = mode,
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = 1,
		.object = true,
	};
}
