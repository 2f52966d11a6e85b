/* SPDX-License-Identifier: MIT */
/* Kinds of pictures that people bring and that are not read. */
#include <string.h>

#include "hal/image/codec.h"

static const struct foreign_kind {
	size_t at;
	const char *mark;
	size_t length;
	const char *name, *how;
} kinds[] = {
#define KIND(at, mark, name, how)                                                                  \
	{                                                                                          \
		at, mark, sizeof(mark) - 1, name, how                                              \
	}
	KIND(4, "ftypavi", "AVIF", "heif-convert IN OUT.png"),
	KIND(4, "ftyphei", "HEIC, as phones take it", "heif-convert IN OUT.jpg"),
	KIND(4, "ftyphev", "HEIC, as phones take it", "heif-convert IN OUT.jpg"),
	KIND(4, "ftypmif1", "HEIF, as phones take it", "heif-convert IN OUT.jpg"),
	KIND(4, "ftypmsf1", "HEIF, as phones take it", "heif-convert IN OUT.jpg"),
	KIND(0, "\xff\x0a", "JPEG XL", "djxl IN OUT.png"),
	KIND(4, "JXL \r\n\x87\n", "JPEG XL", "djxl IN OUT.png"),
	KIND(4, "jP  \r\n\x87\n", "JPEG 2000", "opj_decompress -i IN -o OUT.png"),
	KIND(0, "\xff\x4f\xff\x51", "JPEG 2000", "opj_decompress -i IN -o OUT.png"),
	KIND(0, "DDS ", "DDS, a texture of games", "convert IN OUT.png"),
	KIND(0, "\xabKTX 11", "KTX, a packed texture",
	     "ktx2ktx2 IN and ktx extract IN.ktx2 OUT.png"),
	KIND(0, "\xabKTX 20", "KTX2, a packed texture", "ktx extract IN OUT.png"),
	KIND(0, "8BPS", "PSD of Photoshop", "convert 'IN[0]' OUT.png"),
	KIND(0, "gimp xcf", "XCF of GIMP", "its export"),
	KIND(0, "GIF8", "GIF", "convert 'IN[0]' OUT.png"),
	KIND(0, "II*\0", "TIFF", "convert IN OUT.png"),
	KIND(0, "MM\0*", "TIFF", "convert IN OUT.png"),
	KIND(0, "II+\0", "BigTIFF", "convert IN OUT.png"),
	KIND(0, "MM\0+", "BigTIFF", "convert IN OUT.png"),
	KIND(0, "BM", "BMP", "convert IN OUT.png"),
#undef KIND
};

const char *image_foreign(const uint8_t *data, size_t bytes, const char **how)
{
	for (size_t k = 0; k < sizeof(kinds) / sizeof(*kinds); k++)
		if (bytes >= kinds[k].at + kinds[k].length &&
		    memcmp(data + kinds[k].at, kinds[k].mark, kinds[k].length) == 0) {
			*how = kinds[k].how;
			return kinds[k].name;
		}
	return NULL;
}
