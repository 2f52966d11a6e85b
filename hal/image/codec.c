/* SPDX-License-Identifier: MIT */
#include "hal/image/codec.h"

#include <errno.h>
#include <math.h>

#include "hal/base/budget.h"

int image_check_size(const struct image_source *source, int64_t width, int64_t height,
		     size_t pixel_bytes, struct fault *fault)
{
	const struct budget own = {.file_bytes = source->bytes};

	if (width < 1 || height < 1)
		return fault_say(fault, -EBADMSG, "%s: the header says %lld x %lld pixels",
				 source->name, (long long)width, (long long)height);
	if (width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX)
		return fault_say(fault, -EFBIG, "%s: %lld x %lld pixels, but a side has at most %d",
				 source->name, (long long)width, (long long)height, IMAGE_SIDE_MAX);
	if (source->width && (width != source->width || height != source->height))
		return fault_say(fault, -EINVAL, "%s: is %lldx%lld pixels, expected %dx%d %s",
				 source->name, (long long)width, (long long)height, source->width,
				 source->height, source->why);
	return budget_fits(&own, (double)width * (double)height * (double)pixel_bytes, source->name,
			   fault);
}

int image_check_primaries(const struct image_source *source, const double xy[8],
			  struct fault *fault)
{
	static const double srgb[8] = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.329};

	for (int k = 0; k < 8; k++)
		/* 0.03 admits Radiance's default primaries, whose white is that of equal energy.
		 * The negated comparison refuses NaN. */
		if (!(fabs(xy[k] - srgb[k]) < 0.03))
			return fault_say(
				fault, -ENOTSUP,
				"%s: its colours are of other primaries: red %g %g, green %g %g, blue %g %g, white %g %g, expected those of sRGB",
				source->name, xy[0], xy[1], xy[2], xy[3], xy[4], xy[5], xy[6],
				xy[7]);
	return 0;
}
