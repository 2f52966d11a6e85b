/* SPDX-License-Identifier: MIT */
/* WebP, lossy and lossless, read by libwebp. Of an animation there is no picture. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

#include "hal/image/codec.h"

static bool webp_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 12 && memcmp(data, "RIFF", 4) == 0 && memcmp(data + 8, "WEBP", 4) == 0;
}

static int webp_decode(const struct image_source *source, const WebPBitstreamFeatures *is,
		       struct image *image)
{
	const size_t channels = is->has_alpha ? 4 : 3;
	const size_t bytes = (size_t)is->width * (size_t)is->height * channels;
	const int stride = is->width * (int)channels;
	uint8_t *rgba;
	int err = image_create_u8(image, is->width, is->height);

	if (err)
		return err;
	if (!is->has_alpha)
		return WebPDecodeRGBInto(source->data, source->bytes, image->u8, bytes, stride)
			       ? 0
			       : -EBADMSG;
	rgba = malloc(bytes);
	if (!rgba)
		return -ENOMEM;
	err = WebPDecodeRGBAInto(source->data, source->bytes, rgba, bytes, stride) ? 0 : -EBADMSG;
	if (!err)
		err = image_take_rgba(image, rgba);
	free(rgba);
	return err;
}

static int webp_read(const struct image_source *source, struct image *image, struct fault *fault)
{
	WebPBitstreamFeatures is;
	int err;

	if (WebPGetFeatures(source->data, source->bytes, &is) != VP8_STATUS_OK)
		return fault_say(fault, -EBADMSG, "%s: damaged WebP", source->name);
	if (is.has_animation)
		return fault_say(fault, -ENOTSUP, "%s: an animation, expected one picture",
				 source->name);
	err = image_check_size(source, is.width, is.height, 3, fault);
	if (err)
		return err;
	err = webp_decode(source, &is, image);
	if (err == -EBADMSG)
		return fault_say(fault, err, "%s: damaged WebP", source->name);
	return err ? fault_say(fault, err, "%s: not enough memory for the picture", source->name)
		   : 0;
}

const struct image_codec image_webp = {
	.name = "WebP",
	.ending = ".webp",
	.probe = webp_probe,
	.read = webp_read,
};
