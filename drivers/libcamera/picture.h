/* SPDX-License-Identifier: MIT */
/* Pictures in libcamera's buffers: the memory, where planes lie in it, when they were taken. */
#ifndef INLAY_DRIVERS_LIBCAMERA_PICTURE_H
#define INLAY_DRIVERS_LIBCAMERA_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/frame/frame.h"

/* A plane as libcamera tells of it: bytes of a descriptor; several may share one. */
struct libcamera_span {
	int fd;
	size_t offset, bytes;
};

/* Zeroed: nothing is mapped. */
struct libcamera_picture {
	enum pixel_format format;
	int width, height;
	struct frame_plane planes[FRAME_PLANES];
	struct {
		int fd; /* borrowed */
		void *memory;
		size_t length;
	} mappings[FRAME_PLANES];
	int mapping_count;
};

/* Maps a buffer for reading and points the planes of format, width and height into it, all of one
 * stride. Where libcamera tells of one plane and we know of two, the second follows the first.
 * -EINVAL: the spans are too small for such a picture; other -errno: they cannot be mapped. To be
 * unmapped after a failure too. */
int libcamera_picture_map(struct libcamera_picture *picture, size_t stride,
			  const struct libcamera_span *spans, int count);
void libcamera_picture_unmap(struct libcamera_picture *picture); /* idempotent */

/* Around what the processor reads, so that it does not read its cache's older picture. Memory that
 * is no DMABUF needs none of it and says so, which is no error. */
void libcamera_picture_reading(const struct libcamera_picture *picture, bool begins);

/* The planes of a picture of which so many bytes of each span were used. False: not a whole one. */
bool libcamera_picture_planes(const struct libcamera_picture *picture, const size_t *used,
			      int count, struct frame_plane planes[FRAME_PLANES]);

/* CLOCK_MONOTONIC's time of a picture. Pipelines stamp with that, as V4L2 does, or with
 * CLOCK_BOOTTIME, as libcamera's documentation says: they differ by the time that was slept
 * through. Neither: now. */
int64_t libcamera_picture_time_ns(int64_t stamp_ns);

#endif
