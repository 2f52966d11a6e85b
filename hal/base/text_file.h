/* SPDX-License-Identifier: MIT */
/*
 * Text files, line by line. A byte order mark at the beginning is skipped. Files that are no text
 * are refused: no regular file (input.h), a zero byte, a line above TEXT_LINE_BYTES_MAX, a file
 * above TEXT_FILE_BYTES_MAX.
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
	char *line;	  /* the last line read, without its break; may be written to */
	int number;	  /* number of that line, from 1; 0: none read yet */
	/* private */
	FILE *stream;
	size_t bytes; /* read so far */
};

/* 0, or -ENOENT, -ENOMEM ... with a fault that names the path; nothing is open then. */
int text_file_open(struct text_file *file, const char *path, struct fault *fault);

/* Reads the next line. 1: there is one; 0: end of the file; -EINVAL, -EFBIG, -EIO ...: with a fault
 * that names the path, and the line if the line is at fault. */
int text_file_next(struct text_file *file, struct fault *fault);

void text_file_close(struct text_file *file); /* idempotent; zeroed is fine */

#endif
