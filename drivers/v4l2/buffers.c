/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>

bool v4l2_multiplanar(const struct v4l2_buffers *b)
{
	return b->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

/* Returns the description of a buffer with room for its planes, which must outlive it. */
static struct v4l2_buffer buffer_describe(const struct v4l2_buffers *b, int index,
					  struct v4l2_plane *planes)
{
	struct v4l2_buffer buffer = {
		.index = (unsigned)index, .type = b->type, .memory = V4L2_MEMORY_MMAP};

	memset(planes, 0, VIDEO_MAX_PLANES * sizeof(*planes));
	if (v4l2_multiplanar(b)) {
		buffer.m.planes = planes;
		buffer.length = (unsigned)b->memory_planes;
	}
	return buffer;
}

int v4l2_buffers_queue(const struct v4l2_buffers *b, int index)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer = buffer_describe(b, index, planes);

	return device_ioctl(b->fd, VIDIOC_QBUF, &buffer);
}

int v4l2_buffers_take(const struct v4l2_buffers *b, struct v4l2_buffer *buffer,
		      struct v4l2_plane planes[VIDEO_MAX_PLANES])
{
	int err;

	*buffer = buffer_describe(b, 0, planes);
	err = device_ioctl(b->fd, VIDIOC_DQBUF, buffer);
	if (err)
		return err;
	return buffer->index < (unsigned)b->count ? 0 : -EIO;
}

static int map_plane(const struct v4l2_buffers *b, struct v4l2_mapping *mapping, size_t length,
		     off_t offset)
{
	void *memory = mmap(NULL, length, PROT_READ | PROT_WRITE, MAP_SHARED, b->fd, offset);

	if (memory == MAP_FAILED)
		return -errno;
	mapping->memory = memory;
	mapping->length = length;
	return 0;
}

static int map_buffer(struct v4l2_buffers *b, int index)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer = buffer_describe(b, index, planes);
	int err = device_ioctl(b->fd, VIDIOC_QUERYBUF, &buffer);

	if (err)
		return err;
	if (!v4l2_multiplanar(b))
		return map_plane(b, &b->mappings[index][0], buffer.length, buffer.m.offset);
	for (int p = 0; p < b->memory_planes && !err; p++)
		err = map_plane(b, &b->mappings[index][p], planes[p].length,
				planes[p].m.mem_offset);
	return err;
}

/* A request for 0 buffers takes nothing from another program, and drivers refuse it like any other
 * request while that program has buffers. Old drivers do not know the number 0; their error says
 * nothing about other programs. */
int v4l2_buffers_try(const struct v4l2_buffers *b, struct fault *fault)
{
	struct v4l2_requestbuffers none = {.type = b->type, .memory = V4L2_MEMORY_MMAP};

	if (device_ioctl(b->fd, VIDIOC_REQBUFS, &none) == -EBUSY)
		return fault_say(fault, -EBUSY, "another program takes pictures from the camera");
	return 0;
}

static int buffers_request(struct v4l2_buffers *b, int wanted, struct fault *fault)
{
	struct v4l2_requestbuffers r = {
		.count = (unsigned)wanted, .type = b->type, .memory = V4L2_MEMORY_MMAP};
	int err = device_ioctl(b->fd, VIDIOC_REQBUFS, &r);

	if (err == -EBUSY)
		return fault_say(fault, err, "another program takes pictures from the camera");
	if (err)
		return fault_say(fault, err, "the camera gives no memory for %d pictures: %s",
				 wanted, strerror(-err));
	b->count = r.count < V4L2_BUFFERS_MAX ? (int)r.count : V4L2_BUFFERS_MAX;
	if (b->count < 2)
		return fault_say(fault, -ENOMEM,
				 "the camera has memory for %d pictures, expected at least 2",
				 b->count);
	return 0;
}

static int buffers_prepare(struct v4l2_buffers *b, struct fault *fault)
{
	for (int i = 0; i < b->count; i++) {
		int err = map_buffer(b, i);

		if (err)
			return fault_say(fault, err, "cannot map the camera's memory: %s",
					 strerror(-err));
		err = v4l2_buffers_queue(b, i);
		if (err)
			return fault_say(fault, err, "the camera does not take its memory back: %s",
					 strerror(-err));
	}
	return 0;
}

int v4l2_buffers_start(struct v4l2_buffers *b, int wanted, struct fault *fault)
{
	int err;

	err = buffers_request(b, wanted, fault);
	if (!err)
		err = buffers_prepare(b, fault);
	if (err)
		goto stop;
	err = device_ioctl(b->fd, VIDIOC_STREAMON, &b->type);
	if (err == -EINVAL) {
		/* This is the device's state and not the configuration's mistake: it may pass. */
		err = fault_say(
			fault, -EIO,
			"cannot start the camera: %s (a processor's node gives no pictures of its own)",
			strerror(EINVAL));
		goto stop;
	}
	if (err) {
		fault_say(fault, err, "cannot start the camera: %s", strerror(-err));
		goto stop;
	}
	b->streaming = true;
	return 0;
stop:
	v4l2_buffers_stop(b);
	return err;
}

void v4l2_buffers_stop(struct v4l2_buffers *b)
{
	struct v4l2_requestbuffers none = {.type = b->type, .memory = V4L2_MEMORY_MMAP};

	if (b->streaming)
		(void)device_ioctl(b->fd, VIDIOC_STREAMOFF, &b->type);
	for (int i = 0; i < V4L2_BUFFERS_MAX; i++)
		for (int p = 0; p < V4L2_PLANES_MAX; p++) {
			struct v4l2_mapping *mapping = &b->mappings[i][p];

			if (mapping->memory)
				munmap(mapping->memory, mapping->length);
			mapping->memory = NULL;
		}
	/* The format can be set again only after the device has freed its buffers. */
	if (b->count > 0)
		(void)device_ioctl(b->fd, VIDIOC_REQBUFS, &none);
	b->streaming = false;
	b->count = 0;
}
