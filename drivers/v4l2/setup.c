#include "drivers/v4l2/setup.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "drivers/v4l2/device.h"

enum { OFFERS_MAX = 256 };

static int take_timings(int fd, struct fault *fault)
{
	struct v4l2_dv_timings timings = {0};
	int err = device_ioctl(fd, VIDIOC_QUERY_DV_TIMINGS, &timings);

	if (err == -ENOLINK || err == -ENOLCK)
		return fault_say(fault, err, "no signal at the camera's input");
	if (err)
		return 0; /* it cannot tell: keep what is set */
	err = device_ioctl(fd, VIDIOC_S_DV_TIMINGS, &timings);
	if (err)
		return fault_say(fault, err, "the input's timings are out of the camera's range");
	return 0;
}

/* A driver that finds no signal reports all standards, or none. */
static void take_standard(int fd)
{
	v4l2_std_id standard = 0;

	if (device_ioctl(fd, VIDIOC_QUERYSTD, &standard) == 0 && standard != 0 &&
	    standard != V4L2_STD_ALL)
		(void)device_ioctl(fd, VIDIOC_S_STD, &standard);
}

int v4l2_setup_input(int fd, int input, struct fault *fault)
{
	struct v4l2_input current = {0};
	int index = input, err;

	if (input >= 0) {
		err = device_ioctl(fd, VIDIOC_S_INPUT, &index);
		if (err)
			return fault_say(fault, err, "v4l2.input: the camera has no input %d",
					 input);
	} else if (device_ioctl(fd, VIDIOC_G_INPUT, &index)) {
		return 0; /* no inputs to choose from */
	}
	current.index = (unsigned)index;
	if (device_ioctl(fd, VIDIOC_ENUMINPUT, &current))
		return 0;
	if (current.capabilities & V4L2_IN_CAP_DV_TIMINGS)
		return take_timings(fd, fault);
	if (current.capabilities & V4L2_IN_CAP_STD)
		take_standard(fd);
	return 0;
}

/* A device that does not enumerate sizes may have any. */
static bool offers_size(int fd, uint32_t fourcc, const struct camera_settings *settings)
{
	const unsigned w = (unsigned)settings->width, h = (unsigned)settings->height;

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

/* Whether an interval is short enough; rates are often a hair off (29.97 for 30). */
static bool fast_enough(const struct v4l2_fract *interval, double rate_hz)
{
	return interval->numerator * rate_hz <= interval->denominator * 1.01;
}

static bool offers_rate(int fd, uint32_t fourcc, const struct camera_settings *settings)
{
	if (settings->rate_hz <= 0 || settings->width == 0 || settings->height == 0)
		return true;
	for (unsigned i = 0;; i++) {
		struct v4l2_frmivalenum rate = {.index = i,
						.pixel_format = fourcc,
						.width = (unsigned)settings->width,
						.height = (unsigned)settings->height};

		if (device_ioctl(fd, VIDIOC_ENUM_FRAMEINTERVALS, &rate))
			return i == 0;
		if (rate.type != V4L2_FRMIVAL_TYPE_DISCRETE)
			return fast_enough(&rate.stepwise.min, settings->rate_hz);
		if (fast_enough(&rate.discrete, settings->rate_hz))
			return true;
	}
}

static int choose(int fd, unsigned type, const struct camera_settings *settings, uint32_t *fourcc,
		  struct fault *fault)
{
	struct v4l2_offer offers[OFFERS_MAX];
	int count = 0, best;

	while (count < OFFERS_MAX) {
		struct v4l2_fmtdesc format = {.index = (unsigned)count, .type = type};

		if (device_ioctl(fd, VIDIOC_ENUM_FMT, &format))
			break;
		offers[count++] = (struct v4l2_offer){
			.fourcc = format.pixelformat,
			.size = offers_size(fd, format.pixelformat, settings),
			.rate = offers_rate(fd, format.pixelformat, settings),
		};
	}
	best = v4l2_choose(offers, count, (enum pixel_format)settings->format);
	if (best < 0)
		return fault_say(fault, -ENOTSUP,
				 "the camera offers %d formats, but none that is expected (%s)",
				 count,
				 settings->format ? pixel_format_names[settings->format]
						  : "YUYV, UYVY, NV12, RGB24, BGR24, BGRX, GREY, "
						    "MJPEG");
	*fourcc = offers[best].fourcc;
	return 0;
}

static int set_format(int fd, unsigned type, uint32_t fourcc,
		      const struct camera_settings *settings, struct v4l2_format *format,
		      struct fault *fault)
{
	int err;

	memset(format, 0, sizeof(*format));
	format->type = type;
	err = device_ioctl(fd, VIDIOC_G_FMT, format);
	if (err)
		return fault_say(fault, err, "cannot read the camera's format: %s", strerror(-err));
	if (type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE) {
		struct v4l2_pix_format_mplane *m = &format->fmt.pix_mp;

		m->pixelformat = fourcc;
		m->width = settings->width ? (unsigned)settings->width : m->width;
		m->height = settings->height ? (unsigned)settings->height : m->height;
		m->field = V4L2_FIELD_ANY;
		memset(m->plane_fmt, 0, sizeof(m->plane_fmt)); /* strides for the driver to say */
	} else {
		struct v4l2_pix_format *p = &format->fmt.pix;

		p->pixelformat = fourcc;
		p->width = settings->width ? (unsigned)settings->width : p->width;
		p->height = settings->height ? (unsigned)settings->height : p->height;
		p->field = V4L2_FIELD_ANY;
		p->bytesperline = 0;
		p->sizeimage = 0;
	}
	err = device_ioctl(fd, VIDIOC_S_FMT, format);
	if (err)
		return fault_say(fault, err, "cannot set the camera's format: %s", strerror(-err));
	return 0;
}

/* Many devices have no say in their rate; that is no fault. */
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
	return interval->numerator ? (double)interval->denominator / interval->numerator : 0;
}

int v4l2_setup_picture(int fd, unsigned type, const struct camera_settings *settings,
		       struct v4l2_picture *picture, double *rate_hz, struct fault *fault)
{
	struct v4l2_format format;
	uint32_t fourcc = 0;
	int err = choose(fd, type, settings, &fourcc, fault);

	if (!err)
		err = set_format(fd, type, fourcc, settings, &format, fault);
	if (err)
		return err;
	err = v4l2_picture_of(&format, picture);
	if (err)
		return fault_say(fault, err,
				 "the camera answered with a picture that cannot be "
				 "read");
	if (settings->format && (int)picture->layout->format != settings->format)
		return fault_say(fault, -ENOTSUP, "the camera answered with %s, expected %s",
				 pixel_format_names[picture->layout->format],
				 pixel_format_names[settings->format]);
	if (settings->matrix)
		picture->matrix = (enum colour_matrix)(settings->matrix - 1);
	if (settings->range)
		picture->range = (enum colour_range)(settings->range - 1);
	*rate_hz = set_rate(fd, type, settings->rate_hz);
	return 0;
}
