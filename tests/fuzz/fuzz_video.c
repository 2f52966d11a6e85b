/* Any bytes as Y4M video: each picture whole and converted, or a clear refusal. */
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/sim/y4m.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static void play(struct y4m *video)
{
	struct fault fault = {""};
	struct canvas canvas;
	int err;

	/* A header may promise a picture far larger than what follows: that must cost no time. */
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
	const int file = memfd_create("video", MFD_CLOEXEC);
	struct fault fault = {""};
	struct y4m video;
	char path[64];

	if (file < 0 || write(file, data, bytes) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	if (y4m_open(&video, path, &fault) == 0)
		play(&video);
	else if (!fault.text[0] || video.fd != -1)
		abort();
	y4m_close(&video);
	close(file);
	return 0;
}
