/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <errno.h>

#if WITH_FFMPEG
#include <dlfcn.h>
#include <libavcodec/avcodec.h>
#include <limits.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { SETS_MAX = 1024 }; /* bytes of parameter sets; usual are 30 */

#define NAME_OF(version) "libavcodec.so." AV_STRINGIFY(version)

/* The functions of libavcodec and of libavutil, which it brings. */
static struct {
	void *handle;
	__typeof__(&avcodec_find_decoder) find_decoder;
	__typeof__(&avcodec_alloc_context3) alloc_context;
	__typeof__(&avcodec_free_context) free_context;
	__typeof__(&avcodec_open2) open;
	__typeof__(&avcodec_send_packet) send_packet;
	__typeof__(&avcodec_receive_frame) receive_frame;
	__typeof__(&av_packet_alloc) packet_alloc;
	__typeof__(&av_packet_free) packet_free;
	__typeof__(&av_frame_alloc) frame_alloc;
	__typeof__(&av_frame_free) frame_free;
	__typeof__(&av_strerror) strerror;
	__typeof__(&av_log_set_level) log_set_level;
} library;

static const struct {
	const char *name;
	void *function;
} functions[] = {
	{"avcodec_find_decoder", &library.find_decoder},
	{"avcodec_alloc_context3", &library.alloc_context},
	{"avcodec_free_context", &library.free_context},
	{"avcodec_open2", &library.open},
	{"avcodec_send_packet", &library.send_packet},
	{"avcodec_receive_frame", &library.receive_frame},
	{"av_packet_alloc", &library.packet_alloc},
	{"av_packet_free", &library.packet_free},
	{"av_frame_alloc", &library.frame_alloc},
	{"av_frame_free", &library.frame_free},
	{"av_strerror", &library.strerror},
	{"av_log_set_level", &library.log_set_level},
};

struct h264_decoder {
	AVCodecContext *context;
	AVPacket *packet;
	AVFrame *next, *shown;
	struct h264_count count;
	bool stale; /* the context is to be replaced */
	uint8_t sets[SETS_MAX];
	size_t sets_bytes;
	uint8_t *unit; /* a copy of the access unit: libavcodec reads past its end */
	size_t room;
};

static int library_refuse(const char *why, struct fault *fault)
{
	return fault_say(fault, -ENOTSUP, "H.264 needs FFmpeg's %s, which cannot be loaded: %s",
			 NAME_OF(LIBAVCODEC_VERSION_MAJOR), why);
}

/* Two cameras are opened on two threads. */
static pthread_mutex_t library_lock = PTHREAD_MUTEX_INITIALIZER;

static int library_load(struct fault *fault)
{
	void *handle;

	if (library.handle)
		return 0;
	handle = dlopen(NAME_OF(LIBAVCODEC_VERSION_MAJOR), RTLD_NOW | RTLD_LOCAL);
	if (!handle)
		return library_refuse(dlerror(), fault);
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		void *function = dlsym(handle, functions[i].name);

		if (!function) {
			dlclose(handle);
			return library_refuse(functions[i].name, fault);
		}
		memcpy(functions[i].function, &function, sizeof(function));
	}
	library.log_set_level(AV_LOG_QUIET); /* the driver tells what matters */
	library.handle = handle;
	return 0;
}

/* One thread: with more, libavcodec does not notice that slices of a picture are missing.
 * Concealment stays on for the same reason, as only concealed pictures are marked; none of them is
 * handed out. */
static int context_open(struct h264_decoder *d, struct fault *fault)
{
	const AVCodec *codec = library.find_decoder(AV_CODEC_ID_H264);

	library.free_context(&d->context);
	if (!codec)
		return fault_say(fault, -ENOTSUP, "the installed libavcodec has no H.264 decoder");
	d->context = library.alloc_context(codec);
	if (!d->context)
		return fault_say(fault, -ENOMEM, "no memory for a H.264 decoder");
	d->context->flags |= AV_CODEC_FLAG_LOW_DELAY;
	d->context->thread_count = 1;
	d->context->err_recognition = AV_EF_EXPLODE | AV_EF_BITSTREAM | AV_EF_BUFFER;
	if (library.open(d->context, codec, NULL) < 0)
		return fault_say(fault, -ENOTSUP, "libavcodec cannot open its H.264 decoder");
	return 0;
}

