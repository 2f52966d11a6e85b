/* SPDX-License-Identifier: MIT */
/* Any bytes as a picture of a texture: read, or refused in a sentence. The name ends in .tga, so
 * that what is of no other kind is read as TGA.
 *
 * reaches: picture_file.c:tiff_read_rows picture_file.c:tiff_read_plain picture_file.c:stb_decode
 * picture_file.c:picture_file_decode
 */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "bake/base/picture_file.h"
#include "tests/support/as_file.h"

static char path[] = "/tmp/inlay-fuzz-XXXXXX.tga";

static void fuzz_picture_clean_up(void)
{
	unlink(path);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static FILE *file;
	struct fault fault = {.text = ""};
	struct image image;
	int err;

	if (!file) {
		const int fd = mkstemps(path, 4);

		file = fd < 0 ? NULL : fdopen(fd, "wb");
		if (!file)
			abort();
		atexit(fuzz_picture_clean_up);
	}
	rewind(file);
	if (ftruncate(fileno(file), 0) || fwrite(data, 1, bytes, file) != bytes || fflush(file))
		abort();
	err = picture_file_read(path, &image, &fault);
	if ((err == 0) != !fault.text[0])
		abort();
	if (!err && picture_file_decode(&image, false) < 0)
		abort();
	image_free(&image);
	return 0;
}
