/* SPDX-License-Identifier: MIT */
/*
 * Radiance pictures (.hdr, .pic): text header, then RGBE pixels, flat or run-length coded in the
 * old way (runs of whole pixels) or the new one (each of the four bytes by itself).
 *
 * A byte m with exponent e stands for
 *     m * 2^(e - 136)
 * as in most programs, so that powers of two are exact; Radiance itself adds half a step to m.
 * EXPOSURE and COLORCORR lines are factors that the radiance was multiplied by; the reader divides
 * by them.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/codec.h"

/* Only rows of these widths may be in the new coding. */
#define NEW_CODING_MIN 8
#define NEW_CODING_MAX 32767

struct hdr_reader {
	const uint8_t *at, *end;
	double scale[3]; /* from values in the file to radiance */
	/* The resolution line: rows (columns when by_column) of length pixels. */
	long long rows, length;
	bool by_column;
	bool flip_rows, flip_pixels; /* the first row is the lower or right one; rows run from right
					to left, or from below */
};

static bool hdr_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 2 && data[0] == '#' && data[1] == '?';
}

/* Reads the next line of the header, without its line break; cuts lines longer than room. False at
 * the end of the file. */
static bool hdr_take_line(struct hdr_reader *reader, char *line, size_t room)
{
	size_t length = 0;

	if (reader->at == reader->end)
		return false;
	while (reader->at < reader->end && *reader->at != '\n') {
		if (length + 1 < room && *reader->at != '\r')
			line[length++] = (char)*reader->at;
		reader->at++;
	}
	line[length] = '\0';
	if (reader->at < reader->end)
		reader->at++;
	return true;
}

static bool hdr_take_scale(struct hdr_reader *reader, const char *text, int channels)
{
	for (int c = 0; c < 3; c++) {
		static const double smallest = 1e-30, largest = 1e30;
		char *stop = NULL;
		const double value = strtod(text, &stop);

		if (stop == text || !(value >= smallest && value <= largest))
			return false;
		reader->scale[c] /= value;
		if (channels == 3)
			text = stop;
	}
	return true;
}

/* Whether the text is "32-bit_rle_rgbe" with any blanks around it. */
static bool is_rgbe(const char *text)
{
	static const char rgbe[] = "32-bit_rle_rgbe";

	text += strspn(text, " \t");
	return !strncmp(text, rgbe, strlen(rgbe)) &&
	       !text[strlen(rgbe) + strspn(text + strlen(rgbe), " \t")];
}

static int hdr_take_primaries(const struct image_source *source, const char *text,
			      struct fault *fault)
{
	double xy[8];
	bool said = false;

	for (int k = 0; k < 8; k++) {
		char *stop = NULL;

		xy[k] = strtod(text, &stop);
		if (stop == text)
			return fault_say(
				fault, -EBADMSG,
				"%s: the HDR header says PRIMARIES and %d numbers, expected 8",
				source->name, k);
		said |= xy[k] != 0;
		text = stop;
	}
	/* Some programs write eight zeros if they know no primaries. */
	return said ? image_check_primaries(source, xy, fault) : 0;
}

static int hdr_take_header(struct hdr_reader *reader, const struct image_source *source,
			   struct fault *fault)
{
	const char *name = source->name;
	char line[256];

	do {
		bool fine = true;
		int err = 0;

		if (!hdr_take_line(reader, line, sizeof(line)))
			return fault_say(fault, -EBADMSG, "%s: the HDR header has no end", name);
		if (!strncmp(line, "FORMAT=", 7) && !is_rgbe(line + 7))
			return fault_say(
				fault, -ENOTSUP,
				"%s: the HDR is of format \"%.40s\", expected 32-bit_rle_rgbe",
				name, line + 7);
		if (!strncmp(line, "EXPOSURE=", 9))
			fine = hdr_take_scale(reader, line + 9, 1);
		else if (!strncmp(line, "COLORCORR=", 10))
			fine = hdr_take_scale(reader, line + 10, 3);
		else if (!strncmp(line, "PRIMARIES=", 10))
			err = hdr_take_primaries(source, line + 10, fault);
		if (err)
			return err;
		if (!fine)
			return fault_say(
				fault, -EBADMSG,
				"%s: the HDR header says \"%.60s\", expected numbers above 0", name,
				line);
	} while (line[0]);
	return 0;
}

/* Reads the resolution line. "-Y 512 +X 1024" means rows from the top, each from the left; all
 * signs and both orders are valid. */
static int hdr_take_resolution(struct hdr_reader *reader, const char *name, struct fault *fault)
{
	char line[64], sign[2], axis[2], rest;
	bool backwards[2];

	if (!hdr_take_line(reader, line, sizeof(line)) ||
	    sscanf(line, "%c%c %9lld %c%c %9lld%c", &sign[0], &axis[0], &reader->rows, &sign[1],
		   &axis[1], &reader->length, &rest) != 6 ||
	    !((axis[0] == 'Y' && axis[1] == 'X') || (axis[0] == 'X' && axis[1] == 'Y')) ||
	    !strchr("+-", sign[0]) || !strchr("+-", sign[1]))
		return fault_say(
			fault, -EBADMSG,
			"%s: damaged HDR: expected a line like \"-Y 512 +X 1024\" after the header",
			name);
	reader->by_column = axis[0] == 'X';
	/* X grows to the right, Y upwards. */
	for (int i = 0; i < 2; i++)
		backwards[i] = (axis[i] == 'X') == (sign[i] == '-');
	reader->flip_rows = backwards[0];
	reader->flip_pixels = backwards[1];
	return 0;
}

