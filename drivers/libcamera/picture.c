/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/parts.h"

#include <errno.h>
#include <linux/dma-buf.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "hal/base/clock.h"

static int map_one(struct libcamera_picture *p, int fd)
{
	const off_t end = lseek(fd, 0, SEEK_END);
	const size_t length = end > 0 ? (size_t)end : 0;
	void *memory = mmap(NULL, length, PROT_READ, MAP_SHARED, fd, 0);
	const int index = p->mapping_count;

	if (memory == MAP_FAILED)
		return -errno;
	p->mappings[index].fd = fd;
	p->mappings[index].memory = memory;
	p->mappings[index].length = length;
	p->mapping_count++;
	return index;
}

/* Returns the index of the mapping of fd, which it maps if needed; or -errno. */
static int picture_mapping(struct libcamera_picture *p, int fd)
{
	for (int i = 0; i < p->mapping_count; i++)
		if (p->mappings[i].fd == fd)
			return i;
	return map_one(p, fd);
}

static int point_into(struct libcamera_picture *p, const struct libcamera_span *span,
		      struct frame_plane *plane)
{
	const int index = picture_mapping(p, span->fd);
	size_t room;

	if (index < 0)
		return index;
	if (span->offset >= p->mappings[index].length)
		return -EINVAL;
	room = p->mappings[index].length - span->offset;
	plane->data = (const uint8_t *)p->mappings[index].memory + span->offset;
	plane->bytes = span->bytes < room ? span->bytes : room;
	return 0;
}

/* Points a plane behind the one before it. */
static int point_behind(struct libcamera_picture *p, int plane)
{
	const struct frame_plane *before = &p->planes[plane - 1];
	const size_t bytes = frame_plane_bytes(p->format, plane - 1, before->stride, p->height);

	if (before->bytes < bytes)
		return -EINVAL;
	p->planes[plane].data = before->data + bytes;
	p->planes[plane].bytes = before->bytes - bytes;
	return 0;
}

/* Bytes from the first to the last one of a plane; the last row has no padding. */
static size_t plane_extent(const struct libcamera_picture *p, int index)
{
	const size_t rows = frame_plane_bytes(p->format, index, 1, p->height);

	return p->planes[index].stride * (rows - 1) +
	       frame_plane_stride(p->format, index, p->width);
}

int libcamera_picture_map(struct libcamera_picture *p, size_t stride,
			  const struct libcamera_span *spans, int count)
{
	for (int i = 0; i < frame_plane_count(p->format); i++) {
		struct frame_plane *plane = &p->planes[i];
		const int err = i == 0 || i < count ? point_into(p, &spans[i], plane)
						    : point_behind(p, i);

		if (err)
			return err;
		if (p->format == PIXEL_MJPEG)
			continue;
		plane->stride = stride * frame_plane_stride(p->format, i, 2) /
				frame_plane_stride(p->format, 0, 2);
		if (plane->stride < frame_plane_stride(p->format, i, p->width) ||
		    plane->bytes < plane_extent(p, i))
			return -EINVAL;
	}
	return 0;
}

void libcamera_picture_unmap(struct libcamera_picture *p)
{
	for (int i = 0; i < p->mapping_count; i++)
		munmap(p->mappings[i].memory, p->mappings[i].length);
	*p = (struct libcamera_picture){.format = PIXEL_NONE};
}

void libcamera_picture_reading(const struct libcamera_picture *p, bool begins)
{
	struct dma_buf_sync sync = {.flags = DMA_BUF_SYNC_READ |
					     (begins ? DMA_BUF_SYNC_START : DMA_BUF_SYNC_END)};

	for (int i = 0; i < p->mapping_count; i++)
		while (ioctl(p->mappings[i].fd, DMA_BUF_IOCTL_SYNC, &sync) &&
		       (errno == EINTR || errno == EAGAIN))
			;
}

bool libcamera_picture_planes(const struct libcamera_picture *p, const size_t *used, int count,
			      struct frame_plane planes[FRAME_PLANES])
{
	memcpy(planes, p->planes, sizeof(p->planes));
	for (int i = 0; i < count && i < frame_plane_count(p->format); i++) {
		if (p->format != PIXEL_MJPEG && used[i] < plane_extent(p, i))
			return false;
		if (p->format == PIXEL_MJPEG && used[i] < planes[i].bytes)
			planes[i].bytes = used[i];
	}
	return planes[0].bytes > 0;
}

int64_t libcamera_picture_time_ns(int64_t stamp_ns)
{
	const int64_t now_ns = clock_now_ns();
	struct timespec boot;

	if (stamp_ns > now_ns) {
		clock_gettime(CLOCK_BOOTTIME, &boot);
		stamp_ns -= (int64_t)boot.tv_sec * NS_PER_S + boot.tv_nsec - now_ns;
	}
	return stamp_ns > 0 && stamp_ns <= now_ns ? stamp_ns : now_ns;
}
