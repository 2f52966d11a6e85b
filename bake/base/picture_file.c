/* SPDX-License-Identifier: MIT */
#include "bake/base/picture_file.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
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

/* What a TIFF says of its samples. */
struct tiff_kind {
	uint32_t width, height;
	uint16_t bits, samples, planes, light, format, turned;
	uint16_t
		/* EXTRASAMPLE_ASSOCALPHA, _UNASSALPHA; 0: further samples are something else */
		alpha;
};

static struct tiff_kind tiff_kind_of(TIFF *tiff)
{
	struct tiff_kind kind = {.width = 0};
	uint16_t extras = 0, *extra = NULL;

	TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &kind.width);
	TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &kind.height);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &kind.bits);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &kind.samples);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &kind.planes);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &kind.format);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &kind.turned);
	TIFFGetFieldDefaulted(tiff, TIFFTAG_EXTRASAMPLES, &extras, &extra);
	TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &kind.light);
	if (extras && extra[0] != EXTRASAMPLE_UNSPECIFIED)
		kind.alpha = extra[0];
	return kind;
}

static double half_value(uint16_t half)
{
	const int exponent = half >> 10 & 31, fraction = half & 1023;
	const double size = exponent == 31 ? (fraction ? (double)NAN : (double)INFINITY)
			    : exponent	   ? ldexp(1024 + fraction, exponent - 25)
					   : ldexp(fraction, -24);

	return half >> 15 ? -size : size;
}

/* Linear light of a row, whose first pixel is number at, and its alpha if there is some. False: a
 * sample is not finite. */
static bool tiff_take_floats(const struct tiff_kind *kind, const void *row, struct image *image,
			     size_t at)
{
	const size_t colours = kind->samples < 3 ? 1 : 3;

	for (size_t x = 0; x < kind->width; x++) {
		double value[4], a = 1;

		for (size_t c = 0; c <= colours && c < kind->samples; c++) {
			const size_t k = x * kind->samples + c;

			value[c] = kind->bits == 16 ? half_value(((const uint16_t *)row)[k])
						    : (double)((const float *)row)[k];
			if (!isfinite(value[c]))
				return false;
		}
		if (kind->alpha) {
			a = fmin(fmax(value[colours], 0), 1);
			image->alpha[at + x] = (uint8_t)(a * 255 + 0.5);
		}
		for (size_t c = 0; c < 3; c++)
			image->f32[3 * (at + x) + c] =
				(float)(fmax(value[colours == 3 ? c : 0], 0) /
					(kind->alpha == EXTRASAMPLE_ASSOCALPHA && a > 0 ? a : 1));
	}
	return true;
}

static bool alpha_is_full(const struct image *image)
{
	size_t left = (size_t)image->width * (size_t)image->height;

	while (left && image->alpha[left - 1] == 255)
		left--;
	return !left;
}

/* Reads rows of 16-bit or float grey or RGB, perhaps with more samples. */
static int tiff_read_rows(TIFF *tiff, const struct tiff_kind *kind, struct image *image,
			  struct fault *fault)
{
	const size_t width = kind->width, samples = kind->samples, bytes = kind->bits / 8;
	void *row = malloc((size_t)TIFFScanlineSize(tiff) + 1);
	int err = row ? 0 : -ENOMEM;

	if (!err && (size_t)TIFFScanlineSize(tiff) < bytes * samples * width)
		err = -EBADMSG;
	if (!err && image->f32 && kind->alpha) {
		image->alpha = malloc(width * kind->height);
		err = image->alpha ? 0 : -ENOMEM;
	}
	for (size_t y = 0; y < kind->height && !err; y++) {
		const size_t at = width * y;

		if (TIFFReadScanline(tiff, row, (uint32_t)y, 0) != 1)
			err = -EBADMSG;
		else if (image->f32 && !tiff_take_floats(kind, row, image, at))
			err = fault_say(fault, -EDOM, "row %zu has light that is not finite", y);
		for (size_t k = 0; k < 3 * width && !err && image->u16; k++)
			image->u16[3 * at + k] =
				((uint16_t *)row)[k / 3 * samples + (samples < 3 ? 0 : k % 3)];
	}
	free(row);
	if (!err && image->alpha && alpha_is_full(image)) {
		free(image->alpha);
		image->alpha = NULL;
	}
	return err;
}

