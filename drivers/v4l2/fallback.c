/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>
#include <string.h>

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
