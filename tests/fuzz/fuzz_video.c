/* SPDX-License-Identifier: MIT */
/* Any bytes as Y4M video: each picture whole and converted, or a clear refusal.
 *
 * reaches: y4m.c:read_chroma y4m.c:read_rate y4m.c:y4m_next y4m.c:y4m_decode
 * frame_ycbcr.c:ycbcr_row_full frame_ycbcr.c:ycbcr_row_halved frame_ycbcr.c:ycbcr_row_grey
 */
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>

#include "drivers/sim/sim.h"
#include "tests/support/as_file.h"

static void play(struct y4m *video)
{
	struct fault fault = {""};
	struct canvas canvas;
	int err;

	/* a header that promises a picture far larger than the file must cost no time */
	while ((err = y4m_next(video, &fault)) == 0) {
		if (canvas_create(&canvas, video->width, video->height))
			abort();
		y4m_decode(video, MATRIX_BT709, video->range, &canvas);
		canvas_free(&canvas);
	}
	if (err != -ENODATA && !fault.text[0])
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {""};
	struct y4m video;

	if (y4m_open(&video, as_file(data, bytes), &fault) == 0)
		play(&video);
	else if (!fault.text[0] || video.fd != -1)
		abort();
	y4m_close(&video);
	return 0;
}
