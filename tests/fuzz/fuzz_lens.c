/* Any bytes as a lens of OpenCV or ROS: refused in a sentence, or a lens of finite numbers, which
 * ours is made of or refused in a sentence again. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bake/calibrate/convert.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static int make_ours(const struct lens *lens, struct fault *fault)
{
	struct fisheye_settings settings;
	struct tsai_camera camera;
	double error_px, turn_deg;

	if (lens->fisheye)
		return lens_to_fisheye(lens, &settings, fault);
	return lens_to_tsai(lens, &camera, 1e6, &error_px, &turn_deg, fault);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static int file = -1;
	struct fault fault = {.text = ""};
	struct lens lens = {.width = 0};
	char path[64];

	if (file < 0)
		file = memfd_create("lens", MFD_CLOEXEC);
	if (file < 0 || ftruncate(file, 0) || pwrite(file, data, bytes, 0) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	if (!lens_read_yaml(&lens, path, &fault)) {
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
