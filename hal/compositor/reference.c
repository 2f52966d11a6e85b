/* The compositor's formula in double precision, straight from compositor.h. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/compositor/compositor.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

struct scene {
	const struct basis *basis;
	const struct compositor_settings *settings;
	double (*radiance)[3]; /* [lights]: used and ambient together */
};

struct tile_values {
	double object[TILE_PIXELS][3];
	double ratio[TILE_PIXELS][3];
};

static double row_value(const struct basis_block *b, int p, int c, int i)
{
	const size_t row = b->channels == 3 ? (size_t)p * 3 + (size_t)c : (size_t)p;

	return (double)b->scale[row] * b->row[row * (size_t)b->stride + (size_t)i];
}

/* sum over i of value_i L_i, and in *all the sum of the values alone. */
static double lit_sum(const struct scene *s, const struct basis_block *b, int p, int c, double *all)
{
	double sum = 0;

	*all = 0;
	for (int i = 0; i < b->lights; i++) {
		const double value = row_value(b, p, c, i);

		sum += value * s->radiance[b->light[i]][c];
		*all += value;
	}
	return sum;
}

static double ratio_of(double taken, double lit, double all)
{
	const double there = lit + ldexp(all, -20);

	return there > 0 ? fmin(fmax(1 - taken / there, 0), COMPOSITOR_RATIO_MAX) : 1;
}

static double ground_ratio(const struct scene *s, const struct basis_block *b, int p, int c)
{
	const double *u = basis_ground(s->basis, b->ground, c);
	const int listed = b->lights - b->rest;
	const double rest = b->rest ? row_value(b, p, c, listed) : 0;
	double taken = 0, lit = 0, all = 0;
	int next = 0; /* of the list */

	for (uint32_t i = 0; i < s->basis->info.lights; i++) {
		const double light = u[i] * s->radiance[i][c];
		double v = rest;

		if (next < listed && b->light[next] == i)
			v = row_value(b, p, c, next++);
		taken += v * light;
		lit += light;
		all += u[i];
	}
	return ratio_of(taken, lit, all);
}

static void add_block(const struct scene *s, const struct basis_block *b, struct tile_values *v)
{
	double all, taken, lit;

	for (int p = 0; p < b->pixels; p++) {
		for (int c = 0; c < 3; c++) {
			switch (b->kind) {
			case BASIS_KIND_T:
				v->object[b->pixel[p]][c] = s->settings->gain *
							    lit_sum(s, b, p, c, &all);
				break;
			case BASIS_KIND_V:
				v->ratio[b->pixel[p]][c] = ground_ratio(s, b, p, c);
				break;
			case BASIS_KIND_D:
				taken = lit_sum(s, b, p, c, &all);
				lit = lit_sum(s, b + 1, p, c, &all);
				v->ratio[b->pixel[p]][c] = ratio_of(taken, lit, all);
				break;
			default: /* U came with its D */
				break;
			}
		}
	}
}

static void fill_tile(const struct scene *s, const struct basis_tile *tile, struct tile_values *v)
{
	for (int p = 0; p < TILE_PIXELS; p++) {
		for (int c = 0; c < 3; c++) {
			v->object[p][c] = 0;
			v->ratio[p][c] = 1;
		}
	}
	for (int i = 0; s->settings->object && i < tile->block_count; i++)
		add_block(s, &tile->blocks[i], v);
}

static void write_tile(const struct scene *s, int pose, const struct basis_tile *tile,
		       const struct picture *background, const struct tile_values *v, double *out)
{
	const size_t width = s->basis->info.width;

	for (int y = 0; y < tile->height; y++) {
		for (int x = 0; x < tile->width; x++) {
			const size_t at = (size_t)(tile->y + y) * width + (size_t)(tile->x + x);
			const uint8_t *in = background->origin +
					    (tile->y + y) * background->y_step +
					    (tile->x + x) * background->x_step;
			const double a = s->settings->object
						 ? s->basis->poses[pose].coverage[at] / 65535.0
						 : 0;
			const int p = y * BASIS_TILE + x;

			for (int c = 0; c < 3; c++) {
				const double behind = transfer_decode(s->settings->background,
								      in[2 - c] / 255.0);
				const double linear = v->object[p][c] +
						      (1 - a) * v->ratio[p][c] * behind;

				out[at * 3 + (size_t)c] = 255 * transfer_encode(s->settings->output,
										linear);
			}
		}
	}
}

int compositor_reference(const struct basis *basis, int pose,
			 const struct compositor_settings *settings,
			 const struct light_selection *lights, const struct picture *background,
			 double *out)
{
	const struct basis_info_chunk *info = &basis->info;
	struct scene scene = {.basis = basis, .settings = settings};
	struct tile_values values;

	if (pose < 0 || (uint32_t)pose >= info->poses || background->width != (int)info->width ||
	    background->height != (int)info->height || lights->count != (int)info->lights)
		return -EINVAL;
	scene.radiance = calloc(info->lights, sizeof(*scene.radiance));
	if (!scene.radiance)
		return -ENOMEM;
	for (int i = 0; i < lights->count; i++) {
		for (int c = 0; c < 3; c++)
			scene.radiance[i][c] = lights->radiance[i][c] + lights->ambient[c];
	}
	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++) {
		const struct basis_tile *tile = &basis->poses[pose].tiles[t];

		fill_tile(&scene, tile, &values);
		write_tile(&scene, pose, tile, background, &values, out);
	}
	free(scene.radiance);
	return 0;
}
