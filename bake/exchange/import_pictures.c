/* SPDX-License-Identifier: MIT */
#include "bake/exchange/import_pictures.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/image.h"

/* Below this share of the brightest ground a pixel has no ground. */
#define NO_GROUND 1e-4

const char *const import_receivers_names[] = {"auto", "flat", "own", NULL};

/* ---- which pixels are what ---- */

static int read_coverage(struct import_pictures *p, const struct import_pictures_settings *settings,
			 struct fault *fault)
{
	const char *name = settings->coverage ? settings->coverage : settings->mask;
	const size_t pixels = (size_t)p->with.width * (size_t)p->with.height;
	struct image picture;
	int err = image_read(name, &picture, fault);

	if (err)
		return err;
	if (picture.width != p->with.width || picture.height != p->with.height)
		err = fault_say(fault, -EINVAL, "%s: %d x %d pixels, expected %d x %d as in %s",
				name, picture.width, picture.height, p->with.width, p->with.height,
				settings->object);
	for (size_t k = 0; !err && k < pixels; k++) {
		const float value = picture.u8 ? (float)picture.u8[3 * k + 1] / 255
					       : picture.f32[3 * k + 1];

		p->coverage[k] = settings->coverage ? fminf(value, 1) : value >= 0.5f;
	}
	image_free(&picture);
	return err;
}

static void find_ground(struct import_pictures *p)
{
	const size_t pixels = (size_t)p->with.width * (size_t)p->with.height;
	float *sum = calloc(pixels, sizeof(*sum)), most = 0;

	for (int i = 0; sum && i < p->without.count; i++) {
		const float *value = picture_stack_at(&p->without, i, 0, 0);

		for (size_t k = 0; k < pixels; k++)
			sum[k] += value[3 * k] + value[3 * k + 1] + value[3 * k + 2];
	}
	for (size_t k = 0; sum && k < pixels; k++)
		most = fmaxf(most, sum[k]);
	for (size_t k = 0; sum && k < pixels; k++)
		p->is_ground[k] = sum[k] > (float)NO_GROUND * most;
	free(sum);
}

/* ---- reading ---- */

static int read_stack(const struct import_pictures *p, struct picture_stack *stack,
		      const char *pattern, const char *what,
		      const struct picture_stack_settings *how,
		      const struct import_pictures_settings *settings, struct fault *fault)
{
	struct progress progress;
	int err;

	progress_begin(&progress, what, p->dome->count, settings->quiet);
	err = picture_stack_read(stack, pattern, p->dome->count, how, &progress, fault);
	progress_end(&progress);
	if (err || stack == &p->with)
		return err;
	if (stack->width != p->with.width || stack->height != p->with.height)
		err = fault_say(fault, -EINVAL, "%s: %d x %d pixels, expected %d x %d as in %s",
				pattern, stack->width, stack->height, p->with.width, p->with.height,
				settings->object);
	return err;
}

int import_pictures_read(struct import_pictures *p, const struct dome *dome, const int *place,
			 const struct import_pictures_settings *settings, struct fault *fault)
{
	const struct picture_stack_settings stack = {.transfer = settings->transfer,
						     .scale = settings->scale,
						     .place = place,
						     .folder = settings->folder};
	size_t pixels;
	int err;

	*p = (struct import_pictures){.dome = dome};
	err = read_stack(p, &p->with, settings->object, "objects", &stack, settings, fault);
	if (!err)
		err = read_stack(p, &p->without, settings->ground, "ground", &stack, settings,
				 fault);
	if (!err && settings->alone)
		err = read_stack(p, &p->alone, settings->alone, "alone", &stack, settings, fault);
	if (err) {
		import_pictures_free(p);
		return err;
	}
	pixels = (size_t)p->with.width * (size_t)p->with.height;
	p->coverage = calloc(pixels, sizeof(*p->coverage));
	p->is_ground = calloc(pixels, sizeof(*p->is_ground));
	p->ground = calloc(3 * (size_t)dome->count, sizeof(*p->ground));
	if (!p->coverage || !p->is_ground || !p->ground)
		err = fault_say(fault, -ENOMEM, "out of memory");
	if (!err)
		err = read_coverage(p, settings, fault);
	if (!err) {
		find_ground(p);
		err = import_judge(p, settings, fault);
	}
	if (err)
		import_pictures_free(p);
	return err;
}

