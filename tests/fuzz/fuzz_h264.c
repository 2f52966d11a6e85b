/* SPDX-License-Identifier: MIT */
/*
 * Any bytes as what a camera calls H.264, one access unit for each delimiter in them: a picture
 * that can be read, none yet, or a clear refusal; a good stream is decoded after either.
 *
 * reaches: h264_unit.c:read_sequence_set h264_unit.c:skip_scaling_list h264_unit.c:read_slice
 * h264.c:h264_decode h264.c:picture_refuse
 */
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>

#include "drivers/v4l2/v4l2.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static size_t find_delimiter(const uint8_t *data, size_t from, size_t bytes)
{
	for (size_t i = from; i + 5 <= bytes; i++)
		if (data[i] == 0 && data[i + 1] == 0 && data[i + 2] == 0 && data[i + 3] == 1 &&
		    (data[i + 4] & 31) == 9)
			return i;
	return bytes;
}

static void decode(struct h264_decoder *decoder, const uint8_t *data, size_t bytes)
{
	struct fault fault = {""};
	struct frame frame = {0};
	const int err = h264_decode(decoder, data, bytes, &frame, &fault);

	if (err && err != -EAGAIN && !fault.text[0])
		abort();
	if (!err && frame_check(&frame, &fault))
		abort();
	for (int p = 0; p < FRAME_PLANES && !err; p++)
		for (size_t i = 0; i < frame.planes[p].bytes; i++)
			(void)*(const volatile uint8_t *)(frame.planes[p].data + i);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct h264_decoder *decoder = NULL;
	struct h264_count count = {0};

	(void)h264_create(&decoder, NULL); /* a build without it follows the stream nevertheless */
	for (size_t at = 0; at < bytes;) {
		const size_t next = find_delimiter(data, at + 1, bytes);
		const struct h264_unit unit = h264_unit_read(&count, data + at, next - at);

		if (unit.sets_at + unit.sets_bytes > next - at)
			abort();
		if (decoder)
			decode(decoder, data + at, next - at);
		at = next;
	}
	h264_destroy(decoder);
	return 0;
}
