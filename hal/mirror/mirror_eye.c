/* SPDX-License-Identifier: MIT */
#include "hal/mirror/mirror_eye.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/sky_square.h"

/* A texel is read at so many places a side that no pixel lies between them, within these. */
#define TAPS_LEAST 2
#define TAPS_MOST 4
/* Steps, of half a pixel, towards the middle of the picture in search of a pixel that is all sky:
 * at the rim a pixel shows less. */
#define RIM_STEPS 8
#define COLOUR_BITS 20 /* of a colour's factor; 4 taps, 65535 and a gain of 2^20 fit in 2^63 */

/* ---- where a texel is in the picture ---- */

/* Whether the middle of a pixel is in the lens's field, and above the horizon. */
static bool is_sky(const struct fisheye *lens, const struct mirror_eye *eye, int x, int y)
{
	const double middle[2] = {x + 0.5, y + 0.5};
	double d[3];

	return x >= 0 && y >= 0 && x < eye->width && y < eye->height &&
	       fisheye_ray(lens, middle, d) && d[2] >= 0;
}

static uint32_t find_pixel(const struct mirror_eye *eye, const struct fisheye *lens,
			   const double d[3])
{
	double at[2], step[2], length;

	if (!fisheye_project(lens, d, at))
		memcpy(at, lens->centre_px, sizeof(at));
	for (int k = 0; k < 2; k++)
		step[k] = lens->centre_px[k] - at[k];
	length = hypot(step[0], step[1]);
	for (int k = 0; k < RIM_STEPS && length > 0 &&
			!is_sky(lens, eye, (int)floor(at[0]), (int)floor(at[1]));
	     k++)
		for (int axis = 0; axis < 2; axis++)
			at[axis] += 0.5 * step[axis] / length;
	at[0] = fmin(fmax(floor(at[0]), 0), eye->width - 1);
	at[1] = fmin(fmax(floor(at[1]), 0), eye->height - 1);
	return (uint32_t)at[1] * (uint32_t)eye->width + (uint32_t)at[0];
}

static void fill_texel(struct mirror_eye *eye, const struct fisheye *lens, int texel, int side)
{
	const int x = texel % BASIS_MIRROR_SIDE, y = texel / BASIS_MIRROR_SIDE;
	double dimmed = 0;

	for (int k = 0; k < side * side; k++) {
		const double place[2] = {
			(x + (k % side + 0.5) / side) / BASIS_MIRROR_SIDE,
			(y + (double)(k / side * 2 + 1) / (2 * side)) / BASIS_MIRROR_SIDE};
		double d[3], at[2];

		sky_square_direction(place, d);
		eye->tap[(size_t)texel * (size_t)(side * side) + (size_t)k] = find_pixel(eye, lens,
											 d);
		dimmed += fisheye_project(lens, d, at) ? fisheye_falloff(lens, at) : 1;
	}
	eye->brighter[texel] =
		(uint16_t)fmin(floor(4096 * side * side / fmax(dimmed, 1e-6) + 0.5), UINT16_MAX);
}

int mirror_eye_prepare(struct mirror_eye *eye, const struct fisheye *lens, int width, int height)
{
	const double texel_rad = sqrt(2 * M_PI / MIRROR_TEXELS);
	const double pixels = texel_rad * fmax(lens->focal_px[0], lens->focal_px[1]);
	const int side = (int)fmin(fmax(ceil(pixels), TAPS_LEAST), TAPS_MOST);
	const size_t count = (size_t)width * (size_t)height;

	mirror_eye_free(eye);
	eye->width = width;
	eye->height = height;
	eye->taps = side * side;
	eye->tap = malloc((size_t)MIRROR_TEXELS * (size_t)eye->taps * sizeof(*eye->tap));
	eye->brighter = malloc(MIRROR_TEXELS * sizeof(*eye->brighter));
	eye->row = aligned_alloc(64, ((size_t)width * sizeof(*eye->row) + 63) / 64 * 64);
	eye->light = calloc(count, sizeof(*eye->light));
	if (!eye->tap || !eye->brighter || !eye->row || !eye->light) {
		mirror_eye_free(eye);
		return -ENOMEM;
	}
	for (int texel = 0; texel < MIRROR_TEXELS; texel++)
		fill_texel(eye, lens, texel, side);
	return 0;
}

