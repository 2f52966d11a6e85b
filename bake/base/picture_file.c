/* SPDX-License-Identifier: MIT */
#include "bake/base/picture_file.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <tiffio.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#include <stb/stb_image.h>

#include "hal/base/budget.h"
#include "hal/base/input.h"
#include "hal/colour/transfer.h"

static int check_size(const char *path, double width, double height, uint64_t bytes,
		      struct fault *fault)
{
	const struct budget own = {.file_bytes = bytes};

	if (width >= 1 && width <= IMAGE_SIDE_MAX && height >= 1 && height <= IMAGE_SIDE_MAX)
		return budget_fits(&own, 4 * width * height, path, fault);
	return fault_say(fault, -EBADMSG, "%s: %.0f x %.0f pixels, expected sides of 1 to %d", path,
			 width, height, IMAGE_SIDE_MAX);
}

/* ---- TIFF ---- */

__attribute__((format(printf, 4, 0))) static int
tiff_on_error(TIFF *tiff, void *fault, const char *module, const char *format, va_list list)
{
	char text[256];

	(void)tiff, (void)module;
	vsnprintf(text, sizeof(text), format, list);
	if (!((struct fault *)fault)->text[0])
		fault_say(fault, -EBADMSG, "%s", text);
	return 1;
}

__attribute__((format(printf, 4, 0))) static int
tiff_on_warning(TIFF *tiff, void *fault, const char *module, const char *format, va_list list)
{
	(void)tiff, (void)fault, (void)module, (void)format, (void)list;
	return 1;
}

/* Reads rows of 16-bit grey or RGB, perhaps with more samples, which are skipped. */
static bool tiff_read_deep(TIFF *tiff, struct image *image, size_t samples)
{
	const size_t width = (size_t)image->width, count = samples < 3 ? 1 : 3;
	uint16_t *row = malloc((size_t)TIFFScanlineSize(tiff) + 1);
	bool fine = row && (size_t)TIFFScanlineSize(tiff) >= 2 * samples * width;

	for (int y = 0; y < image->height && fine; y++) {
		uint16_t *to = image->u16 + 3 * width * (size_t)y;

		fine = TIFFReadScanline(tiff, row, (uint32_t)y, 0) == 1;
		for (size_t k = 0; k < 3 * width && fine; k++)
			to[k] = row[k / 3 * samples + (count == 3 ? k % 3 : 0)];
	}
	free(row);
	return fine;
}

/* libtiff gives colours that are multiplied by alpha. */
static bool tiff_read_plain(TIFF *tiff, struct image *image)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	uint32_t *raster = malloc(pixels * sizeof(*raster));
	uint8_t *rgba = (uint8_t *)raster;
	bool fine = raster &&
		    TIFFReadRGBAImageOriented(tiff, (uint32_t)image->width, (uint32_t)image->height,
					      raster, ORIENTATION_TOPLEFT, 1);

	for (size_t k = 0; k < pixels && fine; k++) {
		const uint32_t word = raster[k], a = TIFFGetA(word);
		const uint32_t c[3] = {TIFFGetR(word), TIFFGetG(word), TIFFGetB(word)};

		for (int i = 0; i < 3; i++)
			rgba[4 * k + (size_t)i] = (uint8_t)(a && c[i] < a ? (c[i] * 255 + a / 2) / a
							    : a		  ? 255
									  : 0);
		rgba[4 * k + 3] = (uint8_t)a;
	}
	fine = fine && image_take_rgba(image, rgba) == 0;
	free(raster);
	return fine;
}

static int tiff_decode(TIFF *tiff, const char *path, uint64_t bytes, struct image *image,
		       struct fault *fault)
{
	uint16_t bits = 1, samples = 1, planes = 1, light = 0, turned = ORIENTATION_TOPLEFT;
	uint32_t width = 0, height = 0;
	bool deep;
	int err;

	TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
	TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &turned);
	TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &light);
	err = check_size(path, width, height, bytes, fault);
	if (err)
		return err;
	deep = bits == 16 && planes == PLANARCONFIG_CONTIG && turned == ORIENTATION_TOPLEFT &&
	       (light == PHOTOMETRIC_RGB ? samples == 3
					 : light == PHOTOMETRIC_MINISBLACK && samples == 1) &&
	       !TIFFIsTiled(tiff);
	err = deep ? image_create_u16(image, (int)width, (int)height)
		   : image_create_u8(image, (int)width, (int)height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", path);
	return (deep ? tiff_read_deep(tiff, image, samples) : tiff_read_plain(tiff, image))
		       ? 0
		       : -EBADMSG;
}

