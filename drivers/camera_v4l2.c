/*
 * Cameras behind Video4Linux: webcams, frame grabbers, sensors with a single video node. Memory
 * mapped streaming, single- and multi-planar.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/v4l2/device.h"
#include "drivers/v4l2/formats.h"
#include "drivers/v4l2/listing.h"
#include "drivers/v4l2/setup.h"
#include "hal/clock.h"

enum { BUFFERS_MAX = 8, PLANES_MAX = 2 };

struct v4l2_options {
	int input;
};

static const struct ini_key v4l2_keys[] = {
	{"input", INI_INT, offsetof(struct v4l2_options, input), .min = -1, .max = 255,
	 .fallback = "-1", .help = "Which input of the device; -1: the one that is selected."},
	INI_KEYS_END,
};

struct mapping {
	uint8_t *memory; /* NULL: not mapped */
	size_t length;
};

struct v4l2 {
	int fd;
	char path[INI_PATH_MAX];
	unsigned type; /* V4L2_BUF_TYPE_VIDEO_CAPTURE or _MPLANE */
	struct v4l2_picture picture;
	struct mapping mappings[BUFFERS_MAX][PLANES_MAX];
	int buffer_count;
	bool streaming;
	bool counted; /* last_sequence holds one */
	uint32_t last_sequence;
};

static bool multiplanar(const struct v4l2 *v)
{
	return v->type == V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
}

static void v4l2_close(struct camera *camera)
{
	struct v4l2 *v = camera->state;

	camera->state = NULL;
	if (!v)
		return;
	if (v->streaming)
		(void)device_ioctl(v->fd, VIDIOC_STREAMOFF, &v->type);
	for (int i = 0; i < BUFFERS_MAX; i++)
		for (int p = 0; p < PLANES_MAX; p++)
			if (v->mappings[i][p].memory)
				munmap(v->mappings[i][p].memory, v->mappings[i][p].length);
	if (v->fd >= 0)
		close(v->fd);
	free(v);
}

/* A buffer's description with room for its planes; planes must outlive it. */
static struct v4l2_buffer describe(const struct v4l2 *v, int index, struct v4l2_plane *planes)
{
	struct v4l2_buffer buffer = {
		.index = (unsigned)index, .type = v->type, .memory = V4L2_MEMORY_MMAP};

	memset(planes, 0, VIDEO_MAX_PLANES * sizeof(*planes));
	if (multiplanar(v)) {
		buffer.m.planes = planes;
		buffer.length = (unsigned)v->picture.layout->memory_planes;
	}
	return buffer;
}

static int queue(const struct v4l2 *v, int index)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer = describe(v, index, planes);

	return device_ioctl(v->fd, VIDIOC_QBUF, &buffer);
}

static int map_plane(struct v4l2 *v, struct mapping *mapping, size_t length, off_t offset)
{
	void *memory = mmap(NULL, length, PROT_READ | PROT_WRITE, MAP_SHARED, v->fd, offset);

	if (memory == MAP_FAILED)
		return -errno;
	mapping->memory = memory;
	mapping->length = length;
	return 0;
}

static int map_buffer(struct v4l2 *v, int index)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer = describe(v, index, planes);
	int err = device_ioctl(v->fd, VIDIOC_QUERYBUF, &buffer);

	if (err)
		return err;
	if (!multiplanar(v))
		return map_plane(v, &v->mappings[index][0], buffer.length, buffer.m.offset);
	for (int p = 0; p < v->picture.layout->memory_planes && !err; p++)
		err = map_plane(v, &v->mappings[index][p], planes[p].length,
				planes[p].m.mem_offset);
	return err;
}

static int start(struct v4l2 *v, int wanted)
{
	struct v4l2_requestbuffers request = {
		.count = (unsigned)wanted, .type = v->type, .memory = V4L2_MEMORY_MMAP};
	int err = device_ioctl(v->fd, VIDIOC_REQBUFS, &request);

	if (err)
		return err;
	if (request.count < 2)
		return -ENOMEM;
	v->buffer_count = request.count < BUFFERS_MAX ? (int)request.count : BUFFERS_MAX;
	for (int i = 0; i < v->buffer_count; i++) {
		err = map_buffer(v, i);
		if (!err)
			err = queue(v, i);
		if (err)
			return err;
	}
	err = device_ioctl(v->fd, VIDIOC_STREAMON, &v->type);
	v->streaming = err == 0;
	return err;
}

static int open_device(struct camera *camera, struct v4l2 *v, struct fault *fault)
{
	struct v4l2_capability capability;

	v->fd = device_find(camera->settings.device, v->path, &capability, fault);
	if (v->fd < 0)
		return v->fd;
	v->type = device_caps(&capability) & V4L2_CAP_VIDEO_CAPTURE
			  ? V4L2_BUF_TYPE_VIDEO_CAPTURE
			  : V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE;
	return 0;
}

static int set_up(struct camera *camera, struct v4l2 *v, struct fault *fault)
{
	const struct v4l2_options *options = camera->options;
	int err = v4l2_setup_input(v->fd, options->input, fault);

	if (err)
		return err;
	err = v4l2_setup_picture(v->fd, v->type, &camera->settings, &v->picture, &camera->rate_hz,
				 fault);
	if (err == -ENOTSUP)
		camera->situation = CAMERA_UNSUPPORTED_FORMAT;
	if (err)
		return err;
	camera->format = v->picture.layout->format;
	camera->width = v->picture.width;
	camera->height = v->picture.height;
	err = start(v, camera->settings.buffers);
	if (err)
		return fault_say(fault, err, "cannot start the camera: %s", strerror(-err));
	return 0;
}

