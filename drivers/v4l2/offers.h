/* SPDX-License-Identifier: MIT */
/* Asks a V4L2 device which formats, sizes and rates it offers. */
#ifndef INLAY_DRIVERS_V4L2_OFFERS_H
#define INLAY_DRIVERS_V4L2_OFFERS_H

#include <linux/videodev2.h>
#include <stdbool.h>
#include <stdint.h>

/* Converts a frame interval to a rate in Hz; 0: the device does not know it. */
double v4l2_rate_of(const struct v4l2_fract *interval);

/* Whether a node offers depths, or (depth false) anything else. The nodes of a depth camera have
 * one name and one bus. A node that lists no formats may have pictures. */
bool v4l2_offers_kind(int fd, unsigned type, bool depth);

/* Whether the device offers a size or rate; 0 means any. A device that does not enumerate them may
 * have all. */
bool v4l2_offers_size(int fd, uint32_t fourcc, int width, int height);
bool v4l2_offers_rate(int fd, uint32_t fourcc, int width, int height, double rate_hz);

/* Replaces the size by the next smaller one of the same shape. False: there is none. */
bool v4l2_smaller_size(int fd, uint32_t fourcc, int *width, int *height);

/* Replaces the rate by the next lower one at this size. False: there is none. */
bool v4l2_slower_rate(int fd, uint32_t fourcc, int width, int height, double *rate_hz);

#endif
