/* SPDX-License-Identifier: MIT */
#include "hal/device/camera_choice.h"

static const enum pixel_format cheapest_first[] = {
	PIXEL_BGRX, PIXEL_BGR24, PIXEL_RGB24, PIXEL_YUYV,
	PIXEL_UYVY, PIXEL_NV12,	 PIXEL_MJPEG, PIXEL_GREY,
};

enum { FORMATS = sizeof(cheapest_first) / sizeof(cheapest_first[0]) };

int camera_format_merit(enum pixel_format format, bool size, bool rate)
{
	for (int i = 0; i < FORMATS; i++)
		if (cheapest_first[i] == format)
			return FORMATS - i + (size ? FORMATS : 0) + (size && rate ? FORMATS : 0);
	return 0;
}
