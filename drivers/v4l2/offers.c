/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

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

static const char *const words[] = {"format", "size", "rate"};

static int add_word(struct v4l2_fallback *f, const char *word, size_t length)
{
	for (int i = 0; i < V4L2_GIVE_COUNT; i++) {
		if (strlen(words[i]) != length || strncmp(words[i], word, length) != 0)
			continue;
		for (int k = 0; k < f->count; k++)
			if (f->order[k] == (enum v4l2_sacrifice)i)
				return -EINVAL;
		f->order[f->count++] = (enum v4l2_sacrifice)i;
		return 0;
	}
	return -EINVAL;
}

int v4l2_fallback_read(struct v4l2_fallback *f, const char *give_up, struct fault *fault)
{
	static const char between[] = " \t,";
	const char *word = give_up;

	*f = (struct v4l2_fallback){.count = 0};
	for (;;) {
		size_t length;

		word += strspn(word, between);
		if (!*word)
			return 0;
		length = strcspn(word, between);
		if (add_word(f, word, length))
			return fault_say(
				fault, -EINVAL,
				"give_up: \"%.*s\", expected each of format, size, rate at most once",
				(int)length, word);
		word += length;
	}
}

/* Grey has no colour; H.264 is taken only when it is wished for, or there is nothing else. */
static bool is_substitute(uint32_t fourcc)
{
	return fourcc != V4L2_PIX_FMT_GREY && fourcc != V4L2_PIX_FMT_H264;
}

/* Chooses the smallest substitute, if it is smaller than the present format. */
static bool smaller_format(int fd, unsigned type, const struct v4l2_picture *picture,
			   struct camera_settings *settings)
{
	const struct v4l2_layout *best = NULL;
	int least = v4l2_bits(picture->layout->fourcc);

	for (unsigned i = 0;; i++) {
		struct v4l2_fmtdesc format = {.index = i, .type = type};
		const int bits = device_ioctl(fd, VIDIOC_ENUM_FMT, &format)
					 ? -1
					 : v4l2_bits(format.pixelformat);

		if (bits < 0)
			break;
		if (bits == 0 || bits >= least || !is_substitute(format.pixelformat) ||
		    !v4l2_offers_size(fd, format.pixelformat, settings->width, settings->height))
			continue;
		least = bits;
		best = v4l2_layout_of(format.pixelformat);
	}
	if (best)
		settings->format = (int)best->format;
	return best != NULL;
}

/* Whether the same sacrifice may be made again. */
static bool sacrifice_repeats(enum v4l2_sacrifice what)
{
	return what != V4L2_GIVE_FORMAT;
}

static bool sacrifice_make(enum v4l2_sacrifice what, int fd, unsigned type,
			   const struct v4l2_picture *picture, struct camera_settings *settings)
{
	const uint32_t fourcc = picture->layout->fourcc;

	switch (what) {
	case V4L2_GIVE_FORMAT:
		return smaller_format(fd, type, picture, settings);
	case V4L2_GIVE_SIZE:
		return v4l2_smaller_size(fd, fourcc, &settings->width, &settings->height);
	default:
		return v4l2_slower_rate(fd, fourcc, settings->width, settings->height,
					&settings->rate_hz);
	}
}

bool v4l2_fallback_step(struct v4l2_fallback *f, int fd, unsigned type,
			const struct v4l2_picture *picture, double rate_hz,
			struct camera_settings *settings)
{
	settings->format = (int)picture->layout->format;
	settings->width = picture->width;
	settings->height = picture->height;
	settings->rate_hz = rate_hz;
	while (f->next < f->count) {
		const enum v4l2_sacrifice what = f->order[f->next];
		const bool lessened = sacrifice_make(what, fd, type, picture, settings);

		if (!lessened || !sacrifice_repeats(what))
			f->next++;
		if (lessened)
			return true;
	}
	return false;
}

void v4l2_describe(const struct v4l2_picture *picture, double rate_hz, char *text, size_t room)
{
	int used = snprintf(text, room, "%dx%d %s", picture->width, picture->height,
			    pixel_format_names[picture->layout->format]);

	if (rate_hz > 0 && used > 0 && (size_t)used < room)
		snprintf(text + used, room - (size_t)used, " at %.4g Hz", rate_hz);
}
