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

/* Texels ahead of that which is filled whose pixels are fetched: their order is the sky's, which
 * the processor does not foresee. */
#define FETCH_AHEAD 24

/* ---- where a texel is in the picture ---- */

/* Whether the middle of a pixel is in the lens's field, and above the horizon. */
static bool is_sky(const struct fisheye *lens, const struct mirror_eye *eye, int x, int y)
{
	const double middle[2] = {x + 0.5, y + 0.5};
	double d[3];

	return x >= 0 && y >= 0 && x < eye->width && y < eye->height &&
	       fisheye_ray(lens, middle, d) && d[2] >= 0;
}

/* Finds the pixel that shows a direction, and the lens's falloff there; 1 beside its field. */
static uint32_t find_pixel(const struct mirror_eye *eye, const struct fisheye *lens,
			   const double d[3], double *falloff)
{
	double at[2], step[2], length;

	*falloff = 1;
	if (fisheye_project(lens, d, at))
		*falloff = fisheye_falloff(lens, at);
	else
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
		double d[3], falloff;

		sky_square_direction(place, d);
		eye->tap[(size_t)texel * (size_t)(side * side) + (size_t)k] =
			find_pixel(eye, lens, d, &falloff);
		dimmed += falloff;
	}
	eye->brighter[texel] = (float)(1 / fmax(dimmed, 1e-3));
}

int mirror_eye_prepare(struct mirror_eye *eye, const struct fisheye *lens, int width, int height)
{
	double pixels = sqrt(2 * M_PI / MIRROR_TEXELS) * fmax(lens->focal_px[0], lens->focal_px[1]);
	size_t texels = MIRROR_TEXELS;
	int side;

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
	eye->tap = calloc((texels + FETCH_AHEAD) * (size_t)eye->taps, sizeof(*eye->tap));
	eye->brighter = malloc(texels * sizeof(*eye->brighter));
	if (!eye->tap || !eye->brighter) {
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
	for (int k = 0; k < EXPOSURES_MAX; k++)
		free(eye->code[k]);
	free(eye->linear);
	*eye = (struct mirror_eye){.width = 0};
}

/* ---- pictures ---- */

int mirror_eye_take(struct mirror_eye *eye, const struct frame_reader *frame, int exposure)
{
	const size_t width = (size_t)eye->width;
	uint32_t **code = &eye->code[exposure];

	if (!*code)
		*code = malloc(width * (size_t)eye->height * sizeof(**code));
	if (!*code)
		return -ENOMEM;
	eye->is_linear = false;
	for (int y = 0; y < eye->height; y++) {
		uint32_t *to = *code + (size_t)y * width;
		const uint32_t *row = frame_reader_row(frame, 0, y, eye->width, to);

		if (row != to)
			memcpy(to, row, width * sizeof(*to));
	}
	return 0;
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
	/* Light of each code of R, G and B, by the matrix; the last is above 0 where it clips. */
	mirror_light light[3][256];
};

static void fill_light(struct mirror_filling *f)
{
	for (int k = 0; k < 9; k++)
		f->column[k % 3][k / 3] = (float)f->colours->matrix[k];
	for (int k = 0; k < 3 * 256; k++) {
		f->light[k / 256][k % 256] = f->column[k / 256] *
					     (float)f->colours->decode[k % 256];
		f->light[k / 256][k % 256][3] = k % 256 == 255;
	}
}

/* Light of a pixel; the last is above 0 where it clips. */
static inline mirror_light read_code(const struct mirror_filling *f, uint32_t code)
{
	return (f->light[0][code >> 16 & 255] + f->light[1][code >> 8 & 255]) +
	       f->light[2][code & 255];
}

/* Sums what a texel is read at. */
static inline mirror_light read_codes(const struct mirror_filling *f, const uint32_t *tap, int taps)
{
	mirror_light sum = {0, 0, 0, 0};

	for (int k = 0; k < taps; k++)
		sum += read_code(f, f->eye->code[0][tap[k]]);
	return sum;
}

/* The same where pixels clip: of each, the longest exposure in which it does not, and at least what
 * the first one has; in the last the number of those that clip in all. */
static mirror_light read_clipped(const struct mirror_filling *f, const uint32_t *tap)
{
	mirror_light sum = {0, 0, 0, 0};

	for (int k = 0; k < f->eye->taps; k++) {
		const mirror_light first = read_code(f, f->eye->code[0][tap[k]]);
		mirror_light light = first;

		for (int n = 1; n < EXPOSURES_MAX && f->eye->code[n] && light[3] > 0; n++) {
			const mirror_light own = read_code(f, f->eye->code[n][tap[k]]);

			for (int c = 0; c < 3; c++)
				light[c] = fmaxf(own[c] / (float)f->colours->ratio[n], first[c]);
			light[3] = own[3];
		}
		light[3] = light[3] > 0;
		sum += light;
	}
	return sum;
}

static mirror_light read_linear(const struct mirror_filling *f, const uint32_t *tap)
{
	mirror_light light = {0, 0, 0, 0};

	for (int k = 0; k < f->eye->taps; k++) {
		const float *pixel = f->eye->linear + 3 * (size_t)tap[k];

		for (int c = 0; c < 3; c++)
			light += f->column[c] * pixel[c];
	}
	return light;
}

static inline mirror_light read_texel(const struct mirror_filling *f, const uint32_t *tap)
{
	const int taps = f->eye->taps;
	const uint32_t *code = f->eye->code[0], *ahead = tap + FETCH_AHEAD * taps;

	if (f->eye->is_linear)
		return read_linear(f, tap);
	__builtin_prefetch(&code[ahead[0]]);
	__builtin_prefetch(&code[ahead[taps / 2]]);
	return taps == TAPS_LEAST * TAPS_LEAST ? read_codes(f, tap, TAPS_LEAST * TAPS_LEAST)
					       : read_codes(f, tap, taps);
}

static void fill_row(const struct mirror_filling *f, int y)
{
	const struct mirror_eye *eye = f->eye;
	const struct mirror_span span = mirror_spans(f->map, eye->level)[y];
	mirror_light *row = mirror_texels(f->map, eye->level) + y * MIRROR_STRIDE;

	for (int x = span.first; x < span.end; x++) {
		const int at = y * (BASIS_MIRROR_SIDE >> eye->level) + x;
		const uint32_t *tap = eye->tap + (size_t)at * (size_t)eye->taps;
		const mirror_light seen = read_texel(f, tap);
		mirror_light light = seen * eye->brighter[at];

		if (seen[3] > 0) {
			const double *more =
				f->colours->clipped[mirror_cell(f->map, eye->level, x, y)];
			const mirror_light whole = read_clipped(f, tap);

			light = whole * eye->brighter[at];
			for (int c = 0; c < 3; c++)
				light[c] += (float)more[c] * whole[3] / (float)eye->taps;
		}
		row[x] = mirror_clamp(light);
	}
}

static void fill_rows(void *context, int item, int worker)
{
	(void)worker;
	for (int y = item * FILL_ROWS; y < (item + 1) * FILL_ROWS; y++)
		fill_row(context, y);
}

void mirror_eye_fill(const struct mirror_eye *eye, const struct mirror_colours *colours,
		     struct pool *pool, struct mirror_map *map)
{
	struct mirror_filling f = {.eye = eye, .colours = colours, .map = map};

	fill_light(&f);
	map->least = eye->level;
	pool_run(pool, (BASIS_MIRROR_SIDE >> eye->level) / FILL_ROWS, fill_rows, &f);
	mirror_map_finish(map);
}
