/* SPDX-License-Identifier: MIT */
/* What a V4L2 device says that it can do. */
#ifndef INLAY_DRIVERS_V4L2_OFFERS_H
#define INLAY_DRIVERS_V4L2_OFFERS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stdint.h>

/* Pictures a second; 0: the device does not say. */
double v4l2_rate_of(const struct v4l2_fract *interval);

/* A size or rate of 0 is any. A device that does not enumerate may have all. */
bool v4l2_offers_size(int fd, uint32_t fourcc, int width, int height);
bool v4l2_offers_rate(int fd, uint32_t fourcc, int width, int height, double rate_hz);

/* The next smaller size of the same shape; false: there is none. */
bool v4l2_smaller_size(int fd, uint32_t fourcc, int *width, int *height);

/* The next lower rate at this size; false: there is none. */
bool v4l2_slower_rate(int fd, uint32_t fourcc, int width, int height, double *rate_hz);

#endif
