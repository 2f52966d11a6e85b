/* SPDX-License-Identifier: MIT */
#include "hal/image/image.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "hal/base/input.h"
#include "hal/base/output.h"
#include "hal/image/codec.h"

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
#define READABLE_EXR ", OpenEXR"
#else
#define READABLE_EXR ""
#endif
#define READABLE                                                                                   \
	"PNG, JPEG" READABLE_WEBP READABLE_EXR                                                     \
	", Radiance HDR or PFM, or of an object's textures also TIFF, BMP or TGA"

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
	const char *kind, *how;
	int err;

	*image = (struct image){0};
	for (int i = 0; codecs[i] && !codec; i++)
		if (codecs[i]->probe(source->data, source->bytes))
			codec = codecs[i];
	if (!source->bytes)
		return fault_say(fault, -EBADMSG, "%s: the file is empty, expected a picture",
				 name);
	kind = codec ? NULL : image_foreign(source->data, source->bytes, &how);
	if (kind)
		return fault_say(fault, -ENOTSUP,
				 "%s: is %s, expected " READABLE ": convert it, such as by: %s",
				 name, kind, how);
	if (!codec)
		return fault_say(fault, -ENOTSUP,
				 "%s: not a picture of a known kind, expected " READABLE, name);
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

/* source: without its bytes. */
static int image_read_file(struct image_source source, struct image *image, struct fault *fault)
{
	const char *path = source.name;
	uint8_t *data;
	int err;

	*image = (struct image){0};
	err = input_read(path, INPUT_MAX, &data, &source.bytes, fault);
	if (err)
		return err;
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
		      : fault_say(
				fault, -ENOTSUP,
				"%s: cannot tell the kind of picture from the name, expected an ending of .png, .pfm or .hdr",
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