void import_pictures_free(struct import_pictures *p)
{
	picture_stack_free(&p->with);
	picture_stack_free(&p->without);
	picture_stack_free(&p->alone);
	free(p->coverage);
	free(p->is_ground);
	free(p->ground);
	*p = (struct import_pictures){.coverage = NULL};
}

/* ---- tiles ---- */

/* Uncovered ground pixels beside a pixel at the object's edge. They stand for its shadow, which
 * cannot be seen there. */
struct beside {
	int count;
	int x[8], y[8];
};

static struct beside look_beside(const struct import_pictures *p, int x, int y)
{
	struct beside b = {.count = 0};

	for (int k = 0; k < 9; k++) {
		const int u = x + k % 3 - 1, v = y + k / 3 - 1;
		size_t at;

		if (k == 4 || u < 0 || v < 0 || u >= p->with.width || v >= p->with.height)
			continue;
		at = (size_t)v * (size_t)p->with.width + (size_t)u;
		if (p->coverage[at] > 0 || !p->is_ground[at])
			continue;
		b.x[b.count] = u;
		b.y[b.count++] = v;
	}
	return b;
}

/* The share of a light that is left on the ground beside; 1 where there is no ground. */
static float share_beside(const struct import_pictures *p, const struct beside *b, int light, int c)
{
	float with = 0, without = 0;

	for (int k = 0; k < b->count; k++) {
		with += picture_stack_at(&p->with, light, b->x[k], b->y[k])[c];
		without += picture_stack_at(&p->without, light, b->x[k], b->y[k])[c];
	}
	return without > 0 ? with / without : 1;
}

/* Light of the ground and of the object in an edge pixel, estimated from their mixture `both`.
 * without: light of the ground when the object is not there. */
struct edge_split {
	float ground, object;
};

static struct edge_split split_edge(const struct import_pictures *p, const struct beside *beside,
				    int light, int c, float both, float without, float coverage)
{
	const float ground = without * share_beside(p, beside, light, c);

	return (struct edge_split){ground, fmaxf(both - (1 - coverage) * ground, 0)};
}

static void import_fill_pixel(const struct import_pictures *p, struct import_tile *tile, int pixel,
			      int x, int y)
{
	const int lights = p->with.count;
	const size_t row = (size_t)pixel * 3 * (size_t)lights;
	const float a = tile->coverage[pixel];
	const bool edge = a > 0 && tile->receiver[pixel];
	struct beside beside = {.count = 0};

	if (edge && !p->alone.value)
		beside = look_beside(p, x, y);
	for (int i = 0; i < lights; i++) {
		const float *with = picture_stack_at(&p->with, i, x, y);
		const float *without = picture_stack_at(&p->without, i, x, y);

		for (int c = 0; c < 3; c++) {
			const size_t at = row + (size_t)(c * lights + i);
			const float u = p->flat ? (float)p->ground[c * lights + i] : without[c];
			struct edge_split s = {with[c], with[c]};

			if (p->alone.value) {
				s.object = picture_stack_at(&p->alone, i, x, y)[c];
				s.ground = a < 1 ? (with[c] - s.object) / (1 - a) : 0;
			} else if (edge) {
				s = split_edge(p, &beside, i, c, with[c], u, a);
			}
			tile->without[at] = u;
			tile->with[at] = s.ground;
			tile->object[at] = s.object;
		}
	}
}

void import_pictures_fill(const void *context, struct import_tile *tile)
{
	const struct import_pictures *p = context;

	for (int v = 0; v < tile->height; v++)
		for (int u = 0; u < tile->width; u++) {
			const int x = tile->x + u, y = tile->y + v, pixel = v * BASIS_TILE + u;
			const size_t at = (size_t)y * (size_t)p->with.width + (size_t)x;

			tile->coverage[pixel] = p->coverage[at];
			tile->receiver[pixel] = p->is_ground[at] && p->coverage[at] < 1;
			if (tile->coverage[pixel] > 0 || tile->receiver[pixel])
				import_fill_pixel(p, tile, pixel, x, y);
		}
}
