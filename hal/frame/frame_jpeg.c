/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_decode.h"

#include <errno.h>

#define BLOCK_MAX 16 /* pixels of the largest block that a JPEG's size is rounded up to */

int frame_jpeg_size(struct jpeg_decoder *jpeg, const struct frame_plane *plane, int *width,
		    int *height, struct fault *fault)
{
	struct fault why = {""};
	int err;

	if (!plane->data || plane->bytes == 0)
		return fault_say(fault, -EBADMSG, "frame: an empty JPEG picture");
	err = jpeg_decoder_open(jpeg, plane->data, plane->bytes, width, height, &why);
	return err ? fault_say(fault, err, "frame: %s", why.text) : 0;
}

bool frame_jpeg_holds(int jpeg_width, int jpeg_height, int width, int height)
{
	return jpeg_width >= width && jpeg_width < width + BLOCK_MAX && jpeg_height >= height &&
	       jpeg_height < height + BLOCK_MAX;
}

int frame_jpeg_decode(struct jpeg_decoder *jpeg, const struct frame_plane *plane,
		      struct canvas *canvas, struct fault *fault)
{
	struct fault why = {""};
	int width, height, err = frame_jpeg_size(jpeg, plane, &width, &height, fault);

	if (err)
		return err;
	if (!frame_jpeg_holds(width, height, canvas->width, canvas->height))
		return fault_say(fault, -EBADMSG, "frame: a JPEG picture of %dx%d, expected %dx%d",
				 width, height, canvas->width, canvas->height);
	err = jpeg_decoder_read(jpeg, JPEG_BGRX, canvas->pixels, canvas->stride, canvas->width,
				canvas->height, &why);
	return err ? fault_say(fault, err, "frame: %s", why.text) : 0;
}

enum { MARK = 0xff, START = 0xd8, END = 0xd9, SCAN = 0xda };

/* Offset of the first scan from a place in the picture's header on; bytes if there is none. Skips
 * the segments before it by their lengths, because a thumbnail in one of them may hold markers of
 * its own. */
static size_t find_scan(const uint8_t *data, size_t from, size_t bytes)
{
	size_t i = from;

	while (i + 4 <= bytes && data[i] == MARK && data[i + 1] != SCAN) {
		if (data[i + 1] == MARK)
			i++; /* padding */
		else
			i += 2 + ((size_t)data[i + 2] << 8 | data[i + 3]);
	}
	return i + 4 <= bytes && data[i] == MARK ? i : bytes;
}

static size_t find_marker(const uint8_t *data, size_t from, size_t bytes, uint8_t marker)
{
	for (size_t i = from; i + 2 <= bytes; i++)
		if (data[i] == MARK && data[i + 1] == marker)
			return i;
	return bytes;
}

struct frame_plane frame_jpeg_after(const struct frame_plane *plane)
{
	const uint8_t *data = plane->data;
	size_t at;

	at = find_marker(data, 0, plane->bytes, START);
	at = find_scan(data, at + 2, plane->bytes);
	at = find_marker(data, at, plane->bytes, END);
	at = find_marker(data, at, plane->bytes, START);
	return (struct frame_plane){data + at, 0, plane->bytes - at};
}
