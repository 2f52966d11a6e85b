/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { OFFERS_MAX = 256 };

/* Names what the camera has, each format once, and what was wanted. */
static int refuse_offers(const struct v4l2_offer *offers, int count, int wanted, const char *why,
			 struct fault *fault)
{
	char text[96] = "", code[5];

	for (int i = 0; i < count; i++) {
		const size_t used = strlen(text);

		v4l2_fourcc_text(offers[i].fourcc, code);
		code[strcspn(code, " ")] = '\0';
		if (!strstr(text, code))
			snprintf(text + used, sizeof(text) - used, "%s%s", used ? ", " : "", code);
	}
	return fault_say(fault, -ENOTSUP, "the camera offers %s, expected %s%s%s",
			 count ? text : "no format",
			 wanted ? pixel_format_names[wanted]
				: "MJPEG, YUYV or another one that inlay decodes",
			 *why ? "; " : "", why);
}

static int format_choose(int fd, unsigned type, const struct camera_settings *settings,
			 uint32_t *fourcc, struct fault *fault)
{
	struct v4l2_offer offers[OFFERS_MAX];
	struct fault why = {""};
	int count = 0, best;

	while (count < OFFERS_MAX) {
		struct v4l2_fmtdesc format = {.index = (unsigned)count, .type = type};

		if (device_ioctl(fd, VIDIOC_ENUM_FMT, &format))
			break;
		offers[count++] = (struct v4l2_offer){
			.fourcc = format.pixelformat,
			.size = v4l2_offers_size(fd, format.pixelformat, settings->width,
						 settings->height),
			.rate = v4l2_offers_rate(fd, format.pixelformat, settings->width,
						 settings->height, settings->rate_hz),
		};
	}
	best = v4l2_choose(offers, count, (enum pixel_format)settings->format);
	if (best < 0 || (offers[best].fourcc == V4L2_PIX_FMT_H264 && h264_available(&why)))
		return refuse_offers(offers, count, settings->format, why.text, fault);
	*fourcc = offers[best].fourcc;
	return 0;
}

/* The wanted format; height is that of the whole picture. A size of 0 is the device's choice. */
struct format_request {
	uint32_t fourcc, field;
	unsigned width, height;
};

/* Returns the lines to ask for: half the picture's height if a buffer holds one field. */
static unsigned lines_asked(const struct format_request *request, uint32_t field_now,
			    unsigned height_now)
{
	const unsigned now = V4L2_FIELD_HAS_T_OR_B(field_now) ? height_now * 2 : height_now;
	const unsigned whole = request->height ? request->height : now;

	return V4L2_FIELD_HAS_T_OR_B(request->field) ? whole / 2 : whole;
}

static uint32_t field_of(const struct v4l2_format *format)
{
	return format->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE ? format->fmt.pix_mp.field
								  : format->fmt.pix.field;
}

static unsigned height_of(const struct v4l2_format *format)
{
	return format->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE ? format->fmt.pix_mp.height
								  : format->fmt.pix.height;
}

/* Asks for a format. Strides and sizes in memory are 0: the driver chooses them. */
static int format_ask(int fd, const struct format_request *request, struct v4l2_format *format,
		      struct fault *fault)
{
	const unsigned lines = lines_asked(request, field_of(format), height_of(format));
	int err;

	if (format->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
		struct v4l2_pix_format_mplane *m = &format->fmt.pix_mp;

		m->pixelformat = request->fourcc;
		m->width = request->width ? request->width : m->width;
		m->height = lines;
		m->field = request->field;
		memset(m->plane_fmt, 0, sizeof(m->plane_fmt));
	} else {
		struct v4l2_pix_format *p = &format->fmt.pix;

		p->pixelformat = request->fourcc;
		p->width = request->width ? request->width : p->width;
		p->height = lines;
		p->field = request->field;
		p->bytesperline = 0;
		p->sizeimage = 0;
	}
	err = device_ioctl(fd, VIDIOC_S_FMT, format);
	if (err)
		return fault_say(fault, err, "cannot set the camera's format: %s",
				 err == -EBUSY ? "another program uses it" : strerror(-err));
	return 0;
}