/* libtiff gives colours that are multiplied by alpha, or takes a further sample for it. */
static int tiff_read_plain(TIFF *tiff, const struct tiff_kind *kind, struct image *image)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	uint32_t *raster = malloc(pixels * sizeof(*raster));
	uint8_t *rgba = (uint8_t *)raster;
	int err = raster ? 0 : -ENOMEM;

	if (!err &&
	    !TIFFReadRGBAImageOriented(tiff, kind->width, kind->height, raster, kind->turned, 1))
		err = -EBADMSG;
	for (size_t k = 0; k < pixels && !err; k++) {
		const uint32_t word = raster[k], a = kind->alpha ? TIFFGetA(word) : 255;
		const uint32_t c[3] = {TIFFGetR(word), TIFFGetG(word), TIFFGetB(word)};

		for (int i = 0; i < 3; i++)
			rgba[4 * k + (size_t)i] = (uint8_t)(a && c[i] < a ? (c[i] * 255 + a / 2) / a
							    : a		  ? 255
									  : 0);
		rgba[4 * k + 3] = (uint8_t)a;
	}
	if (!err)
		err = image_take_rgba(image, rgba);
	free(raster);
	return err;
}

static int tiff_decode(TIFF *tiff, const char *path, uint64_t bytes, struct image *image,
		       struct fault *fault)
{
	const struct tiff_kind kind = tiff_kind_of(tiff);
	const bool light = kind.format == SAMPLEFORMAT_IEEEFP;
	const bool rows = kind.planes == PLANARCONFIG_CONTIG && !TIFFIsTiled(tiff) &&
			  (kind.light == PHOTOMETRIC_RGB
				   ? kind.samples >= 3
				   : kind.light == PHOTOMETRIC_MINISBLACK && kind.samples < 3);
	const bool deep = !light && rows && kind.bits == 16 && !kind.alpha &&
			  kind.format == SAMPLEFORMAT_UINT;
	struct fault why = {.text = ""};
	int err = check_size(path, kind.width, kind.height, bytes, fault);

	if (err)
		return err;
	if (kind.turned != ORIENTATION_TOPLEFT)
		return fault_say(
			fault, -EBADMSG,
			"%s: a TIFF that is to be turned (its orientation is %d), expected one that is upright",
			path, kind.turned);
	if (!light && kind.format != SAMPLEFORMAT_UINT && kind.format != SAMPLEFORMAT_VOID)
		return fault_say(
			fault, -EBADMSG,
			"%s: a TIFF of signed or complex numbers, expected whole ones from 0, or floats",
			path);
	if (light && (!rows || (kind.bits != 16 && kind.bits != 32)))
		return fault_say(
			fault, -EBADMSG,
			"%s: a TIFF of %d-bit floats in %d samples, planes or tiles, expected 16 or 32 bits of grey or RGB in rows",
			path, kind.bits, kind.samples);
	err = light  ? image_create_f32(image, (int)kind.width, (int)kind.height)
	      : deep ? image_create_u16(image, (int)kind.width, (int)kind.height)
		     : image_create_u8(image, (int)kind.width, (int)kind.height);
	if (!err)
		err = light || deep ? tiff_read_rows(tiff, &kind, image, &why)
				    : tiff_read_plain(tiff, &kind, image);
	if (err == -ENOMEM)
		return fault_say(fault, err, "%s: not enough memory for the picture", path);
	return why.text[0] ? fault_say(fault, err, "%s: %s", path, why.text) : err;
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

#define TGA_FROM_RIGHT 0x10 /* in byte 17 of a TGA */

static int stb_decode(const uint8_t *data, size_t bytes, const char *path, struct image *image,
		      struct fault *fault)
{
	int width, height, channels, err;
	uint8_t *rgba;

	if (bytes > INT_MAX || !stbi_info_from_memory(data, (int)bytes, &width, &height, &channels))
		return fault_say(fault, -EBADMSG, "%s: damaged: no BMP or TGA that is read", path);
	/* the library minds only whether a TGA begins at the top */
	if (bytes > 17 && data[0] != 'B' && data[17] & TGA_FROM_RIGHT)
		return fault_say(fault, -EBADMSG,
				 "%s: a TGA from the right to the left, expected one from the left",
				 path);
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
