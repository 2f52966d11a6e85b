/* SPDX-License-Identifier: MIT */
/*
 * YUV4MPEG2 video from a file or a pipe: 8-bit 4:2:0, 4:2:2, 4:4:4 and grey.
 *
 * A pipe is read as its bytes come, without ever waiting for them; only the header is waited for,
 * at most 2 s. Interlaced video is taken as it lies.
 */
#ifndef INLAY_DRIVERS_SIM_Y4M_H
#define INLAY_DRIVERS_SIM_Y4M_H

#include <stdbool.h>

#include "hal/frame/frame.h"
#include "hal/ini/ini.h"

enum y4m_chroma { Y4M_420, Y4M_422, Y4M_444, Y4M_GREY };

struct y4m {
	char path[INI_PATH_MAX];
	int fd; /* -1: closed */
	bool pipe;
	int width, height;
	double rate_hz; /* 0: not said */
	enum y4m_chroma chroma;
	enum colour_range range; /* limited unless the header says FULL */
	int64_t first_frame;	 /* offset in the file */
	uint8_t *picture;	 /* planes, one after the other */
	size_t picture_bytes;
	char line[256]; /* of a header that is not whole yet */
	size_t line_have, picture_have;
	bool in_picture;
};

/* -ETIMEDOUT: nothing came from the pipe. */
int y4m_open(struct y4m *video, const char *path, struct fault *fault);

/* Takes the next picture. 0; -EAGAIN: the pipe has no whole one yet; -ENODATA: the end (no fault);
 * -EBADMSG: not a picture where one should be, or cut short. */
int y4m_next(struct y4m *video, struct fault *fault);

/* Back to the first picture; files only. */
int y4m_rewind(struct y4m *video, struct fault *fault);

/* Converts the picture taken last; the canvas has the video's size. */
void y4m_decode(const struct y4m *video, enum colour_matrix matrix, enum colour_range range,
		struct canvas *canvas);

void y4m_close(struct y4m *video); /* idempotent; needs fd -1 or opened */

#endif