static bool hdr_take_planes(struct hdr_reader *reader, uint8_t (*row)[4], int length)
{
	for (int c = 0; c < 4; c++)
		for (int x = 0; x < length;) {
			const int code = reader->at < reader->end ? *reader->at++ : 0;
			const bool run = code > 128;
			const int count = run ? code - 128 : code;
			const ptrdiff_t needed = run ? 1 : count;

			if (!count || count > length - x || reader->end - reader->at < needed)
				return false;
			for (int i = 0; i < count; i++)
				row[x++][c] = reader->at[run ? 0 : i];
			reader->at += needed;
		}
	return true;
}

static bool hdr_take_pixels(struct hdr_reader *reader, uint8_t (*row)[4], int length)
{
	int shift = 0;

	for (int x = 0; x < length; reader->at += 4) {
		const uint8_t *in = reader->at;

		if (reader->end - in < 4)
			return false;
		if (in[0] == 1 && in[1] == 1 && in[2] == 1) {
			/* Successive run records are base-256 digits of one count, lowest first. */
			const int64_t count = shift < 24 ? (int64_t)in[3] << shift : INT64_MAX;

			if (!x || count > length - x)
				return false;
			for (int64_t i = 0; i < count; i++, x++)
				memcpy(row[x], row[x - 1], 4);
			shift += 8;
		} else {
			memcpy(row[x++], in, 4);
			shift = 0;
		}
	}
	return true;
}

static bool take_row(struct hdr_reader *reader, uint8_t (*row)[4], int length)
{
	const uint8_t *in = reader->at;

	if (length < NEW_CODING_MIN || length > NEW_CODING_MAX || reader->end - in < 4 ||
	    in[0] != 2 || in[1] != 2 || in[2] & 0x80)
		return hdr_take_pixels(reader, row, length);
	if ((in[2] << 8 | in[3]) != length)
		return false;
	reader->at += 4;
	return hdr_take_planes(reader, row, length);
}

static void place_row(const struct hdr_reader *reader, const uint8_t (*row)[4], int number,
		      struct image *image)
{
	const int rows = (int)reader->rows, length = (int)reader->length;
	const size_t across = reader->flip_rows ? (size_t)(rows - 1 - number) : (size_t)number;

	for (int i = 0; i < length; i++) {
		const size_t along = reader->flip_pixels ? (size_t)(length - 1 - i) : (size_t)i;
		const size_t x = reader->by_column ? across : along;
		const size_t y = reader->by_column ? along : across;
		float *out = image->f32 + (y * (size_t)image->width + x) * 3;

		for (int c = 0; c < 3; c++)
			out[c] = row[i][3] ? (float)(ldexp(row[i][c], row[i][3] - 136) *
						     reader->scale[c])
					   : 0;
	}
}

static int take_picture(struct hdr_reader *reader, const char *name, struct image *image,
			struct fault *fault)
{
	uint8_t(*row)[4] = malloc((size_t)reader->length * sizeof(*row));
	int err = 0;

	if (!row)
		return fault_say(fault, -ENOMEM, "%s: not enough memory for the picture", name);
	for (int y = 0; y < reader->rows && !err; y++) {
		if (take_row(reader, row, (int)reader->length))
			place_row(reader, (const uint8_t(*)[4])row, y, image);
		else
			err = fault_say(fault, -EBADMSG,
					"%s: the HDR is damaged or cut short at row %d of %lld",
					name, y + 1, reader->rows);
	}
	free(row);
	return err;
}

static int hdr_read(const struct image_source *source, struct image *image, struct fault *fault)
{
	struct hdr_reader reader = {
		.at = source->data,
		.end = source->data + source->bytes,
		.scale = {1, 1, 1},
	};
	int64_t width, height;
	int err;

	err = hdr_take_header(&reader, source, fault);
	if (!err)
		err = hdr_take_resolution(&reader, source->name, fault);
	if (err)
		return err;
	width = reader.by_column ? reader.rows : reader.length;
	height = reader.by_column ? reader.length : reader.rows;
	err = image_check_size(source, width, height, 3 * sizeof(float), fault);
	if (err)
		return err;
	err = image_create_f32(image, (int)width, (int)height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	return take_picture(&reader, source->name, image, fault);
}

/* Converts a pixel to RGBE, rounded to nearest. Values above the largest RGBE become the largest,
 * values below the smallest become 0. */
static void to_rgbe(const float rgb[3], uint8_t rgbe[4])
{
	const float peak = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2]));
	int exponent;
	double scale;

	frexp(peak, &exponent);
	/* A mantissa just below 1 would round to 256. */
	if (lrint(ldexp(peak, 8 - exponent)) > 255)
		exponent++;
	memset(rgbe, 0, 4);
	if (!(peak > 0) || exponent < -127)
		return;
	if (exponent > 127)
		exponent = 127;
	scale = ldexp(1, 8 - exponent);
	for (int c = 0; c < 3; c++)
		rgbe[c] = (uint8_t)lrint(fmin(255, fmax(0, rgb[c] * scale)));
	rgbe[3] = (uint8_t)(exponent + 128);
}

/* Writes flat pixels, which every reader takes: those of to_rgbe() have a mantissa of 128 or more,
 * and so begin no code of runs. */
static int hdr_write(FILE *stream, const struct image *image)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;

	fprintf(stream, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n", image->height,
		image->width);
	for (size_t i = 0; i < pixels; i++) {
		uint8_t rgbe[4];

		to_rgbe(image->f32 + 3 * i, rgbe);
		if (fwrite(rgbe, 1, 4, stream) != 4)
			return -errno;
	}
	return 0;
}

const struct image_codec image_hdr = {
	.name = "Radiance HDR",
	.ending = ".hdr",
	.linear = true,
	.probe = hdr_probe,
	.read = hdr_read,
	.write = hdr_write,
};
