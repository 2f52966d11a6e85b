/* SPDX-License-Identifier: MIT */
/* Pictures in libcamera's buffers: mapped memory, the planes in it, the time of capture. */
#ifndef INLAY_DRIVERS_LIBCAMERA_PICTURE_H
#define INLAY_DRIVERS_LIBCAMERA_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/frame/frame.h"

/* A plane as libcamera describes it: a range of bytes of a descriptor. Planes may share one. */
struct libcamera_span {
	int fd;
	size_t offset, bytes;
};

/* If zeroed, nothing is mapped. */
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

/* Maps a buffer for reading and points the planes of picture->format, width and height into it.
 * stride: of the first. Planes that libcamera does not describe follow each other in memory.
 * -EINVAL: the spans are too small for the picture; other -errno: they cannot be mapped. The caller
 * unmaps the picture after a failure too. */
int libcamera_picture_map(struct libcamera_picture *picture, size_t stride,
			  const struct libcamera_span *spans, int count);
void libcamera_picture_unmap(struct libcamera_picture *picture); /* idempotent */

/* Call it before and after the processor reads a picture, to keep its cache coherent
 * (DMA_BUF_SYNC). Memory that is not a DMABUF refuses the ioctl and does not need it; this is no
 * error. */
void libcamera_picture_reading(const struct libcamera_picture *picture, bool begins);

/* Fills in the planes of a picture; used[] are the bytes that each span holds. False: the picture
 * is not whole. */
bool libcamera_picture_planes(const struct libcamera_picture *picture, const size_t *used,
			      int count, struct frame_plane planes[FRAME_PLANES]);

/* Converts a time stamp to CLOCK_MONOTONIC. Some pipelines stamp with that clock, as V4L2 does,
 * others with CLOCK_BOOTTIME, as libcamera's documentation says; they differ by the time of
 * suspension. For a stamp of neither clock it returns the present time. */
int64_t libcamera_picture_time_ns(int64_t stamp_ns);

#endif
