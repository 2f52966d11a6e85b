/* SPDX-License-Identifier: MIT */
/* Any bytes as a lens of OpenCV or ROS: refused in a sentence, or a lens of finite numbers, which
 * ours is made of or refused in a sentence again.
 *
 * reaches: convert_read.c:take_matrix convert_read.c:take_distortion convert_read.c:take_size
 * convert_read.c:take_intrinsics convert.c:fit_three
 * convert.c:lens_to_fisheye
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "bake/calibrate/convert/convert.h"
#include "tests/support/as_file.h"

static int make_ours(const struct lens *lens, struct fault *fault)
{
	struct fisheye_settings settings;
	struct tsai_camera camera;
	double error_px;

	if (lens->fisheye)
		return lens_to_fisheye(lens, &settings, fault);
	return lens_to_tsai(lens, &camera, 1e6, &error_px, fault);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct lens lens = {.width = 0};

	if (!lens_read_foreign(&lens, as_file(data, bytes), NULL, &fault)) {
		for (int k = 0; k < LENS_TERMS; k++)
			if (!isfinite(lens.term[k]))
				abort();
		for (int i = 0; i < 2; i++)
			if (!isfinite(lens.centre_px[i]) || !(lens.focal_px[i] > 0))
				abort();
		if (lens.width < 1 || lens.height < 1)
			abort();
		if (!make_ours(&lens, &fault))
			return 0;
	}
	if (!*fault.text)
		abort();
	return 0;
}
