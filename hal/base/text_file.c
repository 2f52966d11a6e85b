/* SPDX-License-Identifier: MIT */
#include "hal/base/text_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/input.h"
#include "hal/base/plain_text.h"

#define BYTE_ORDER_MARK "\xef\xbb\xbf"

int text_file_open(struct text_file *file, const char *path, struct fault *fault)
{
	int err;

	*file = (struct text_file){.path = path};
	err = input_stream(path, &file->stream, fault);
	if (err)
		return err;
	file->line = malloc(TEXT_LINE_BYTES_MAX + 1);
	if (file->line)
		return 0;
	text_file_close(file);
	return fault_say(fault, -ENOMEM, "%s: %s", path, strerror(ENOMEM));
}

/* Not getline(): it would read a line of any length into memory. */
static int text_file_read_line(struct text_file *file, size_t *length, struct fault *fault)
{
	size_t used = 0;
	int byte;

	errno = 0;
	while ((byte = getc_unlocked(file->stream)) != EOF) {
		if (++file->bytes > TEXT_FILE_BYTES_MAX)
			return fault_say(fault, -EFBIG,
					 "%s: is larger than %d MiB, expected a text file",
					 file->path, TEXT_FILE_BYTES_MAX >> 20);
		if (byte == '\n')
			break;
		if (!byte && !file->number && text_is_utf16(file->line, used))
			return fault_say(fault, -EINVAL,
					 "%s: is UTF-16, expected UTF-8: save it in that encoding",
					 file->path);
		if (!byte)
			return fault_say(fault, -EINVAL,
					 "%s:%d: holds a zero byte, expected a text file",
					 file->path, file->number + 1);
		if (used == TEXT_LINE_BYTES_MAX)
			return fault_say(fault, -EINVAL,
					 "%s:%d: the line is too long, expected at most %d bytes",
					 file->path, file->number + 1, TEXT_LINE_BYTES_MAX);
		file->line[used++] = (char)byte;
	}
	if (byte == EOF && ferror(file->stream)) {
		const int err = errno ? -errno : -EIO;

		return fault_say(fault, err, "%s: cannot be read: %s", file->path, strerror(-err));
	}
	*length = used;
	return used || byte != EOF;
}

int text_file_next(struct text_file *file, struct fault *fault)
{
	const size_t mark = strlen(BYTE_ORDER_MARK);
	size_t length = 0;
	int ret = text_file_read_line(file, &length, fault);

	if (ret <= 0)
		return ret;
	if (length && file->line[length - 1] == '\r')
		length--;
	if (!file->number++ && length >= mark && !memcmp(file->line, BYTE_ORDER_MARK, mark)) {
		length -= mark;
		memmove(file->line, file->line + mark, length);
	}
	file->line[length] = '\0';
	return 1;
}

void text_file_close(struct text_file *file)
{
	if (file->stream)
		fclose(file->stream);
	free(file->line);
	file->stream = NULL;
	file->line = NULL;
}
