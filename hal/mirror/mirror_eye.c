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
		const double place[2] = {(x + (k % side + 0.5) / side) / BASIS_MIRROR_SIDE,
					 (y + (double)(k / side * 2 + 1) / (2 * side)) /
						 BASIS_MIRROR_SIDE};
		double d[3], at[2];

		sky_square_direction(place, d);
		eye->tap[(size_t)texel * (size_t)(side * side) + (size_t)k] = find_pixel(eye, lens,
											 d);
		dimmed += fisheye_project(lens, d, at) ? fisheye_falloff(lens, at) : 1;
	}
	eye->brighter[texel] = (float)(1 / fmax(dimmed, 1e-3));
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

#define FILL_ROWS 32 /* of texels that a thread fills at a time */

/* A fill that threads share. */
struct mirror_filling {
	const struct mirror_eye *eye;
	const struct mirror_colours *colours;
	struct mirror_map *map;
	mirror_light column[3]; /* of the matrix */
};

/* Sums what a texel is read at: light, and in the last the number of clipped pixels. */
static mirror_light read_codes(const struct mirror_eye *eye, const uint32_t *tap)
{
	int32_t sum[4] = {0, 0, 0, 0};

	for (int k = 0; k < eye->taps; k++)
		for (int c = 0; c < 4; c++)
			sum[c] += eye->light[tap[k]][c];
	return (mirror_light){(float)sum[0], (float)sum[1], (float)sum[2], (float)sum[3]} *
	       (mirror_light){1.0F / 65535, 1.0F / 65535, 1.0F / 65535, 1};
}

static mirror_light read_linear(const struct mirror_eye *eye, const uint32_t *tap)
{
	mirror_light light = {0, 0, 0, 0};

	for (int k = 0; k < eye->taps; k++) {
		const float *pixel = eye->linear + 3 * (size_t)tap[k];

		light += (mirror_light){pixel[0], pixel[1], pixel[2], 0};
	}
	return light;
}

static void fill_rows(void *context, int item, int worker)
{
	const struct mirror_filling *f = context;
	const struct mirror_eye *eye = f->eye;
	const int end = (item + 1) * FILL_ROWS * BASIS_MIRROR_SIDE;

	(void)worker;
	for (int at = item * FILL_ROWS * BASIS_MIRROR_SIDE; at < end; at++) {
		const uint32_t *tap = eye->tap + (size_t)at * (size_t)eye->taps;
		const mirror_light seen = eye->is_linear ? read_linear(eye, tap)
							 : read_codes(eye, tap);
		mirror_light light =
			(f->column[0] * seen[0] + f->column[1] * seen[1] + f->column[2] * seen[2]) *
			eye->brighter[at];

		for (int c = 0; c < 3 && seen[3] > 0; c++)
			light[c] = mirror_clamp(light[c]) +
				   (float)f->colours->clipped[f->map->cell[at]][c] * seen[3] /
					   (float)eye->taps;
		for (int c = 0; c < 3; c++)
			light[c] = mirror_clamp(light[c]);
		f->map->texel[0][at] = light;
	}
}

void mirror_eye_fill(const struct mirror_eye *eye, const struct mirror_colours *colours,
		     struct pool *pool, struct mirror_map *map)
{
	struct mirror_filling f = {.eye = eye, .colours = colours, .map = map};

	for (int k = 0; k < 9; k++)
		f.column[k % 3][k / 3] = (float)colours->matrix[k];
	pool_run(pool, BASIS_MIRROR_SIDE / FILL_ROWS, fill_rows, &f);
	mirror_map_finish(map);
}
