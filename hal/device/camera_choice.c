/* SPDX-License-Identifier: MIT */
#include "hal/device/camera_choice.h"

static const enum pixel_format cheapest_first[] = {
	PIXEL_BGRX,  PIXEL_BGR24, PIXEL_RGB24, PIXEL_YUYV, PIXEL_UYVY, PIXEL_YVYU,
	PIXEL_NV16,  PIXEL_NV12,  PIXEL_NV21,  PIXEL_YU12, PIXEL_YV12, PIXEL_P010,
	PIXEL_MJPEG, PIXEL_GREY,  PIXEL_Y16,   PIXEL_Y14,  PIXEL_Y12,  PIXEL_Y10,
};

enum { FORMATS = sizeof(cheapest_first) / sizeof(cheapest_first[0]) };

int camera_format_merit(enum pixel_format format, bool size, bool rate)
{
	if (format == PIXEL_Z16)
		return 1; /* no picture, but what a depth camera is opened for */
	if (format == PIXEL_H264)
		return 2; /* even where nothing else has the size: damage stays for seconds */
	for (int i = 0; i < FORMATS; i++)
		if (cheapest_first[i] == format)
			return FORMATS - i + 2 + (size ? FORMATS : 0) +
			       (size && rate ? FORMATS : 0);
	return 0;
}
