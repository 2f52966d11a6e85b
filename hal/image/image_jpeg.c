/* SPDX-License-Identifier: MIT */
/* JPEG, read by hal/jpeg. */
#include "hal/image/codec.h"
#include "hal/jpeg/jpeg_decoder.h"

static bool jpeg_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 3 && data[0] == 0xff && data[1] == 0xd8 && data[2] == 0xff;
}

static int jpeg_decode(struct jpeg_decoder *jpeg, const struct image_source *source,
		       struct image *image, struct fault *fault)
{
	struct fault why = {""};
	int width, height, err;

	err = jpeg_decoder_open(jpeg, source->data, source->bytes, &width, &height, &why);
	if (err)
		return fault_say(fault, err, "%s: %s", source->name, why.text);
	err = image_check_size(source, width, height, 3, fault);
	if (err)
		return err;
	err = image_create_u8(image, width, height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	err = jpeg_decoder_read(jpeg, JPEG_RGB, image->u8, 3 * (size_t)width, width, height, &why);
	return err ? fault_say(fault, err, "%s: %s", source->name, why.text) : 0;
}

static int image_jpeg_read(const struct image_source *source, struct image *image,
			   struct fault *fault)
{
	struct jpeg_decoder *jpeg;
	int err = jpeg_decoder_create(&jpeg);

	if (err)
		return fault_say(fault, err, "%s: cannot start the JPEG decoder", source->name);
	err = jpeg_decode(jpeg, source, image, fault);
	jpeg_decoder_destroy(jpeg);
	return err;
}

const struct image_codec image_jpeg = {
	.name = "JPEG",
	.ending = ".jpg",
	.probe = jpeg_probe,
	.read = image_jpeg_read,
};
