/*
 * OpenEXR through its C library (OpenEXRCore): the first part of a file, in scan lines or tiles,
 * channels R, G, B or Y alone, half or float. Alpha and other channels are left out.
 */
#include <errno.h>
#include <math.h>
#include <openexr.h>
#include <string.h>

#include "hal/image/codec.h"

/* Far beyond what its compressions reach on pictures; bounds what a hostile header can ask for. */
#define PIXELS_PER_BYTE 4096.0
#define CHANNELS_MAX 64

struct exr_work {
	const struct image_source *source;
	exr_context_t file;
	exr_decode_pipeline_t decoder;
	bool decoder_ready;
	int32_t left, top; /* of the data window */
	bool grey;
	char message[160];
};

static bool exr_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 4 && data[0] == 0x76 && data[1] == 0x2f && data[2] == 0x31 &&
	       data[3] == 0x01;
}

/* The first message of the library is nearest to the cause. */
static void on_error(exr_const_context_t file, exr_result_t code, const char *message)
{
	void *user = NULL;

	(void)code;
	if (exr_get_user_data(file, &user) || !user)
		return;
	struct exr_work *work = user;

	if (!work->message[0])
		snprintf(work->message, sizeof(work->message), "%s", message);
}

static int64_t on_read(exr_const_context_t file, void *user, void *buffer, uint64_t bytes,
		       uint64_t offset, exr_stream_error_func_ptr_t error)
{
	const struct image_source *source = ((const struct exr_work *)user)->source;

	(void)file;
	(void)error;
	if (offset >= source->bytes)
		return 0;
	if (bytes > source->bytes - offset)
		bytes = source->bytes - offset;
	memcpy(buffer, source->data + offset, bytes);
	return (int64_t)bytes;
}

static int64_t on_size(exr_const_context_t file, void *user)
{
	(void)file;
	return (int64_t)((const struct exr_work *)user)->source->bytes;
}

static int damaged(const struct exr_work *work, exr_result_t result, struct fault *fault)
{
	const int err = result == EXR_ERR_OUT_OF_MEMORY ? -ENOMEM : -EBADMSG;

	return fault_say(fault, err, "%s: damaged OpenEXR file: %s", work->source->name,
			 work->message[0] ? work->message : exr_get_error_code_as_string(result));
}

