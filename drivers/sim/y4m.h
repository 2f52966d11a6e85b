/* SPDX-License-Identifier: MIT */
/*
 * Reads YUV4MPEG2 video from a file or a pipe: 8-bit 4:2:0, 4:2:2, 4:4:4 and grey.
 *
 * A pipe is read without blocking, except that opening waits for its header, at most 2 s. Frames of
 * interlaced video are not deinterlaced.
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
	double rate_hz; /* 0: not known */
	enum y4m_chroma chroma;
	enum colour_range range; /* limited unless the header says FULL */
	int64_t first_frame;	 /* offset in the file */
	uint8_t *picture;	 /* planes, one after the other */
	size_t picture_bytes;
	char line[256];			/* a header line, perhaps not whole yet */
	size_t line_have, picture_have; /* bytes read so far */
	bool in_picture;
};

/* Opens the video and reads its header. 0 or -errno with a fault; -ETIMEDOUT: the pipe sent
 * none. */
int y4m_open(struct y4m *video, const char *path, struct fault *fault);

/* Reads the next picture. 0; -EAGAIN: the pipe has no whole one yet; -ENODATA: the end (no fault);
 * -EBADMSG: the data is damaged or cut short. */
int y4m_next(struct y4m *video, struct fault *fault);

/* Goes back to the first picture; files only. */
int y4m_rewind(struct y4m *video, struct fault *fault);

/* Converts the picture read last; the canvas has the video's size. */
void y4m_decode(const struct y4m *video, enum colour_matrix matrix, enum colour_range range,
		struct canvas *canvas);

void y4m_close(struct y4m *video); /* idempotent; needs fd -1 or opened */

#endif
