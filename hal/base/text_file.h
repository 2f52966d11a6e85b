/* SPDX-License-Identifier: MIT */
/*
 * Text files, line by line. A byte order mark in front, which some editors put there, is passed
 * over; what is no text file at all is refused soon: what is no regular file (input.h), a zero
 * byte, a line or a file without end.
 */
#ifndef INLAY_HAL_BASE_TEXT_FILE_H
#define INLAY_HAL_BASE_TEXT_FILE_H

#include <stddef.h>
#include <stdio.h>

#include "hal/base/fault.h"

#define TEXT_LINE_BYTES_MAX 65536
#define TEXT_FILE_BYTES_MAX (16 << 20)

struct text_file {
	const char *path; /* borrowed */
	char *line;	  /* the last one, without its break; may be written to */
	int number;	  /* its number, from 1; 0: there was none yet */
	/* private */
	FILE *stream;
	size_t bytes; /* read so far */
};

/* -ENOENT, -ENOMEM ... with a fault that names the path; nothing is then open. */
int text_file_open(struct text_file *file, const char *path, struct fault *fault);

/* Goes to the next line. 1: there is one; 0: the file ends; -EINVAL, -EFBIG, -EIO ...: with a fault
 * that names the path, and the line where it is the line's. */
int text_file_next(struct text_file *file, struct fault *fault);

void text_file_close(struct text_file *file); /* idempotent; zeroed is fine */

#endif
