/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

double v4l2_rate_of(const struct v4l2_fract *interval)
{
	return interval->numerator ? (double)interval->denominator / interval->numerator : 0;
}

bool v4l2_offers_kind(int fd, unsigned type, bool depth)
{
	for (unsigned i = 0;; i++) {
		struct v4l2_fmtdesc format = {.index = i, .type = type};

		if (device_ioctl(fd, VIDIOC_ENUM_FMT, &format))
			return i == 0 && !depth;
		if ((format.pixelformat == V4L2_PIX_FMT_Z16) == depth)
			return true;
	}
}

bool v4l2_offers_size(int fd, uint32_t fourcc, int width, int height)
{
	const unsigned w = (unsigned)width, h = (unsigned)height;

	if (w == 0 || h == 0)
		return true;
	for (unsigned i = 0;; i++) {
		struct v4l2_frmsizeenum size = {.index = i, .pixel_format = fourcc};
		const struct v4l2_frmsize_stepwise *s = &size.stepwise;

		if (device_ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &size))
			return i == 0;
		if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE)
			return w >= s->min_width && w <= s->max_width && h >= s->min_height &&
			       h <= s->max_height;
		if (size.discrete.width == w && size.discrete.height == h)
			return true;
	}
}

/* Whether an interval is short enough, to 1 %: rates are often a little off (29.97 for 30). */
static bool fast_enough(const struct v4l2_fract *interval, double rate_hz)
{
	return interval->numerator * rate_hz <= interval->denominator * 1.01;
}

bool v4l2_offers_rate(int fd, uint32_t fourcc, int width, int height, double rate_hz)
{
	if (rate_hz <= 0 || width == 0 || height == 0)
		return true;
	for (unsigned i = 0;; i++) {
		struct v4l2_frmivalenum rate = {.index = i,
						.pixel_format = fourcc,
						.width = (unsigned)width,
						.height = (unsigned)height};

		if (device_ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &rate))
			return i == 0;
		if (rate.type != V4L2_FRMIVAL_TYPE_DISCRETE)
			return fast_enough(&rate.stepwise.min, rate_hz);
		if (fast_enough(&rate.discrete, rate_hz))
			return true;
	}
}

/* Halves each side, for a device that offers a range of sizes. */
static bool half_size(const struct v4l2_frmsize_stepwise *s, int *width, int *height)
{
	const int w = *width / 2, h = *height / 2;

	if (*width % 4 || *height % 4 || w < (int)s->min_width || h < (int)s->min_height)
		return false;
	*width = w;
	*height = h;
	return true;
}

bool v4l2_smaller_size(int fd, uint32_t fourcc, int *width, int *height)
{
	int64_t best = 0, w = *width, h = *height;

	for (unsigned i = 0;; i++) {
		struct v4l2_frmsizeenum size = {.index = i, .pixel_format = fourcc};
		int64_t sw, sh;

		if (device_ioctl(fd, VIDIOC_ENUM_FRAMESIZES, &size))
			return best > 0;
		if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE)
			return half_size(&size.stepwise, width, height);
		sw = size.discrete.width;
		sh = size.discrete.height;
		if (sw < w && sw * h == sh * w && sw > best) {
			best = sw;
			*width = (int)sw;
			*height = (int)sh;
		}
	}
}

bool v4l2_slower_rate(int fd, uint32_t fourcc, int width, int height, double *rate_hz)
{
	double best = 0;

	for (unsigned i = 0;; i++) {
		struct v4l2_frmivalenum rate = {.index = i,
						.pixel_format = fourcc,
						.width = (unsigned)width,
						.height = (unsigned)height};
		double hz;

		if (device_ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &rate))
			break;
		if (rate.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
			hz = *rate_hz / 2;
			best = hz >= v4l2_rate_of(&rate.stepwise.max) ? hz : 0;
			break;
		}
		hz = v4l2_rate_of(&rate.discrete);
		if (hz < *rate_hz * 0.99 && hz > best)
			best = hz;
	}
	if (best > 0)
		*rate_hz = best;
	return best > 0;
}