static int set_format(int fd, const struct format_request *wanted, struct v4l2_format *format,
		      struct fault *fault)
{
	struct format_request request = *wanted;
	int err = device_ioctl(fd, VIDIOC_G_FMT, format);

	if (err)
		return fault_say(fault, err, "cannot read the camera's format: %s", strerror(-err));
	err = format_ask(fd, &request, format, fault);
	if (err || request.height == 0 || field_of(format) != V4L2_FIELD_ALTERNATE ||
	    height_of(format) < request.height)
		return err;
	/* The device sends alternating fields, although not asked for, each as high as the picture
	 * should be. */
	request.field = V4L2_FIELD_ALTERNATE;
	return format_ask(fd, &request, format, fault);
}

/* Makes the picture fill the buffer. A device that can compose into a part of the buffer keeps the
 * setting of the last program, and never writes the rest. Most devices cannot compose; that is no
 * fault. */
static void fill_memory(int fd, const struct v4l2_picture *picture)
{
	struct v4l2_selection whole = {
		.type = V4L2_BUF_TYPE_VIDEO_CAPTURE, /* for both kinds of planes */
		.target = V4L2_SEL_TGT_COMPOSE,
		.r = {.width = (unsigned)picture->width, .height = (unsigned)picture->rows}};

	(void)device_ioctl(fd, VIDIOC_S_SELECTION, &whole);
}

/* Sets the rate and returns the one that the device uses, in Hz; 0: not known. Many devices cannot
 * set it; that is no fault. */
static double set_rate(int fd, unsigned type, double wanted_hz)
{
	struct v4l2_streamparm parameters = {.type = type};
	struct v4l2_fract *interval = &parameters.parm.capture.timeperframe;

	if (device_ioctl(fd, VIDIOC_G_PARM, &parameters))
		return 0;
	if (wanted_hz > 0 && parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) {
		interval->numerator = 1000;
		interval->denominator = (unsigned)lrint(wanted_hz * 1000);
		if (device_ioctl(fd, VIDIOC_S_PARM, &parameters))
			return 0;
	}
	return v4l2_rate_of(interval);
}

int v4l2_setup_picture(int fd, unsigned type, const struct camera_settings *settings,
		       enum v4l2_field_wish wish, const struct v4l2_source *source,
		       struct v4l2_picture *picture, double *rate_hz, struct fault *fault)
{
	struct format_request request = {.field = v4l2_field_asked(wish, source->standard),
					 .width = (unsigned)settings->width,
					 .height = (unsigned)settings->height};
	const enum pixel_format wanted = (enum pixel_format)settings->format;
	struct v4l2_format format = {.type = type};
	int err;

	err = format_choose(fd, type, settings, &request.fourcc, fault);
	if (!err)
		err = set_format(fd, &request, &format, fault);
	if (err == -ENOSPC) /* for v4l2_fallback_step() */
		*picture = (struct v4l2_picture){.layout = v4l2_layout_as(request.fourcc, wanted),
						 .width = settings->width,
						 .height = settings->height};
	if (!err)
		err = v4l2_picture_of(&format, source->standard, settings->height, picture, fault);
	if (err)
		return err;
	picture->layout = v4l2_layout_as(picture->layout->fourcc, wanted);
	if (settings->format && (int)picture->layout->format != settings->format)
		return fault_say(fault, -ENOTSUP, "the camera answered with %s, expected %s",
				 pixel_format_names[picture->layout->format],
				 pixel_format_names[settings->format]);
	fill_memory(fd, picture);
	if (settings->matrix)
		picture->matrix = (enum colour_matrix)(settings->matrix - 1);
	if (settings->range)
		picture->range = (enum colour_range)(settings->range - 1);
	*rate_hz = set_rate(fd, type, settings->rate_hz);
	return 0;
}