static int decoder_open(struct h264_decoder *d, struct fault *fault)
{
	d->packet = library.packet_alloc();
	d->next = library.frame_alloc();
	d->shown = library.frame_alloc();
	if (!d->packet || !d->next || !d->shown)
		return fault_say(fault, -ENOMEM, "no memory for a H.264 decoder");
	return context_open(d, fault);
}

int h264_available(struct fault *fault)
{
	int err;

	pthread_mutex_lock(&library_lock);
	err = library_load(fault);
	pthread_mutex_unlock(&library_lock);
	return err;
}

int h264_create(struct h264_decoder **decoder, struct fault *fault)
{
	struct h264_decoder *d;
	int err;

	*decoder = NULL;
	err = h264_available(fault);
	if (err)
		return err;
	d = calloc(1, sizeof(*d));
	if (!d)
		return fault_say(fault, -ENOMEM, "no memory for a H.264 decoder");
	err = decoder_open(d, fault);
	if (err) {
		h264_destroy(d);
		return err;
	}
	*decoder = d;
	return 0;
}

void h264_destroy(struct h264_decoder *decoder)
{
	if (!decoder)
		return;
	library.free_context(&decoder->context);
	library.packet_free(&decoder->packet);
	library.frame_free(&decoder->next);
	library.frame_free(&decoder->shown);
	free(decoder->unit);
	free(decoder);
}

/* The next picture is decoded in a new context, which hands out none that needs earlier ones.
 * Flushing the old one is not enough: after a picture that broke off, it filters the edges in later
 * ones wrongly. */
void h264_skip(struct h264_decoder *decoder)
{
	decoder->stale = true;
}

/* A camera may send parameter sets once only, so they are kept for a new context. */
static void sets_keep(struct h264_decoder *d, const struct h264_unit *unit, const uint8_t *data)
{
	const size_t before = unit->sequence ? 0 : d->sets_bytes;

	if (unit->sets_bytes == 0 || unit->sets_bytes > SETS_MAX - before)
		return;
	memcpy(d->sets + before, data + unit->sets_at, unit->sets_bytes);
	d->sets_bytes = before + unit->sets_bytes;
}

/* Copies the access unit, behind the parameter sets if there are any that the context may not
 * know. */
static int unit_copy(struct h264_decoder *d, size_t sets, const uint8_t *data, size_t bytes)
{
	const size_t room = sets + bytes + AV_INPUT_BUFFER_PADDING_SIZE;

	if (d->room < room) {
		uint8_t *unit = realloc(d->unit, room);

		if (!unit)
			return AVERROR(ENOMEM);
		d->unit = unit;
		d->room = room;
	}
	memcpy(d->unit, d->sets, sets);
	memcpy(d->unit + sets, data, bytes);
	memset(d->unit + sets + bytes, 0, AV_INPUT_BUFFER_PADDING_SIZE);
	d->packet->data = d->unit;
	d->packet->size = (int)(sets + bytes);
	return 0;
}

static int picture_refuse(struct h264_decoder *d, int code, bool gap, struct fault *fault)
{
	char why[AV_ERROR_MAX_STRING_SIZE] = "parts of it are missing";

	if (code != AVERROR(EAGAIN)) /* else libavcodec still builds up what a later one needs */
		h264_skip(d);
	if (code == AVERROR(ENOMEM))
		return fault_say(fault, -ENOMEM, "no memory to decode H.264");
	if (gap)
		return fault_say(fault, -EBADMSG, "a H.264 picture is missing before this one");
	if (code == AVERROR(EAGAIN))
		return fault_say(fault, -EBADMSG,
				 "a H.264 picture that needs an earlier one, which did not come");
	if (code < 0)
		library.strerror(code, why, sizeof(why));
	return fault_say(fault, -EBADMSG, "a damaged H.264 picture: %s", why);
}

