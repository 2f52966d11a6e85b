/* SPDX-License-Identifier: MIT */
#include "hal/image/image.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "hal/base/input.h"
#include "hal/base/output.h"
#include "hal/image/codec.h"

/* Larger files are refused. */
#define FILE_BYTES_MAX ((size_t)1 << 32)

static const struct image_codec *const codecs[] = {
	&image_png,  &image_jpeg, &image_hdr, &image_pfm,
#if WITH_EXR
	&image_exr,
#endif
#if WITH_WEBP
	&image_webp,
#endif
	NULL,
};

#if WITH_WEBP
#define READABLE_WEBP ", WebP"
#else
#define READABLE_WEBP ""
#endif
#if WITH_EXR
#define READABLE "PNG, JPEG" READABLE_WEBP ", Radiance HDR, PFM and OpenEXR"
#else
#define READABLE "PNG, JPEG" READABLE_WEBP ", Radiance HDR and PFM"
#endif

/* Refuses NaN and infinity: one such pixel would spread over the whole composite. Sets negative
 * light to 0: lossy compression and wide gamuts leave it in dark places. */
static int image_check_light(struct image *image, const char *name, struct fault *fault)
{
	const size_t count = (size_t)image->width * (size_t)image->height * 3;

	for (size_t i = 0; i < count; i++) {
		const float value = image->f32[i];

		if (isfinite(value)) {
			image->f32[i] = value > 0 ? value : 0;
			continue;
		}
		return fault_say(fault, -EDOM,
				 "%s: pixel (%zu, %zu), %s, holds %g: light must be finite", name,
				 i / 3 % (size_t)image->width, i / 3 / (size_t)image->width,
				 i % 3 == 0   ? "red"
				 : i % 3 == 1 ? "green"
					      : "blue",
				 (double)value);
	}
	return 0;
}

static int image_read_source(const struct image_source *source, struct image *image,
			     struct fault *fault)
{
	const char *name = source->name;
	const struct image_codec *codec = NULL;
	int err;

	*image = (struct image){0};
	for (int i = 0; codecs[i] && !codec; i++)
		if (codecs[i]->probe(source->data, source->bytes))
			codec = codecs[i];
	if (!source->bytes)
		return fault_say(fault, -EBADMSG, "%s: the file is empty, expected a picture",
				 name);
	if (!codec)
		return fault_say(fault, -ENOTSUP,
				 "%s: not a picture of a known kind (" READABLE ")", name);
	err = codec->read(source, image, fault);
	if (!err && image->f32)
		err = image_check_light(image, name, fault);
	if (err)
		image_free(image);
	return err;
}

int image_read_memory(const uint8_t *data, size_t bytes, const char *name, struct image *image,
		      struct fault *fault)
{
	const struct image_source source = {.data = data, .bytes = bytes, .name = name};

	return image_read_source(&source, image, fault);
}

int image_read_memory_deep(const uint8_t *data, size_t bytes, const char *name, struct image *image,
			   struct fault *fault)
{
	const struct image_source source = {
		.data = data, .bytes = bytes, .name = name, .deep = true};

	return image_read_source(&source, image, fault);
}

/* Reads the whole file. Not mapped: truncation by another program would then raise SIGBUS. */
static int image_slurp(int fd, uint8_t **data, size_t *bytes)
{
	size_t used = 0, room = 1 << 16;
	uint8_t *buffer = malloc(room);
	ssize_t got = -1;
	int err = 0;

	if (!buffer)
		return -ENOMEM;
	for (;;) {
		got = read(fd, buffer + used, room - used);
		err = got < 0 ? -errno : 0;
		if (err == -EINTR)
			continue;
		if (got <= 0)
			break;
		used += (size_t)got;
		if (used == room) {
			uint8_t *larger = room < FILE_BYTES_MAX ? realloc(buffer, room * 2) : NULL;

			if (!larger) {
				err = room < FILE_BYTES_MAX ? -ENOMEM : -EFBIG;
				break;
			}
			buffer = larger;
			room *= 2;
		}
	}
	if (err) {
		free(buffer);
		return err;
	}
	*data = buffer;
	*bytes = used;
	return 0;
}

/* source: without its bytes. */
static int image_read_file(struct image_source source, struct image *image, struct fault *fault)
{
	const char *path = source.name;
	uint8_t *data = NULL;
	int fd, err;

	*image = (struct image){0};
	fd = input_open(path, fault);
	if (fd < 0)
		return fd;
	err = image_slurp(fd, &data, &source.bytes);
	close(fd);
	if (err)
		return fault_say(fault, err, "%s: cannot read the picture: %s", path,
				 strerror(-err));
	source.data = data;
	err = image_read_source(&source, image, fault);
	free(data);
	return err;
}

int image_read(const char *path, struct image *image, struct fault *fault)
{
	return image_read_file((struct image_source){.name = path}, image, fault);
}

int image_read_sized(const char *path, int width, int height, const char *why, struct image *image,
		     struct fault *fault)
{
	const struct image_source source = {
		.name = path, .width = width, .height = height, .why = why};

	return image_read_file(source, image, fault);
}

int image_read_deep(const char *path, struct image *image, struct fault *fault)
{
	return image_read_file((struct image_source){.name = path, .deep = true}, image, fault);
}

static const struct image_codec *codec_for_writing(const char *path)
{
	const char *dot = strrchr(path, '.');

	for (int i = 0; dot && codecs[i]; i++)
		if (codecs[i]->write && !strcasecmp(dot, codecs[i]->ending))
			return codecs[i];
	return NULL;
}

static int find_codec(const char *path, const struct image_codec **codec, struct fault *fault)
{
	*codec = codec_for_writing(path);
	return *codec ? 0
		      : fault_say(fault, -ENOTSUP,
				  "%s: cannot tell the kind of picture from the name, expected an "
				  "ending of .png, .pfm or .hdr",
				  path);
}

int image_name_linear(const char *path, struct fault *fault)
{
	const struct image_codec *codec;
	const int err = find_codec(path, &codec, fault);

	return err ? err : codec->linear;
}

int image_write_png(FILE *stream, const struct image *image, const char *name, struct fault *fault)
{
	const int err = image_png.write(stream, image);

	return err ? fault_say(fault, err, "%s: cannot write the picture: %s", name, strerror(-err))
		   : 0;
}

static int image_write_file(const char *path, const struct image *image, bool fresh,
			    struct fault *fault)
{
	const struct image_codec *codec;
	struct output out = {0};
	int err;

	if (!image_size_fits(image->width, image->height) || !image->u8 == !image->f32)
		return fault_say(fault, -EINVAL, "%s: there is no picture to write", path);
	err = find_codec(path, &codec, fault);
	if (err)
		return err;
	if (codec->linear != (image->f32 != NULL))
		return fault_say(fault, -ENOTSUP, "%s: %s cannot hold this picture, expected %s",
				 path, codec->name, image->f32 ? ".pfm or .hdr" : ".png");
	err = output_open(&out, path, fault);
	if (err)
		return err;
	out.fresh = fresh;
	err = codec->write(out.stream, image);
	if (err) {
		output_abandon(&out);
		return fault_say(fault, err, "%s: cannot write the picture: %s", path,
				 strerror(-err));
	}
	return output_commit(&out, fault);
}

int image_write(const char *path, const struct image *image, struct fault *fault)
{
	return image_write_file(path, image, false, fault);
}

int image_write_new(const char *path, const struct image *image, struct fault *fault)
{
	return image_write_file(path, image, true, fault);
}
