/* SPDX-License-Identifier: MIT */
/* Any bytes as a picture: a clear refusal, or a whole picture of light that is finite.
 *
 * reaches: image.c:image_check_light image_pfm.c:pfm_sample image_jpeg.c:jpeg_decode
 * image_png.c:ask_for_rgb image_png.c:png_source_take image_hdr.c:hdr_take_planes
 * image_hdr.c:hdr_take_pixels image_hdr.c:place_row
 * image_exr.cpp:check_colours image_exr.cpp:read_pixels image_exr.cpp:take_shown
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "hal/image/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {0};
	struct image image;
	size_t samples;

	if (image_read_memory(data, bytes, "fuzz", &image, &fault)) {
		if (!fault.text[0] || image.u8 || image.f32)
			abort();
		return 0;
	}
	samples = (size_t)image.width * (size_t)image.height * 3;
	if (!image.u8 == !image.f32 || !samples)
		abort();
	for (size_t i = 0; image.f32 && i < samples; i++)
		if (!isfinite(image.f32[i]) || image.f32[i] < 0)
			abort();
	image_free(&image);
	return 0;
}
