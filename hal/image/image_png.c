/* SPDX-License-Identifier: MIT */
/*
 * PNG, read and written by libpng. libpng reports errors by longjmp() to the function that called
 * setjmp(). Everything that must survive the jump is in struct png_work, which the caller of that
 * function owns.
 */
#include <endian.h>
#include <errno.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/codec.h"

struct png_work {
	png_structp png;
	png_infop info;
	png_bytep *rows;
	void *rgba; /* of a PNG with alpha */
	const struct image_source *source;
	size_t at;
	int err;
	char message[128];
};

static bool png_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 8 && !png_sig_cmp(data, 0, 8);
}

static _Noreturn void png_on_error(png_structp png, png_const_charp message)
{
	struct png_work *work = png_get_error_ptr(png);

	snprintf(work->message, sizeof(work->message), "%s", message);
	png_longjmp(png, 1);
}

/* Ignores warnings: they are about ancillary chunks, which the reader does not use. */
static void png_on_warning(png_structp png, png_const_charp message)
{
	(void)png;
	(void)message;
}

static void png_source_take(png_structp png, png_bytep out, size_t bytes)
{
	struct png_work *work = png_get_io_ptr(png);

	if (bytes > work->source->bytes - work->at)
		png_error(png, "the file ends too early");
	memcpy(out, work->source->data + work->at, bytes);
	work->at += bytes;
}

static int png_allocate_rows(struct png_work *work, void *pixels, const struct image *image,
			     size_t pixel_bytes)
{
	work->rows = malloc((size_t)image->height * sizeof(*work->rows));
	if (!work->rows)
		return -ENOMEM;
	for (int y = 0; y < image->height; y++)
		work->rows[y] = (uint8_t *)pixels + (size_t)y * (size_t)image->width * pixel_bytes;
	return 0;
}

/* Asks libpng to convert every kind of PNG to RGB or RGBA, of 8 bits unless 16 are wanted and
 * there, without gamma correction. */
static void ask_for_rgb(struct png_work *work)
{
	if (png_get_valid(work->png, work->info, PNG_INFO_tRNS))
		png_set_tRNS_to_alpha(work->png);
	if (!work->source->deep)
		png_set_scale_16(work->png);
	else if (png_get_bit_depth(work->png, work->info) == 16 && BYTE_ORDER == LITTLE_ENDIAN)
		png_set_swap(work->png);
	png_set_palette_to_rgb(work->png);
	png_set_expand_gray_1_2_4_to_8(work->png);
	png_set_gray_to_rgb(work->png);
	png_set_interlace_handling(work->png);
	png_read_update_info(work->png, work->info);
}

/* Allocates the picture, and the rows that libpng fills. */
static int png_allocate(struct png_work *work, struct image *image)
{
	const int width = (int)png_get_image_width(work->png, work->info);
	const int height = (int)png_get_image_height(work->png, work->info);
	const bool deep = png_get_bit_depth(work->png, work->info) == 16;
	const size_t channels = png_get_channels(work->png, work->info);
	const size_t pixel_bytes = deep ? 2 * channels : channels;
	int err = deep ? image_create_u16(image, width, height)
		       : image_create_u8(image, width, height);
	void *pixels = deep ? (void *)image->u16 : image->u8;

	if (!err && channels == 4) {
		work->rgba = malloc((size_t)width * (size_t)height * pixel_bytes);
		err = work->rgba ? 0 : -ENOMEM;
		pixels = work->rgba;
	}
	return err ? err : png_allocate_rows(work, pixels, image, pixel_bytes);
}

static int png_decode(struct png_work *work, struct image *image, struct fault *fault)
{
	bool deep;

	if (setjmp(png_jmpbuf(work->png)))
		return fault_say(fault, -EBADMSG, "%s: damaged PNG: %s", work->source->name,
				 work->message);
	png_set_read_fn(work->png, work, png_source_take);
	/* image_check_size() below checks the sizes, with the project's messages. */
	png_set_user_limits(work->png, 0x7fffffff, 0x7fffffff);
	png_read_info(work->png, work->info);
	deep = work->source->deep && png_get_bit_depth(work->png, work->info) == 16;
	work->err = image_check_size(work->source, png_get_image_width(work->png, work->info),
				     png_get_image_height(work->png, work->info), deep ? 6 : 3,
				     fault);
	if (work->err)
		return work->err;
	ask_for_rgb(work);
	if (png_get_channels(work->png, work->info) < 3 ||
	    (png_get_bit_depth(work->png, work->info) != 8 && !work->source->deep))
		png_error(work->png, "rows are not RGB");
	work->err = png_allocate(work, image);
	if (work->err)
		return fault_say(fault, work->err, "%s: not enough memory for the picture",
				 work->source->name);
	png_read_image(work->png, work->rows);
	png_read_end(work->png, NULL);
	if (work->rgba)
		work->err = image->u16 ? image_take_rgba16(image, work->rgba)
				       : image_take_rgba(image, work->rgba);
	return work->err ? fault_say(fault, work->err, "%s: not enough memory for the picture",
				     work->source->name)
			 : 0;
}

static int png_read(const struct image_source *source, struct image *image, struct fault *fault)
{
	struct png_work work = {.source = source};
	int err = -ENOMEM;

	work.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &work, png_on_error,
					  png_on_warning);
	work.info = work.png ? png_create_info_struct(work.png) : NULL;
	if (work.info)
		err = png_decode(&work, image, fault);
	else
		fault_say(fault, err, "%s: not enough memory", source->name);
	png_destroy_read_struct(&work.png, &work.info, NULL);
	free(work.rgba);
	free(work.rows);
	return err;
}

static void png_stream_put(png_structp png, png_bytep data, size_t bytes)
{
	if (fwrite(data, 1, bytes, png_get_io_ptr(png)) != bytes)
		png_error(png, "cannot write");
}

static void png_stream_flush(png_structp png)
{
	(void)png;
}

static int png_encode(struct png_work *work, FILE *stream, const struct image *image)
{
	if (setjmp(png_jmpbuf(work->png)))
		return -EIO;
	png_set_write_fn(work->png, stream, png_stream_put, png_stream_flush);
	png_set_IHDR(work->png, work->info, (png_uint_32)image->width, (png_uint_32)image->height,
		     8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
		     PNG_FILTER_TYPE_DEFAULT);
	/* Level 3 is three times as fast as the default; photographs grow by a few per cent. */
	png_set_compression_level(work->png, 3);
	png_write_info(work->png, work->info);
	png_write_image(work->png, work->rows);
	png_write_end(work->png, NULL);
	return 0;
}

static int png_write(FILE *stream, const struct image *image)
{
	struct png_work work = {0};
	int err = -ENOMEM;

	work.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &work, png_on_error,
					   png_on_warning);
	work.info = work.png ? png_create_info_struct(work.png) : NULL;
	if (work.info)
		err = png_allocate_rows(&work, image->u8, image, 3);
	if (!err) {
		errno = 0;
		err = png_encode(&work, stream, image);
		if (err && errno)
			err = -errno;
	}
	png_destroy_write_struct(&work.png, &work.info);
	free(work.rows);
	return err;
}

const struct image_codec image_png = {
	.name = "PNG",
	.ending = ".png",
	.probe = png_probe,
	.read = png_read,
	.write = png_write,
};
