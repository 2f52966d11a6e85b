/* SPDX-License-Identifier: MIT */
#include "hal/mirror/mirror_eye.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/sky_square.h"

/* The first level that is filled has texels of up to so many pixels, at the middle of the lens. */
#define TEXEL_PIXELS 1.5
/* A texel is read at so many places a side that no pixel lies between them, within these. */
#define TAPS_LEAST 2
#define TAPS_MOST 4
/* Steps, of half a pixel, towards the middle of the picture in search of a pixel that is all sky:
 * at the rim a pixel shows less. */
#define RIM_STEPS 8

#define FILL_ROWS 32 /* of texels that a thread fills at a time */

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
	const int across = BASIS_MIRROR_SIDE >> eye->level;
	const int x = texel % across, y = texel / across;
	double dimmed = 0;

	for (int k = 0; k < side * side; k++) {
		const double place[2] = {(x + (k % side + 0.5) / side) / across,
					 (y + (double)(k / side * 2 + 1) / (2 * side)) / across};
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
	double pixels = sqrt(2 * M_PI / MIRROR_TEXELS) * fmax(lens->focal_px[0], lens->focal_px[1]);
	size_t texels = MIRROR_TEXELS;
	int side;
	const size_t count = (size_t)width * (size_t)height;

	mirror_eye_free(eye);
	for (; 2 * pixels <= TEXEL_PIXELS && BASIS_MIRROR_SIDE >> eye->level > FILL_ROWS;
	     pixels *= 2) {
		eye->level++;
		texels /= 4;
	}
	side = (int)fmin(fmax(ceil(pixels), TAPS_LEAST), TAPS_MOST);
	eye->width = width;
	eye->height = height;
	eye->taps = side * side;
	eye->tap = malloc(texels * (size_t)eye->taps * sizeof(*eye->tap));
	eye->brighter = malloc(texels * sizeof(*eye->brighter));
	eye->row = aligned_alloc(64, ((size_t)width * sizeof(*eye->row) + 63) / 64 * 64);
	eye->light = calloc(count, sizeof(*eye->light));
	if (!eye->tap || !eye->brighter || !eye->row || !eye->light) {
		mirror_eye_free(eye);
		return -ENOMEM;
	}
	for (int texel = 0; texel < (int)texels; texel++)
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

/* A fill that threads share. */
struct mirror_filling {
	const struct mirror_eye *eye;
	const struct mirror_colours *colours;
	struct mirror_map *map;
	mirror_light column[3]; /* of the matrix */
};

typedef uint16_t pixel_codes __attribute__((vector_size(8)));
typedef int32_t sum_of_codes __attribute__((vector_size(16)));

/* Sums what a texel is read at: light, and in the last the number of clipped pixels. */
static inline mirror_light read_codes(const struct mirror_eye *eye, const uint32_t *tap, int taps)
{
	sum_of_codes sum = {0, 0, 0, 0};

	for (int k = 0; k < taps; k++) {
		pixel_codes pixel;

		memcpy(&pixel, eye->light[tap[k]], sizeof(pixel));
		sum += __builtin_convertvector(pixel, sum_of_codes);
	}
	return __builtin_convertvector(sum, mirror_light) *
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

static mirror_light read_texel(const struct mirror_eye *eye, const uint32_t *tap)
{
	if (eye->is_linear)
		return read_linear(eye, tap);
	return eye->taps == TAPS_LEAST * TAPS_LEAST ? read_codes(eye, tap, TAPS_LEAST * TAPS_LEAST)
						    : read_codes(eye, tap, eye->taps);
}

/* mirror_clamp() of each. */
static inline mirror_light clamp_colours(mirror_light light)
{
	const sum_of_codes least = (sum_of_codes)light & (light > 0);
	const sum_of_codes below = (mirror_light)least < MIRROR_MOST;
	const mirror_light most = {MIRROR_MOST, MIRROR_MOST, MIRROR_MOST, MIRROR_MOST};

	return (mirror_light)((least & below) | ((sum_of_codes)most & ~below));
}

static void fill_rows(void *context, int item, int worker)
{
	const struct mirror_filling *f = context;
	const struct mirror_eye *eye = f->eye;
	const int across = BASIS_MIRROR_SIDE >> eye->level;

	(void)worker;
	for (int at = item * FILL_ROWS * across; at < (item + 1) * FILL_ROWS * across; at++) {
		const uint32_t *tap = eye->tap + (size_t)at * (size_t)eye->taps;
		const mirror_light seen = read_texel(eye, tap);
		mirror_light light =
			(f->column[0] * seen[0] + f->column[1] * seen[1] + f->column[2] * seen[2]) *
			eye->brighter[at];

		if (seen[3] > 0) {
			const double *more =
				f->colours->clipped[mirror_cell(f->map, eye->level, at)];

			light = clamp_colours(light) +
				(mirror_light){(float)more[0], (float)more[1], (float)more[2], 0} *
					(seen[3] / (float)eye->taps);
		}
		f->map->texel[eye->level][at] = clamp_colours(light);
	}
}

void mirror_eye_fill(const struct mirror_eye *eye, const struct mirror_colours *colours,
		     struct pool *pool, struct mirror_map *map)
{
	struct mirror_filling f = {.eye = eye, .colours = colours, .map = map};

	for (int k = 0; k < 9; k++)
		f.column[k % 3][k / 3] = (float)colours->matrix[k];
	map->least = eye->level;
	pool_run(pool, (BASIS_MIRROR_SIDE >> eye->level) / FILL_ROWS, fill_rows, &f);
	mirror_map_finish(map);
}
