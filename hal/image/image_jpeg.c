/* SPDX-License-Identifier: MIT */
/* JPEG, read by TurboJPEG of libjpeg-turbo. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "hal/image/codec.h"

/* Baseline Huffman coding needs at least two bits for a block of 64 pixels, a progressive scan one
 * bit: 512 pixels per byte. Twice that, for pictures whose chroma is finer than their luma. */
#define PIXELS_PER_BYTE 1024.0

static bool jpeg_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 3 && data[0] == 0xff && data[1] == 0xd8 && data[2] == 0xff;
}

/* Whether a segment of Adobe's stands before the picture: such files hold inks inverted, 255 for
 * none. */
static bool jpeg_is_adobes(const struct image_source *source)
{
	const uint8_t *data = source->data;
	size_t at = 2;

	while (at + 9 <= source->bytes && data[at] == 0xff && data[at + 1] != 0xda) {
		if (data[at + 1] == 0xee && memcmp(data + at + 4, "Adobe", 5) == 0)
			return true;
		at += 2 + ((size_t)data[at + 2] << 8) + data[at + 3];
	}
	return false;
}

/* Decodes four inks, of which one is black, and multiplies what they leave of white paper. */
static int jpeg_decode_inks(tjhandle jpeg, const struct image_source *source, struct image *image,
			    int flags)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	const uint8_t none = jpeg_is_adobes(source) ? 0 : 255;
	uint8_t *inks = malloc(4 * pixels);
	int err = -ENOMEM;

	if (inks)
		err = tjDecompress2(jpeg, source->data, source->bytes, inks, image->width, 0,
				    image->height, TJPF_CMYK, flags);
	for (size_t k = 0; k < pixels && !err; k++)
		for (size_t c = 0; c < 3; c++)
			image->u8[3 * k + c] =
				(uint8_t)(((inks[4 * k + c] ^ none) * (inks[4 * k + 3] ^ none) +
					   127) /
					  255);
	free(inks);
	return err;
}

static int jpeg_decode(tjhandle jpeg, const struct image_source *source, struct image *image,
		       struct fault *fault)
{
	/* A hostile progressive file may hold scans without end. TurboJPEG's warnings (a file that
	 * ends early, blocks that do not decode) count as damage here. */
	const int flags = TJFLAG_LIMITSCANS | TJFLAG_STOPONWARNING | TJFLAG_ACCURATEDCT;
	int width = 0, height = 0, subsampling, space;
	int err;

	if (tjDecompressHeader3(jpeg, source->data, source->bytes, &width, &height, &subsampling,
				&space))
		return fault_say(fault, -EBADMSG, "%s: damaged JPEG: %s", source->name,
				 tjGetErrorStr2(jpeg));
	/* TurboJPEG accepts a file of tables without a picture. */
	if (width < 1 || height < 1)
		return fault_say(fault, -EBADMSG, "%s: damaged JPEG: no picture in it",
				 source->name);
	err = image_check_size(source, width, height, PIXELS_PER_BYTE, fault);
	if (err)
		return err;
	err = image_create_u8(image, width, height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	if (space == TJCS_CMYK || space == TJCS_YCCK)
		err = jpeg_decode_inks(jpeg, source, image, flags);
	else
		err = tjDecompress2(jpeg, source->data, source->bytes, image->u8, width, 0, height,
				    TJPF_RGB, flags);
	if (err == -ENOMEM)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	if (err)
		return fault_say(fault, -EBADMSG, "%s: damaged JPEG: %s", source->name,
				 tjGetErrorStr2(jpeg));
	return 0;
}

static int jpeg_read(const struct image_source *source, struct image *image, struct fault *fault)
{
	tjhandle jpeg = tjInitDecompress();
	int err;

	if (!jpeg)
		return fault_say(fault, -ENOMEM, "%s: cannot start the JPEG decoder", source->name);
	err = jpeg_decode(jpeg, source, image, fault);
	tjDestroy(jpeg);
	return err;
}

const struct image_codec image_jpeg = {
	.name = "JPEG",
	.ending = ".jpg",
	.probe = jpeg_probe,
	.read = jpeg_read,
};