/* A stream may leave out colours, or tell some that inlay lacks: those of BT.2020 and SMPTE 240M
 * become the nearest, BT.709. */
static void picture_colours(const AVFrame *picture, struct frame *frame)
{
	switch (picture->colorspace) {
	case AVCOL_SPC_UNSPECIFIED:
	case AVCOL_SPC_RESERVED:
		break;
	case AVCOL_SPC_BT470BG:
	case AVCOL_SPC_SMPTE170M:
	case AVCOL_SPC_FCC:
		frame->matrix = MATRIX_BT601;
		break;
	default:
		frame->matrix = MATRIX_BT709;
	}
	if (picture->color_range == AVCOL_RANGE_JPEG || picture->format == AV_PIX_FMT_YUVJ420P)
		frame->range = RANGE_FULL;
	else if (picture->color_range == AVCOL_RANGE_MPEG)
		frame->range = RANGE_LIMITED;
}

static int picture_describe(const AVFrame *picture, struct frame *frame, struct fault *fault)
{
	if (picture->format != AV_PIX_FMT_YUV420P && picture->format != AV_PIX_FMT_YUVJ420P)
		return fault_say(
			fault, -ENOTSUP,
			"the camera's H.264 has pixels of another kind, expected 4:2:0 of 8 bits");
	frame->format = PIXEL_YU12;
	frame->width = picture->width;
	frame->height = picture->height;
	for (int p = 0; p < FRAME_PLANES; p++) {
		const int rows = p ? (picture->height + 1) / 2 : picture->height;
		const size_t stride = (size_t)picture->linesize[p];

		frame->planes[p] = (struct frame_plane){picture->data[p], stride,
							stride * (size_t)rows};
	}
	picture_colours(picture, frame);
	return 0;
}

static int unit_decode(struct h264_decoder *d, size_t sets, const uint8_t *data, size_t bytes)
{
	int code = bytes <= INT_MAX / 2 ? unit_copy(d, sets, data, bytes) : AVERROR_INVALIDDATA;

	if (!code)
		code = library.send_packet(d->context, d->packet);
	return code ? code : library.receive_frame(d->context, d->next);
}

int h264_decode(struct h264_decoder *decoder, const uint8_t *data, size_t bytes,
		struct frame *frame, struct fault *fault)
{
	const struct h264_unit unit = h264_unit_read(&decoder->count, data, bytes);
	const bool renew = decoder->stale || unit.gap;
	AVFrame *picture = decoder->next;
	int code;

	decoder->stale = renew;
	sets_keep(decoder, &unit, data);
	code = renew ? context_open(decoder, fault) : 0;
	if (code)
		return code;
	decoder->stale = false;
	code = unit_decode(decoder, renew ? decoder->sets_bytes : 0, data, bytes);
	if (code < 0 && !unit.picture && unit.sets_bytes)
		return -EAGAIN;
	if (code < 0 || picture->decode_error_flags || picture->flags & AV_FRAME_FLAG_CORRUPT)
		return picture_refuse(decoder, code, unit.gap, fault);
	decoder->next = decoder->shown;
	decoder->shown = picture;
	return picture_describe(picture, frame, fault);
}

#else /* WITH_FFMPEG */

int h264_available(struct fault *fault)
{
	return fault_say(fault, -ENOTSUP, "H.264 needs a build with FFmpeg's libavcodec");
}

int h264_create(struct h264_decoder **decoder, struct fault *fault)
{
	*decoder = NULL;
	return h264_available(fault);
}

void h264_destroy(struct h264_decoder *decoder)
{
	(void)decoder;
}

int h264_decode(struct h264_decoder *decoder, const uint8_t *data, size_t bytes,
		struct frame *frame, struct fault *fault)
{
	(void)decoder;
	(void)data;
	(void)bytes;
	(void)frame;
	return h264_available(fault);
}

void h264_skip(struct h264_decoder *decoder)
{
	(void)decoder;
}

#endif
