/* SPDX-License-Identifier: MIT */
/*
 * Portable float map: "PF" (colour) or "Pf" (grey), width, height, scale, each followed by one
 * white space character; then rows of float32 from the bottom up. A negative scale means
 * little-endian. Programs do not agree on the meaning of its magnitude, so it is ignored.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/codec.h"

struct pfm_header {
	int channels;
	long long width, height;
	bool little;
	const uint8_t *samples;
};

static bool is_space(uint8_t c)
{
	return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

static bool pfm_probe(const uint8_t *data, size_t bytes)
{
	return bytes >= 3 && data[0] == 'P' && (data[1] == 'F' || data[1] == 'f') &&
	       is_space(data[2]);
}

/* Reads one word of the header and the white space character after it. Returns the place behind
 * them; NULL: there is no word. */
static const uint8_t *pfm_take_word(const uint8_t *at, const uint8_t *end, char *word, size_t room)
{
	size_t length = 0;

	while (at < end && is_space(*at))
		at++;
	while (at < end && !is_space(*at) && length + 1 < room)
		word[length++] = (char)*at++;
	word[length] = '\0';
	return length && at < end && is_space(*at) ? at + 1 : NULL;
}

static bool pfm_take_header(const struct image_source *source, struct pfm_header *header)
{
	const uint8_t *end = source->data + source->bytes;
	const uint8_t *at = source->data + 2;
	char width[16], height[16], scale[32];
	char *stop[3];
	double factor;

	header->channels = source->data[1] == 'F' ? 3 : 1;
	at = pfm_take_word(at, end, width, sizeof(width));
	at = at ? pfm_take_word(at, end, height, sizeof(height)) : NULL;
	at = at ? pfm_take_word(at, end, scale, sizeof(scale)) : NULL;
	if (!at)
		return false;
	header->width = strtoll(width, &stop[0], 10);
	header->height = strtoll(height, &stop[1], 10);
	factor = strtod(scale, &stop[2]);
	header->little = factor < 0;
	/* Some programs end the line with CR LF. */
	header->samples = at + (at[-1] == '\r' && at < end && *at == '\n');
	return !*stop[0] && !*stop[1] && !*stop[2] && (factor < 0 || factor > 0);
}

static float pfm_sample(const uint8_t *at, bool little)
{
	const uint32_t bits = little ? (uint32_t)at[0] | (uint32_t)at[1] << 8 |
					       (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24
				     : (uint32_t)at[3] | (uint32_t)at[2] << 8 |
					       (uint32_t)at[1] << 16 | (uint32_t)at[0] << 24;
	float value;

	memcpy(&value, &bits, sizeof(value));
	return value;
}

static int pfm_read(const struct image_source *source, struct image *image, struct fault *fault)
{
	struct pfm_header header;
	size_t row_bytes, held;
	int err;

	if (!pfm_take_header(source, &header))
		return fault_say(
			fault, -EBADMSG,
			"%s: damaged PFM header, expected PF or Pf, width, height and a scale that is not 0",
			source->name);
	err = image_check_size(source, header.width, header.height, 3 * sizeof(float), fault);
	if (err)
		return err;
	row_bytes = (size_t)header.width * (size_t)header.channels * 4;
	held = source->bytes - (size_t)(header.samples - source->data);
	if (held < row_bytes * (size_t)header.height)
		return fault_say(fault, -EBADMSG,
				 "%s: the PFM is cut short: %zu bytes of samples, expected %zu",
				 source->name, held, row_bytes * (size_t)header.height);
	err = image_create_f32(image, (int)header.width, (int)header.height);
	if (err)
		return fault_say(fault, err, "%s: not enough memory for the picture", source->name);
	for (int y = 0; y < image->height; y++) {
		const uint8_t *in = header.samples + (size_t)(image->height - 1 - y) * row_bytes;
		float *out = image->f32 + (size_t)y * (size_t)image->width * 3;

		for (int x = 0; x < image->width; x++, out += 3)
			for (int c = 0; c < 3; c++)
				out[c] = pfm_sample(in + 4 * (x * header.channels +
							      (header.channels == 3 ? c : 0)),
						    header.little);
	}
	return 0;
}

static int pfm_write(FILE *stream, const struct image *image)
{
	const size_t per_row = (size_t)image->width * 3;
	uint8_t *row = malloc(per_row * 4);
	int err = 0;

	if (!row)
		return -ENOMEM;
	fprintf(stream, "PF\n%d %d\n-1.0\n", image->width, image->height);
	for (int y = image->height - 1; y >= 0 && !err; y--) {
		for (size_t i = 0; i < per_row; i++) {
			uint32_t bits;

			memcpy(&bits, image->f32 + (size_t)y * per_row + i, sizeof(bits));
			row[4 * i] = (uint8_t)bits;
			row[4 * i + 1] = (uint8_t)(bits >> 8);
			row[4 * i + 2] = (uint8_t)(bits >> 16);
			row[4 * i + 3] = (uint8_t)(bits >> 24);
		}
		if (fwrite(row, 4, per_row, stream) != per_row)
			err = -errno;
	}
	free(row);
	return err;
}

const struct image_codec image_pfm = {
	.name = "PFM",
	.ending = ".pfm",
	.linear = true,
	.probe = pfm_probe,
	.read = pfm_read,
	.write = pfm_write,
};
