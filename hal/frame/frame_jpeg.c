/* SPDX-License-Identifier: MIT */
#include "hal/frame/frame_jpeg.h"

#include <errno.h>
#include <string.h>
#include <turbojpeg.h>

int frame_jpeg_create(struct frame_jpeg *jpeg)
{
	jpeg->handle = tjInitDecompress();
	return jpeg->handle ? 0 : -ENOMEM;
}

void frame_jpeg_destroy(struct frame_jpeg *jpeg)
{
	if (jpeg->handle)
		tjDestroy(jpeg->handle);
	jpeg->handle = NULL;
}

/* Whether TurboJPEG's error means damage. Some webcams put stray bytes between the last scan and
 * its end marker, and the picture is whole. After any other warning a part is missing or made
 * up. */
static bool is_damaged(tjhandle handle)
{
	return tjGetErrorCode(handle) != TJERR_WARNING ||
	       !strstr(tjGetErrorStr2(handle), "extraneous bytes");
}

/* Starts a new decompressor: after an error in the middle of a header, TurboJPEG would refuse every
 * later picture too. */
static int refuse_header(struct frame_jpeg *jpeg, struct fault *fault)
{
	fault_say(fault, -EBADMSG, "frame: not a JPEG picture: %s", tjGetErrorStr2(jpeg->handle));
	tjDestroy(jpeg->handle);
	jpeg->handle = tjInitDecompress();
	return -EBADMSG;
}

static int jpeg_read_header(struct frame_jpeg *jpeg, const struct frame_plane *plane, int *width,
			    int *height, struct fault *fault)
{
	int subsampling, colours;

	if (!plane->data || plane->bytes == 0)
		return fault_say(fault, -EBADMSG, "frame: an empty JPEG picture");
	if (!jpeg->handle)
		return fault_say(fault, -ENOMEM, "frame: no memory to decode JPEG pictures");
	if (tjDecompressHeader3(jpeg->handle, plane->data, plane->bytes, width, height,
				&subsampling, &colours))
		return refuse_header(jpeg, fault);
	return 0;
}

int frame_jpeg_height(struct frame_jpeg *jpeg, const struct frame_plane *plane, int *height,
		      struct fault *fault)
{
	int width;

	return jpeg_read_header(jpeg, plane, &width, height, fault);
}

int frame_jpeg_decode(struct frame_jpeg *jpeg, const struct frame_plane *plane,
		      struct canvas *canvas, struct fault *fault)
{
	int width, height, err = jpeg_read_header(jpeg, plane, &width, &height, fault);

	if (err)
		return err;
	if (width != canvas->width || height != canvas->height)
		return fault_say(fault, -EBADMSG, "frame: a JPEG picture of %dx%d, expected %dx%d",
				 width, height, canvas->width, canvas->height);
	/* BGRA, not BGRX: the former sets the fourth byte to 255. */
	if (tjDecompress2(jpeg->handle, plane->data, plane->bytes, canvas->pixels, width,
			  (int)canvas->stride, height, TJPF_BGRA,
			  TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS) &&
	    is_damaged(jpeg->handle))
		return fault_say(fault, -EBADMSG, "frame: a damaged JPEG picture: %s",
				 tjGetErrorStr2(jpeg->handle));
	return 0;
}

enum { MARK = 0xff, START = 0xd8, END = 0xd9, SCAN = 0xda };

/* Offset of the first picture's first scan; bytes if there is none. Skips the segments before it by
 * their lengths, because a thumbnail in one of them may hold markers of its own. */
static size_t find_scan(const uint8_t *data, size_t bytes)
{
	size_t i = 2;

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

	at = find_scan(data, plane->bytes);
	at = find_marker(data, at, plane->bytes, END);
	at = find_marker(data, at, plane->bytes, START);
	return (struct frame_plane){data + at, 0, plane->bytes - at};
}
