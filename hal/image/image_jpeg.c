/* SPDX-License-Identifier: MIT */
/* JPEG, read by TurboJPEG of libjpeg-turbo. */
#include <errno.h>
#include <turbojpeg.h>

#include "hal/image/codec.h"

/* Baseline Huffman coding needs at least two bits for a block of 64 pixels, a progressive scan one
 * bit: 512 pixels per byte. Twice that, for pictures whose chroma is finer than their luma. */
#define PIXELS_PER_BYTE 1024.0

static bool jpeg_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 3 && data[0] == 0xff && data[1] == 0xd8 && data[2] == 0xff;
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
	if (tjDecompress2(jpeg, source->data, source->bytes, image->u8, width, 0, height, TJPF_RGB,
			  flags))
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