static int tiff_read(const char *path, uint64_t bytes, struct image *image, struct fault *fault)
{
	TIFFOpenOptions *options = TIFFOpenOptionsAlloc();
	struct fault why = {.text = ""}, what = {.text = ""};
	TIFF *tiff = NULL;
	int err = -EBADMSG;

	if (options) {
		TIFFOpenOptionsSetErrorHandlerExtR(options, tiff_on_error, &why);
		TIFFOpenOptionsSetWarningHandlerExtR(options, tiff_on_warning, NULL);
		tiff = TIFFOpenExt(path, "rm", options);
		TIFFOpenOptionsFree(options);
	}
	if (tiff) {
		err = tiff_decode(tiff, path, bytes, image, &what);
		TIFFClose(tiff);
	}
	if (err && what.text[0])
		*fault = what;
	else if (err)
		fault_say(fault, err, "%s: damaged TIFF, or of a kind that is not read: %s", path,
			  why.text);
	return err;
}

/* ---- BMP and TGA ---- */

static int stb_decode(const uint8_t *data, size_t bytes, const char *path, struct image *image,
		      struct fault *fault)
{
	int width, height, channels, err;
	uint8_t *rgba;

	if (bytes > INT_MAX || !stbi_info_from_memory(data, (int)bytes, &width, &height, &channels))
		return fault_say(fault, -EBADMSG, "%s: damaged: no BMP or TGA that is read", path);
	err = check_size(path, width, abs(height), bytes, fault); /* below 0: from the top */
	if (err)
		return err;
	rgba = stbi_load_from_memory(data, (int)bytes, &width, &height, &channels, 4);
	if (!rgba)
		return fault_say(fault, -EBADMSG, "%s: damaged: %s", path, stbi_failure_reason());
	err = image_create_u8(image, width, height);
	if (!err)
		err = image_take_rgba(image, rgba);
	stbi_image_free(rgba);
	return err ? fault_say(fault, err, "%s: not enough memory for the picture", path) : 0;
}

/* ---- which one ---- */

static bool is_tiff(const uint8_t *data, size_t bytes)
{
	static const char marks[][5] = {"II*\0", "MM\0*", "II+\0", "MM\0+"}; /* +: BigTIFF */

	for (int k = 0; k < 4 && bytes >= 4; k++)
		if (!memcmp(data, marks[k], 4))
			return true;
	return false;
}

/* TGA has no mark of its own. */
static bool is_stb(const uint8_t *data, size_t bytes, const char *path)
{
	const char *dot = strrchr(path, '.');
	int width, height, channels;

	return (bytes >= 2 && !memcmp(data, "BM", 2)) || (dot && strcasecmp(dot, ".tga") == 0) ||
	       (bytes <= INT_MAX &&
		stbi_info_from_memory(data, (int)bytes, &width, &height, &channels));
}

int picture_file_read(const char *path, struct image *image, struct fault *fault)
{
	struct fault why = {.text = ""};
	uint8_t *data;
	int err;
	size_t bytes;

	*image = (struct image){.width = 0};
	err = input_read(path, INPUT_MAX, &data, &bytes, fault);
	if (err)
		return err;
	if (is_tiff(data, bytes)) {
		err = tiff_read(path, bytes, image, fault);
	} else {
		err = image_read_memory_deep(data, bytes, path, image, &why);
		if (err == -ENOTSUP && is_stb(data, bytes, path))
			err = stb_decode(data, bytes, path, image, fault);
		else if (err)
			*fault = why;
	}
	free(data);
	if (err)
		image_free(image);
	return err;
}

int picture_file_decode(struct image *image, bool data)
{
	const size_t values = 3 * (size_t)image->width * (size_t)image->height;

	if (!image->u16)
		return 0;
	image->f32 = malloc(values * sizeof(*image->f32));
	if (!image->f32)
		return -ENOMEM;
	for (size_t k = 0; k < values; k++) {
		const double code = image->u16[k] / 65535.0;

		image->f32[k] = (float)(data ? code : transfer_decode(TRANSFER_SRGB, code));
	}
	free(image->u16);
	image->u16 = NULL;
	return 0;
}
