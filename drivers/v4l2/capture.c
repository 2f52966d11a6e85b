/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/frame/frame_decode.h"

/* A time stamp older than this, or in the future, is of another clock or has wrapped around. */
#define TIME_PAST_NS (60 * NS_PER_S)

const struct v4l2_taken v4l2_nothing = {.frame.format = PIXEL_NONE, .buffers = {-1, -1}};

/* ---- one buffer ---- */

/* The time of capture as the driver tells it; now where that cannot be, or where it does not move
 * on: light and latency need a time that goes on. 0 is what drivers send that fill none in. */
static int64_t timestamp_ns(struct v4l2_capture *v, const struct v4l2_buffer *buffer)
{
	const int64_t now_ns = clock_now_ns(), s = buffer->timestamp.tv_sec;
	bool moves;
	int64_t ns;

	if ((buffer->flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
		return now_ns;
	if (s < 0 || s > now_ns / NS_PER_S)
		return now_ns;
	ns = s * NS_PER_S + (int64_t)buffer->timestamp.tv_usec * 1000;
	if (ns == 0 || ns < now_ns - TIME_PAST_NS || ns > now_ns)
		return now_ns;
	moves = ns > v->stamp_ns;
	v->stamp_ns = ns;
	return moves ? ns : now_ns;
}

static struct v4l2_span mapping_span(const struct v4l2_mapping *mapping, size_t offset, size_t used)
{
	const size_t end = used < mapping->length ? used : mapping->length;

	if (offset >= end)
		return (struct v4l2_span){mapping->memory, 0};
	return (struct v4l2_span){mapping->memory + offset, end - offset};
}

/* A driver whose rows are shorter than it tells gives no frame ever, and nothing else says why. */
static void say_short(struct v4l2_capture *v, size_t bytes)
{
	const enum pixel_format format = v->picture.layout->format;
	size_t needed = 0;
	char text[80];

	for (int p = 0; p < frame_plane_count(format); p++)
		needed += frame_plane_bytes(format, p, v->picture.stride[p], v->picture.rows);
	if (v->said_short || bytes >= needed)
		return;
	v->said_short = true;
	v4l2_describe(&v->picture, 0, text, sizeof(text));
	log_warning_paced("%s: frames have %zu bytes, %s needs %zu: they are passed over", v->path,
			  bytes, text, needed);
}

/* Describes the frame in a buffer. False: the driver marked it as damaged, or it is too short. */
static bool read_buffer(struct v4l2_capture *v, const struct v4l2_buffer *buffer,
			struct frame *frame)
{
	const struct v4l2_mapping *mapping = v->buffers.mappings[buffer->index];
	const struct v4l2_lines lines = v4l2_lines_of_buffer(&v->picture.lines, buffer->field,
							     v->picture.standard);
	struct v4l2_span memory[V4L2_PLANES_MAX] = {{NULL, 0}, {NULL, 0}};

	if (buffer->flags & V4L2_BUF_FLAG_ERROR)
		return false;
	if (!v4l2_multiplanar(&v->buffers))
		memory[0] = mapping_span(&mapping[0], 0, buffer->bytesused);
	for (int p = 0; v4l2_multiplanar(&v->buffers) && p < v->buffers.memory_planes; p++)
		memory[p] = mapping_span(&mapping[p], buffer->m.planes[p].data_offset,
					 buffer->m.planes[p].bytesused);
	*frame = (struct frame){
		.format = v->picture.layout->format,
		.width = v->picture.width,
		.height = v->picture.height,
		.fields = lines.fields,
		.bottom_first = lines.bottom_first,
		.matrix = v->picture.matrix,
		.range = v->picture.range,
		.timestamp_ns = timestamp_ns(v, buffer),
		.sequence = buffer->sequence,
		.buffer = (int)buffer->index,
	};
	if (v4l2_fill_planes(&v->picture, memory, frame->planes))
		return true;
	say_short(v, memory[0].bytes + memory[1].bytes);
	return false;
}

int v4l2_give_back(struct v4l2_capture *v, struct v4l2_taken *t)
{
	int first = 0;

	for (int i = 0; i < 2; i++) {
		const int err = t->buffers[i] >= 0 ? v4l2_buffers_queue(&v->buffers, t->buffers[i])
						   : 0;

		first = first ? first : err;
	}
	*t = v4l2_nothing;
	return first;
}

/* ---- pictures that are decoded from earlier ones ---- */

/* Asks for a key frame; most cameras cannot be asked and send one every few seconds. */
static void ask_for_key_frame(int fd)
{
	struct v4l2_control control = {.id = V4L2_CID_MPEG_VIDEO_FORCE_KEY_FRAME, .value = 1};

	(void)device_ioctl(fd, VIDIOC_S_CTRL, &control);
}

/* Replaces the frame in *t by its decoded picture and gives the buffer back. *t becomes empty if
 * none comes out. The first that is missing is told, and those that need it are only counted. */
static int decode_h264(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *t)
{
	const int buffer = t->buffers[0];
	struct fault why = {""};
	int err = h264_decode(v->h264, t->frame.planes[0].data, t->frame.planes[0].bytes, &t->frame,
			      &why);

	/* Encoders pad to whole macroblocks, and not every one tells that it has. */
	if (frame_jpeg_holds(t->frame.width, t->frame.height, v->picture.width,
			     v->picture.height)) {
		t->frame.width = v->picture.width;
		t->frame.height = v->picture.height;
	}
	if (camera->settings.matrix)
		t->frame.matrix = v->picture.matrix;
	if (camera->settings.range)
		t->frame.range = v->picture.range;
	camera->broken += err && err != -EAGAIN;
	if (err)
		camera->keyless_ns = clock_now_ns();
	if (err && err != -EAGAIN && !v->h264_ended) {
		log_warning_paced("%s: %s; pictures are passed over until the next key frame",
				  v->path, why.text);
		v->h264_ended = true;
		ask_for_key_frame(v->fd);
	}
	if (err)
		t->frame.format = PIXEL_NONE;
	else
		v->h264_ended = false;
	t->buffers[0] = -1;
	return v4l2_buffers_queue(&v->buffers, buffer);
}

/* ---- fields in turn ---- */

static void pair_join(struct v4l2_taken *pair, const struct v4l2_taken *second,
		      bool second_is_bottom)
{
	struct frame *f = &pair->frame;
	const size_t bytes = sizeof(f->planes);

	if (second_is_bottom) {
		memcpy(f->bottom_planes, second->frame.planes, bytes);
	} else {
		memcpy(f->bottom_planes, f->planes, bytes);
		memcpy(f->planes, second->frame.planes, bytes);
	}
	f->bottom_first = !second_is_bottom;
	f->timestamp_ns = second->frame.timestamp_ns; /* the picture is whole only then */
	pair->buffers[1] = second->buffers[0];
}

/* Handles a field, damaged or not. If it completes a pair, *t becomes the whole picture, else
 * empty. A picture with a damaged or lost field counts as broken once. */
static int pair_up(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *t,
		   uint32_t sequence, bool bottom)
{
	struct v4l2_taken first = v->waiting;
	int err = 0;

	switch (v4l2_pairing_take(&v->pairing, sequence, bottom, v->picture.lines.bottom_first)) {
	case V4L2_PAIR_ORPHAN:
		camera->broken++;
		err = v4l2_give_back(v, &first);
		v->waiting = *t;
		*t = v4l2_nothing;
		return err;
	case V4L2_PAIR_FIRST:
		v->waiting = *t;
		*t = v4l2_nothing;
		return 0;
	default:
		v->waiting = v4l2_nothing;
	}
	if (first.frame.format != PIXEL_NONE && t->frame.format != PIXEL_NONE) {
		pair_join(&first, t, bottom);
		*t = first;
		return 0;
	}
	camera->broken++;
	err = v4l2_give_back(v, &first);
	return err ? err : v4l2_give_back(v, t);
}

/* Whether the buffer tells which field it holds; one that does not belongs to no pair. */
static bool is_field(uint32_t field)
{
	return field == V4L2_FIELD_TOP || field == V4L2_FIELD_BOTTOM;
}

int v4l2_take(struct camera *camera, struct v4l2_capture *v, struct v4l2_taken *t)
{
	struct v4l2_plane planes[VIDEO_MAX_PLANES];
	struct v4l2_buffer buffer;
	const bool pairs = v->picture.lines.fields == FIELDS_PAIR;
	uint32_t gap;
	bool fit;
	int err;

	*t = v4l2_nothing;
	err = v4l2_buffers_take(&v->buffers, &buffer, planes);
	if (err)
		return err;
	gap = frame_count_gap(&v->count,
			      v->pairing.counts_fields ? buffer.sequence / 2 : buffer.sequence);
	camera->lost += gap;
	fit = read_buffer(v, &buffer, &t->frame) && (!pairs || is_field(buffer.field));
	t->buffers[0] = (int)buffer.index;
	if (!fit)
		err = v4l2_give_back(v, t);
	if (err)
		return err;
	if (v->h264 && (gap || !fit))
		h264_skip(v->h264);
	if (v->h264 && fit)
		return decode_h264(camera, v, t);
	if (pairs && is_field(buffer.field))
		return pair_up(camera, v, t, buffer.sequence, buffer.field == V4L2_FIELD_BOTTOM);
	camera->broken += !fit;
	return 0;
}