void mirror_eye_free(struct mirror_eye *eye)
{
	free(eye->tap);
	free(eye->brighter);
	free(eye->row);
	free(eye->light);
	free(eye->linear);
	*eye = (struct mirror_eye){.width = 0};
}

/* ---- pictures ---- */

void mirror_eye_take(struct mirror_eye *eye, const struct frame_reader *frame,
		     const uint16_t decode[256])
{
	uint16_t(*to)[4] = eye->light;

	eye->is_linear = false;
	for (int y = 0; y < eye->height; y++) {
		const uint32_t *row = frame_reader_row(frame, 0, y, eye->width, eye->row);

		for (int x = 0; x < eye->width; x++, to++) {
			const uint32_t code[3] = {row[x] >> 16 & 255, row[x] >> 8 & 255,
						  row[x] & 255};

			for (int c = 0; c < 3; c++)
				(*to)[c] = decode[code[c]];
			(*to)[3] = code[0] == 255 || code[1] == 255 || code[2] == 255;
		}
	}
}

int mirror_eye_take_linear(struct mirror_eye *eye, const struct image *picture)
{
	const size_t bytes = 3 * (size_t)eye->width * (size_t)eye->height * sizeof(*eye->linear);

	if (!eye->linear)
		eye->linear = malloc(bytes);
	if (!eye->linear)
		return -ENOMEM;
	memcpy(eye->linear, picture->f32, bytes);
	eye->is_linear = true;
	return 0;
}

/* Factors of a texel's sums, COLOUR_BITS fraction bits, whose result is a texel's value:
 *     2^MIRROR_ONE_BITS / (65535 taps) * colours */
static void fill_factors(const struct mirror_eye *eye, const struct mirror_light *light,
			 int64_t factor[3][3])
{
	const double one = ldexp(1, MIRROR_ONE_BITS + COLOUR_BITS) / (65535.0 * eye->taps);

	for (int k = 0; k < 9; k++)
		factor[k / 3][k % 3] =
			llrint(fmin(fmax(one * light->colours[k], -0x1p40), 0x1p40));
}

static void fill_from_codes(const struct mirror_eye *eye, const struct mirror_light *light,
			    struct mirror_map *map)
{
	const uint32_t *tap = eye->tap;
	int64_t factor[3][3];

	fill_factors(eye, light, factor);
	for (int at = 0; at < MIRROR_TEXELS; at++, tap += eye->taps) {
		int64_t sum[4] = {0, 0, 0, 0};

		for (int k = 0; k < eye->taps; k++)
			for (int c = 0; c < 4; c++)
				sum[c] += eye->light[tap[k]][c];
		for (int c = 0; c < 3; c++) {
			int64_t value = (factor[c][0] * sum[0] + factor[c][1] * sum[1] +
					 factor[c][2] * sum[2] + (1 << (COLOUR_BITS - 1))) >>
					COLOUR_BITS;

			value = value < 0 ? 0 : value > UINT32_MAX ? UINT32_MAX : value;
			value = (value * eye->brighter[at] + 2048) >> 12;
			if (sum[3] && light->clipped)
				value += mirror_texel_of(light->clipped[map->cell[at]][c] *
							 (double)sum[3] / eye->taps);
			map->texel[0][at].light[c] =
				(uint32_t)(value > UINT32_MAX ? UINT32_MAX : value);
		}
	}
}

static void fill_from_linear(const struct mirror_eye *eye, const struct mirror_light *light,
			     struct mirror_map *map)
{
	const uint32_t *tap = eye->tap;

	for (int at = 0; at < MIRROR_TEXELS; at++, tap += eye->taps) {
		const double brighter = eye->brighter[at] / (4096.0 * eye->taps);
		double sum[3] = {0, 0, 0};

		for (int k = 0; k < eye->taps; k++)
			for (int c = 0; c < 3; c++)
				sum[c] += (double)eye->linear[3 * (size_t)tap[k] + (size_t)c];
		for (int c = 0; c < 3; c++)
			map->texel[0][at].light[c] = mirror_texel_of(
				brighter * (light->colours[3 * c] * sum[0] +
					    light->colours[3 * c + 1] * sum[1] +
					    light->colours[3 * c + 2] * sum[2]));
	}
}

void mirror_eye_fill(const struct mirror_eye *eye, const struct mirror_light *light,
		     struct mirror_map *map)
{
	if (eye->is_linear)
		fill_from_linear(eye, light, map);
	else
		fill_from_codes(eye, light, map);
	mirror_map_finish(map);
}