/* Samples lie little-endian and anywhere. */
static float float_at(const uint8_t *at)
{
	const uint32_t bits = (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 |
			      (uint32_t)at[3] << 24;
	float value;

	memcpy(&value, &bits, sizeof(value));
	return value;
}

static float half_at(const uint8_t *at)
{
	const unsigned bits = (unsigned)at[0] | (unsigned)at[1] << 8;
	const int exponent = bits >> 10 & 31;
	const float mantissa = (float)(bits & 1023);
	const float sign = bits & 0x8000 ? -1.0f : 1.0f;

	if (exponent == 31)
		return mantissa > 0 ? NAN : sign * INFINITY;
	return sign * (exponent ? ldexpf(1024 + mantissa, exponent - 25) : ldexpf(mantissa, -24));
}

/* Which of R, G, B a channel is: 0, 1, 2, or -1. Y is spread over all three later. */
static int colour_of(const char *name)
{
	static const char *const names[] = {"R", "G", "B", "Y"};

	for (int i = 0; i < 4; i++)
		if (!strcmp(name, names[i]))
			return i % 3;
	return -1;
}

static int check_channels(struct exr_work *work, struct fault *fault)
{
	const char *name = work->source->name;
	const exr_attr_chlist_t *list = NULL;
	unsigned found = 0;
	const exr_result_t result = exr_get_channels(work->file, 0, &list);

	if (result)
		return damaged(work, result, fault);
	if (list->num_channels > CHANNELS_MAX)
		return fault_say(fault, -ENOTSUP, "%s: %d channels, expected at most %d", name,
				 list->num_channels, CHANNELS_MAX);
	for (int i = 0; i < list->num_channels; i++) {
		const exr_attr_chlist_entry_t *channel = &list->entries[i];
		const int colour = colour_of(channel->name.str);

		if (channel->x_sampling != 1 || channel->y_sampling != 1)
			return fault_say(fault, -ENOTSUP,
					 "%s: channel %s is subsampled, expected full size", name,
					 channel->name.str);
		if (colour < 0)
			continue;
		if (channel->pixel_type == EXR_PIXEL_UINT)
			return fault_say(fault, -ENOTSUP,
					 "%s: channel %s is of integers, expected half or float",
					 name, channel->name.str);
		work->grey = channel->name.str[0] == 'Y';
		found |= work->grey ? 8U : 1U << colour;
	}
	if (found != 7 && found != 8)
		return fault_say(fault, -ENOTSUP, "%s: expected channels R, G and B, or Y alone",
				 name);
	return 0;
}

static int check_part(struct exr_work *work, exr_storage_t *storage, struct image *image,
		      struct fault *fault)
{
	exr_attr_box2i_t window;
	uint64_t chunk_bytes = 0;
	exr_result_t result;
	int64_t width, height;
	int err;

	result = exr_get_storage(work->file, 0, storage);
	if (!result && *storage != EXR_STORAGE_SCANLINE && *storage != EXR_STORAGE_TILED)
		return fault_say(fault, -ENOTSUP,
				 "%s: deep OpenEXR data, expected a flat picture in scan lines or "
				 "tiles",
				 work->source->name);
	if (!result)
		result = exr_get_data_window(work->file, 0, &window);
	if (result)
		return damaged(work, result, fault);
	width = (int64_t)window.max.x - window.min.x + 1;
	height = (int64_t)window.max.y - window.min.y + 1;
	err = image_check_size(work->source, width, height, PIXELS_PER_BYTE, fault);
	if (!err)
		err = check_channels(work, fault);
	if (err)
		return err;
	result = exr_get_chunk_unpacked_size(work->file, 0, &chunk_bytes);
	if (result)
		return damaged(work, result, fault);
	if ((double)chunk_bytes > (double)work->source->bytes * PIXELS_PER_BYTE * 16)
		return fault_say(
			fault, -EBADMSG, "%s: chunks of %llu bytes, but the file has only %zu",
			work->source->name, (unsigned long long)chunk_bytes, work->source->bytes);
	work->left = window.min.x;
	work->top = window.min.y;
	err = image_create_f32(image, (int)width, (int)height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture",
				 work->source->name);
	return 0;
}

/* The chunk's samples: line by line, in each of them channel by channel. */
static exr_result_t unpack(const struct exr_work *work, float *out, int width)
{
	const exr_decode_pipeline_t *decoder = &work->decoder;
	/* What was not compressed stays where it was read. */
	const bool packed = decoder->unpacked_buffer == decoder->packed_buffer;
	const uint8_t *in = decoder->unpacked_buffer;
	const size_t room = packed ? decoder->packed_alloc_size : decoder->unpacked_alloc_size;
	size_t line_bytes = 0;

	for (int i = 0; i < decoder->channel_count; i++)
		line_bytes += (size_t)decoder->chunk.width *
			      (decoder->channels[i].data_type == EXR_PIXEL_HALF ? 2 : 4);
	if (!in || line_bytes * (size_t)decoder->chunk.height > room)
		return EXR_ERR_CORRUPT_CHUNK;
	for (int y = 0; y < decoder->chunk.height; y++, out += (size_t)width * 3)
		for (int i = 0; i < decoder->channel_count; i++) {
			const exr_coding_channel_info_t *channel = &decoder->channels[i];
			const int colour = colour_of(channel->channel_name);
			const bool half = channel->data_type == EXR_PIXEL_HALF;

			for (int x = 0; x < decoder->chunk.width; x++, in += half ? 2 : 4)
				if (colour >= 0)
					out[3 * x + colour] = half ? half_at(in) : float_at(in);
		}
	return EXR_ERR_SUCCESS;
}

/* One chunk to its place; (x, y) is its upper left corner in the picture. The library's own
 * unpacking is not used: that of 3.1 writes to channels that nobody asked for. */
static exr_result_t decode_chunk(struct exr_work *work, const exr_chunk_info_t *chunk, int64_t x,
				 int64_t y, struct image *image)
{
	exr_result_t result;

	if (x < 0 || y < 0 || chunk->width < 0 || chunk->height < 0 ||
	    x + chunk->width > image->width || y + chunk->height > image->height)
		return EXR_ERR_BAD_CHUNK_LEADER;
	result = work->decoder_ready
			 ? exr_decoding_update(work->file, 0, chunk, &work->decoder)
			 : exr_decoding_initialize(work->file, 0, chunk, &work->decoder);
	if (result)
		return result;
	if (!work->decoder_ready)
		result = exr_decoding_choose_default_routines(work->file, 0, &work->decoder);
	work->decoder_ready = true;
	work->decoder.unpack_and_convert_fn = NULL;
	if (result)
		return result;
	result = exr_decoding_run(work->file, 0, &work->decoder);
	return result ? result
		      : unpack(work, image->f32 + (y * image->width + x) * 3, image->width);
}

static exr_result_t decode_lines(struct exr_work *work, struct image *image)
{
	int32_t lines = 0;
	exr_result_t result = exr_get_scanlines_per_chunk(work->file, 0, &lines);

	if (!result && lines < 1)
		result = EXR_ERR_BAD_CHUNK_LEADER;
	for (int y = 0; y < image->height && !result; y += lines) {
		exr_chunk_info_t chunk;

		result = exr_read_scanline_chunk_info(work->file, 0, work->top + y, &chunk);
		if (!result)
			result = decode_chunk(work, &chunk, 0, y, image);
	}
	return result;
}

static exr_result_t decode_tiles(struct exr_work *work, struct image *image)
{
	int32_t width = 0, height = 0;
	exr_result_t result = exr_get_tile_sizes(work->file, 0, 0, 0, &width, &height);

	if (!result && (width < 1 || height < 1))
		result = EXR_ERR_BAD_CHUNK_LEADER;
	for (int64_t y = 0; y < image->height && !result; y += height)
		for (int64_t x = 0; x < image->width && !result; x += width) {
			exr_chunk_info_t chunk;

			result = exr_read_tile_chunk_info(work->file, 0, (int)(x / width),
							  (int)(y / height), 0, 0, &chunk);
			if (!result)
				result = decode_chunk(work, &chunk, x, y, image);
		}
	return result;
}

static void spread_grey(struct image *image)
{
	const size_t count = (size_t)image->width * (size_t)image->height;

	for (size_t i = 0; i < count; i++)
		image->f32[3 * i + 1] = image->f32[3 * i + 2] = image->f32[3 * i];
}

static int decode(struct exr_work *work, struct image *image, struct fault *fault)
{
	exr_storage_t storage;
	exr_result_t result;
	const int err = check_part(work, &storage, image, fault);

	if (err)
		return err;
	result = storage == EXR_STORAGE_TILED ? decode_tiles(work, image)
					      : decode_lines(work, image);
	if (work->decoder_ready)
		exr_decoding_destroy(work->file, &work->decoder);
	if (result)
		return damaged(work, result, fault);
	if (work->grey)
		spread_grey(image);
	return 0;
}

static int exr_read(const struct image_source *source, struct image *image, struct fault *fault)
{
	struct exr_work work = {.source = source};
	exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
	exr_result_t result;
	int err;

	setup.user_data = &work;
	setup.read_fn = on_read;
	setup.size_fn = on_size;
	setup.error_handler_fn = on_error;
	result = exr_start_read(&work.file, source->name, &setup);
	if (result)
		return damaged(&work, result, fault);
	err = decode(&work, image, fault);
	exr_finish(&work.file);
	return err;
}

const struct image_codec image_exr = {
	.name = "OpenEXR",
	.ending = ".exr",
	.linear = true,
	.probe = exr_probe,
	.read = exr_read,
};