static int v4l2_open(struct camera *camera, struct fault *fault)
{
	struct v4l2 *v = calloc(1, sizeof(*v));
	struct fault why = {""};
	int err;

	if (!v)
		return fault_say(fault, -ENOMEM, "v4l2: no memory");
	v->fd = -1;
	camera->state = v;
	err = open_device(camera, v, fault);
	if (err)
		goto fail;
	err = set_up(camera, v, &why);
	if (err) {
		fault_say(fault, err, "%s: %s", v->path, why.text);
		goto fail;
	}
	return 0;
fail:
	if (camera->situation == CAMERA_FINE)
		camera->situation = device_situation(err);
	v4l2_close(camera);
	return err;
}

static int v4l2_descriptor(struct camera *camera)
{
	const struct v4l2 *v = camera->state;

	return v->fd;
}

static int64_t timestamp_ns(const struct v4l2_buffer *buffer)
{
	if ((buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
		return clock_now_ns();
	return (int64_t)buffer->timestamp.tv_sec * NS_PER_S +
	       (int64_t)buffer->timestamp.tv_usec * 1000;
}

/* Sequence numbers wrap; a step back means that the driver started to count anew. */
static uint32_t missed(struct v4l2 *v, uint32_t sequence)
{
	const uint32_t step = sequence - v->last_sequence;
	const bool gap = v->counted && step > 1 && step < UINT32_MAX / 2;

	v->counted = true;
	v->last_sequence = sequence;
	return gap ? step - 1 : 0;
}

static struct v4l2_span span(const struct mapping *mapping, size_t offset, size_t used)
{
	const size_t end = used < mapping->length ? used : mapping->length;

	if (offset >= end)
		return (struct v4l2_span){mapping->memory, 0};
	return (struct v4l2_span){mapping->memory + offset, end - offset};
}

/* False: the driver marked it as damaged, or it does not hold a whole picture. */
static bool read_buffer(const struct v4l2 *v, const struct v4l2_buffer *buffer, struct frame *frame)
{
	const struct mapping *mapping = v->mappings[buffer->index];
	struct v4l2_span memory[PLANES_MAX] = {{NULL, 0}, {NULL, 0}};

	if (buffer->flags & V4L2_BUF_FLAG_ERROR)
		return false;
	if (!multiplanar(v))
		memory[0] = span(&mapping[0], 0, buffer->bytesused);
	for (int p = 0; multiplanar(v) && p < v->picture.layout->memory_planes; p++)
		memory[p] = span(&mapping[p], buffer->m.planes[p].data_offset,
				 buffer->m.planes[p].bytesused);
	*frame = (struct frame){
		.format = v->picture.layout->format,
		.width = v->picture.width,
		.height = v->picture.height,
		.matrix = v->picture.matrix,
		.range = v->picture.range,
		.timestamp_ns = timestamp_ns(buffer),
		.sequence = buffer->sequence,
		.buffer = (int)buffer->index,
	};
	return v4l2_fill_planes(&v->picture, memory, frame->planes);
}

/* One buffer from the driver; an unfit one goes straight back and leaves PIXEL_NONE. */
static int take(struct camera *camera, struct v4l2 *v, struct frame *frame)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer = describe(v, 0, planes);
	int err = device_ioctl(v->fd, VIDIOC_DQBUF, &buffer);

	frame->format = PIXEL_NONE;
	if (err)
		return err;
	if (buffer.index >= (unsigned)v->buffer_count)
		return -EIO;
	camera->lost += missed(v, buffer.sequence);
	if (read_buffer(v, &buffer, frame))
		return 0;
	frame->format = PIXEL_NONE;
	camera->broken++;
	return queue(v, (int)buffer.index);
}

static int v4l2_grab(struct camera *camera, struct frame *frame, struct fault *fault)
{
	struct v4l2 *v = camera->state;
	struct frame newest = {.format = PIXEL_NONE}, next;
	int err = -EAGAIN;

	/* Never more than there are buffers, however fast the camera is. */
	for (int i = 0; i < v->buffer_count; i++) {
		err = take(camera, v, &next);
		if (err)
			break;
		if (next.format == PIXEL_NONE)
			continue;
		if (newest.format != PIXEL_NONE) {
			camera->lost++;
			err = queue(v, newest.buffer);
			if (err)
				break;
		}
		newest = next;
	}
	if (newest.format != PIXEL_NONE) {
		*frame = newest; /* trouble that came after it shows at the next call */
		return 0;
	}
	if (err == 0 || err == -EAGAIN)
		return -EAGAIN;
	camera->situation = device_situation(err);
	return fault_say(fault, err == -ENXIO ? -ENODEV : err, "%s: %s", v->path,
			 err == -ENODEV || err == -ENXIO ? "the camera has gone" : strerror(-err));
}

/* A device that is gone takes no buffer back; grab() will say so. */
static void v4l2_release(struct camera *camera, struct frame *frame)
{
	const struct v4l2 *v = camera->state;

	(void)queue(v, frame->buffer);
}

const struct camera_ops camera_v4l2 = {
	.name = "v4l2",
	.description = "Video4Linux: webcams, frame grabbers, sensors",
	.keys = v4l2_keys,
	.options_size = sizeof(struct v4l2_options),
	.list = v4l2_list,
	.open = v4l2_open,
	.descriptor = v4l2_descriptor,
	.grab = v4l2_grab,
	.release = v4l2_release,
	.close = v4l2_close,
};
