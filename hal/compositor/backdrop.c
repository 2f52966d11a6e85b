/* SPDX-License-Identifier: MIT */
#include "hal/compositor/backdrop.h"

#include <string.h>

struct backdrop backdrop_of(const struct picture *picture)
{
	return (struct backdrop){
		.width = picture->width, .height = picture->height, .picture = *picture};
}

static const uint8_t *picture_pixel(const struct picture *picture, int x, int y)
{
	return picture->origin + y * picture->y_step + x * picture->x_step;
}

/* Copies a row of a rotated or mirrored picture. */
static void turn_row(uint8_t *out, const uint8_t *in, ptrdiff_t step, int width)
{
	for (int x = 0; x < width; x++, in += step, out += 4)
		memcpy(out, in, 4);
}

struct backdrop_rows backdrop_rows(const struct backdrop *b, struct area area, uint8_t *scratch)
{
	const size_t stride = (size_t)area.width * 4;
	const struct picture *p = &b->picture;

	if (b->make) {
		b->make(b->context, area.x, area.y, area.width, area.height, scratch, stride);
		return (struct backdrop_rows){scratch, (ptrdiff_t)stride};
	}
	if (p->x_step == 4)
		return (struct backdrop_rows){picture_pixel(p, area.x, area.y), p->y_step};
	for (int y = 0; y < area.height; y++)
		turn_row(scratch + (size_t)y * stride, picture_pixel(p, area.x, area.y + y),
			 p->x_step, area.width);
	return (struct backdrop_rows){scratch, (ptrdiff_t)stride};
}

/* Copies a row with X = 255, four bytes at a time. */
static void copy_row(uint8_t *restrict out, const uint8_t *restrict in, int width)
{
	const uint8_t opaque[4] = {0, 0, 0, 255};
	uint32_t pixel, filler;

	memcpy(&filler, opaque, sizeof(filler));
	for (int x = 0; x < width; x++) {
		memcpy(&pixel, in + (size_t)x * 4, sizeof(pixel));
		pixel |= filler;
		memcpy(out + (size_t)x * 4, &pixel, sizeof(pixel));
	}
}

static void recode_row(uint8_t *restrict out, const uint8_t *restrict in, int width,
		       const uint8_t *recode)
{
	for (int x = 0; x < width; x++, in += 4, out += 4) {
		for (int c = 0; c < 3; c++)
			out[c] = recode[in[c]];
		out[3] = 255;
	}
}

void backdrop_copy_rows(struct backdrop_rows rows, int width, int height, const uint8_t *recode,
			uint8_t *out, size_t out_stride)
{
	for (int y = 0; y < height; y++, rows.pixels += rows.stride, out += out_stride) {
		if (recode)
			recode_row(out, rows.pixels, width, recode);
		else
			copy_row(out, rows.pixels, width);
	}
}

void backdrop_copy(const struct backdrop *b, struct area area, const uint8_t *recode,
		   uint8_t *scratch, uint8_t *out, size_t out_stride)
{
	if (b->make && !recode) {
		b->make(b->context, area.x, area.y, area.width, area.height, out, out_stride);
		return;
	}
	for (int y = 0; y < area.height; y++, out += out_stride) {
		const struct area row = {area.x, area.y + y, area.width, 1};

		backdrop_copy_rows(backdrop_rows(b, row, scratch), area.width, 1, recode, out,
				   out_stride);
	}
}
