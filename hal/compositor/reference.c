/* SPDX-License-Identifier: MIT */
/* The compositor's formula in double precision, straight from compositor.h and basis_format.h. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"
#include "hal/basis/basis_places.h"
#include "hal/compositor/compositor.h"
#include "hal/compositor/live/lit_rows.h"
#include "hal/compositor/near/near_sky.h"
#include "hal/mirror/mirror_map.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

struct reference_scene {
	const struct basis *basis;
	const struct compositor_settings *settings;
	double (*radiance)[3]; /* [lights]: of used lights, plus ambient */
	double (*x)[3];	       /* [lights]: X for the current block */
	double (*y)[3];	       /* [coarse] */
	/* Lamps at places; sky is NULL where there are none. */
	struct near_sky *sky;
	const double (*lamp)[3];	 /* [sky->lamps.count]: P */
	float *distance[BASIS_SURFACES]; /* [height][width] */
	const struct basis_tile *tile;
	const struct mirror_map *mirror;
	const double *mirror_gain; /* [3] */
};

struct reference_tile {
	double object[TILE_PIXELS][3];
	double taken[TILE_PIXELS][3];
	double own[TILE_PIXELS][3];	/* sum u L + e of U blocks */
	double less[TILE_PIXELS][3];	/* sum d L of D blocks */
	double through[TILE_PIXELS][3]; /* transmission * B' */
};

/* Computes X of a block's kind, with `more` radiance from every light. */
static void fill_x(const struct reference_scene *s, const struct basis_block *b, double more)
{
	for (uint32_t i = 0; i < s->basis->info.lights; i++) {
		for (int c = 0; c < 3; c++)
			s->x[i][c] = (s->radiance[i][c] + more) *
				     (b->kind == BASIS_KIND_V
					      ? basis_ground(s->basis, b->ground, c)[i]
					      : s->basis->lights[i].solid_angle_sr);
	}
}

static void fill_y(const struct reference_scene *s)
{
	const struct basis_info_chunk *info = &s->basis->info;

	memset(s->y, 0, sizeof(*s->y) * info->coarse);
	for (uint32_t i = 0; i < info->lights; i++) {
		for (int c = 0; c < 3; c++) {
			if (!s->basis->coarse)
				s->y[i][c] = s->x[i][c];
			for (int k = 0; s->basis->coarse && k < 3; k++)
				s->y[s->basis->coarse[i].index[k]][c] +=
					s->x[i][c] * s->basis->coarse[i].weight[k] /
					BASIS_COARSE_ONE;
		}
	}
}

/* Index of pixel p, channel c and line `line` in 16-bit lines; `lines`: lines of a panel. */
static size_t line_place(const struct basis_block *b, int p, int c, int lines, int line)
{
	const int channel = b->channels == 3 ? c : 0;
	const int panels = basis_panels16(b->pixels);

	return ((size_t)(channel * panels + p / BASIS_LINE16) * (size_t)lines + (size_t)line) *
		       BASIS_LINE16 +
	       (size_t)(p % BASIS_LINE16);
}

static double column_value(const struct basis_block *b, int p, int c, int n)
{
	return (double)b->column_scale[n] *
	       (b->bits == 8 ? basis_column8_value(b, n, b->channels == 3 ? c : 0, p)
			     : b->column16[line_place(b, p, c, b->columns, n)]);
}

/* Adds the block's sum of value * X to to[pixel][c]. */
static void block_add_values(const struct reference_scene *s, const struct basis_block *b,
			     double more, double (*to)[3])
{
	fill_x(s, b, more);
	fill_y(s);
	for (int j = 0; j < b->patterns; j++) {
		double y[3] = {0};

		for (uint32_t k = 0; k < s->basis->info.coarse; k++) {
			for (int c = 0; c < 3; c++)
				y[c] += b->pattern[(size_t)j * (size_t)b->stride + k] * s->y[k][c];
		}
		for (int p = 0; p < b->pixels; p++) {
			for (int c = 0; c < 3; c++)
				to[p][c] += (double)b->pattern_scale[j] * y[c] *
					    b->coefficient[line_place(b, p, c, b->patterns, j)];
		}
	}
	/* With S = 0 the columns of groups have no light. */
	for (int n = 0; n < b->columns && b->light[n] < s->basis->info.lights; n++) {
		for (int p = 0; p < b->pixels; p++) {
			for (int c = 0; c < 3; c++)
				to[p][c] += column_value(b, p, c, n) * s->x[b->light[n]][c];
		}
	}
}

/* ---- lamps at places ---- */

static bool place_of(const struct reference_scene *s, enum basis_kind kind, int pixel,
		     double place[3])
{
	const int x = s->tile->x + pixel % BASIS_TILE, y = s->tile->y + pixel / BASIS_TILE;
	const size_t at = (size_t)y * s->basis->info.width + (size_t)x;
	const float distance =
		s->distance[kind == BASIS_KIND_T ? BASIS_OBJECT : BASIS_RECEIVER][at];

	if (kind == BASIS_KIND_V)
		return near_sky_ground(s->sky, x + 0.5, y + 0.5, place);
	return distance > 0 && near_sky_surface(s->sky, x + 0.5, y + 0.5, (double)distance, place);
}

/* What a block gives pixel p of its list, per unit of X of light i. */
static double value_of(const struct reference_scene *s, const struct basis_block *b, int p, int c,
		       int i)
{
	double value = 0;

	for (int j = 0; j < b->patterns; j++) {
		const int16_t *row = b->pattern + (size_t)j * (size_t)b->stride;
		double sum = s->basis->coarse ? 0 : row[i];

		for (int k = 0; s->basis->coarse && k < 3; k++)
			sum += (double)row[s->basis->coarse[i].index[k]] *
			       s->basis->coarse[i].weight[k] / BASIS_COARSE_ONE;
		value += (double)b->pattern_scale[j] * sum *
			 b->coefficient[line_place(b, p, c, b->patterns, j)];
	}
	for (int n = 0; n < b->columns; n++)
		if (b->light[n] == i)
			value += column_value(b, p, c, n);
	return value;
}

/* Adds what the lamps give a block's pixels, and on the ground their u to there[pixel][c]. */
static void add_lamps(const struct reference_scene *s, const struct basis_block *b, double (*to)[3],
		      double (*there)[3])
{
	for (int p = 0; s->sky && p < b->pixels; p++) {
		struct near_share share[NEAR_SHARES];
		double place[3];
		const bool is = place_of(s, b->kind, b->pixel[p], place);

		for (int l = 0; is && l < s->sky->lamps.count; l++) {
			const int count = near_sky_shares(s->sky, l, place, NULL, share);

			for (int n = 0; n < count; n++)
				for (int c = 0; c < 3; c++) {
					const int i = share[n].light;
					double x = share[n].amount * s->lamp[l][c];

					if (b->kind == BASIS_KIND_V)
						x *= basis_ground(s->basis, b->ground, c)[i] /
						     s->basis->lights[i].solid_angle_sr;
					to[p][c] += x * value_of(s, b, p, c, i);
					if (there)
						there[p][c] += x;
				}
		}
	}
}

static double tint_of(const struct basis_block *b, int p, int c)
{
	return b->tint ? b->tint[c * b->pixels + p] / (double)BASIS_TINT_ONE : 1;
}

/* Adds pixel p of a block of the object under near_object's skies, and each lamp with P = 1. */
static void add_skies_and_lamps(const struct reference_scene *s, const struct basis_block *b, int p,
				const double place[3], double (*t)[3], double (*value)[3])
{
	struct near_share share[NEAR_SHARES];

	for (int c = 0; c < 3; c++) {
		const double tint = tint_of(b, p, c);

		for (uint32_t i = 0; i < s->basis->info.lights; i++)
			for (int k = 0; k < NEAR_SKIES; k++)
				t[k][c] += tint * value_of(s, b, p, c, (int)i) *
					   s->basis->lights[i].solid_angle_sr *
					   near_sky_radiance(k, s->basis->lights[i].direction);
		for (int l = 0; l < s->sky->lamps.count; l++) {
			const int count = near_sky_shares(s->sky, l, place, NULL, share);

			for (int n = 0; n < count; n++)
				value[l][c] += tint * share[n].amount *
					       value_of(s, b, p, c, share[n].light);
		}
	}
}

/* Takes near_sky_bounced() of a pixel of the object, which several blocks may list. */
static void take_bounced(const struct reference_scene *s, int pixel, double to[3])
{
	const int x = s->tile->x + pixel % BASIS_TILE, y = s->tile->y + pixel / BASIS_TILE;
	const int width = (int)s->basis->info.width, height = (int)s->basis->info.height;
	const float over_share = x < width && y < height ? s->distance[BASIS_BOUNCED][y * width + x]
							 : 0;
	struct near_object object = {.share = 1 / (double)over_share};
	double value[LAMPS_MAX][3] = {{0}}, place[3];

	if (!(over_share > 0) || !place_of(s, BASIS_KIND_T, pixel, place))
		return;
	for (int n = 0; n < s->tile->block_count; n++) {
		const struct basis_block *b = &s->tile->blocks[n];

		for (int p = 0; b->kind == BASIS_KIND_T && p < b->pixels; p++)
			if (b->pixel[p] == pixel)
				add_skies_and_lamps(s, b, p, place, object.t, value);
	}
	for (int l = 0; l < s->sky->lamps.count; l++)
		for (int c = 0; c < 3; c++)
			to[c] -= s->settings->gain * s->lamp[l][c] *
				 near_sky_bounced(s->sky, l, place, &object, c, value[l][c]);
}

/* Adds the block's values times light, times tint and factor, to its pixels; of V over u L + e. */
static void spread_block(const struct reference_scene *s, const struct basis_block *b, double more,
			 double factor, double (*to)[3])
{
	double value[TILE_PIXELS][3] = {{0}}, there[TILE_PIXELS][3];
	const bool ground = b->kind == BASIS_KIND_V;

	for (int p = 0; ground && p < b->pixels; p++)
		for (int c = 0; c < 3; c++) {
			const double *u = basis_ground(s->basis, b->ground, c);

			if (p) {
				there[p][c] = there[0][c];
				continue;
			}
			there[0][c] = 0;
			for (uint32_t i = 0; i < s->basis->info.lights; i++)
				there[0][c] += u[i] * (s->radiance[i][c] + 0x1p-20);
		}
	block_add_values(s, b, more, value);
	add_lamps(s, b, value, ground ? there : NULL);
	for (int p = 0; p < b->pixels; p++) {
		for (int c = 0; c < 3; c++)
			to[b->pixel[p]][c] += value[p][c] *
					      (!ground		 ? factor
					       : there[p][c] > 0 ? 1 / there[p][c]
								 : 0) *
					      tint_of(b, p, c);
	}
}

static void fill_tile(const struct reference_scene *s, const struct basis_tile *tile,
		      struct reference_tile *v)
{
	memset(v, 0, sizeof(*v));
	for (int n = 0; s->settings->object && n < tile->block_count; n++) {
		const struct basis_block *b = &tile->blocks[n];

		if (b->kind == BASIS_KIND_T)
			spread_block(s, b, 0, s->settings->gain, v->object);
		else if (b->kind == BASIS_KIND_V)
			spread_block(s, b, 0, 1, v->taken);
		else if (b->kind == BASIS_KIND_D)
			spread_block(s, b, 0, 1, v->less);
		else
			spread_block(s, b, 0x1p-20, 1, v->own);
	}
	for (int p = 0; s->sky && s->settings->object && p < TILE_PIXELS; p++)
		take_bounced(s, p, v->object[p]);
	for (int p = 0; p < TILE_PIXELS; p++) {
		for (int c = 0; c < 3; c++) {
			if (v->own[p][c] > 0)
				v->taken[p][c] += v->less[p][c] / v->own[p][c];
		}
	}
}

static int clamped_to(int at, int count)
{
	return at < 0 ? 0 : at >= count ? count - 1 : at;
}

static double code_at(const struct picture *b, int x, int y, int c)
{
	const uint8_t *in = b->origin + clamped_to(y, b->height) * b->y_step +
			    clamped_to(x, b->width) * b->x_step;

	return in[2 - c];
}

static double background_at(const struct reference_scene *s, const struct picture *b, int x, int y,
			    int c)
{
	return transfer_curve_decode(&s->settings->background, code_at(b, x, y, c) / 255);
}

/* Length of the part of pixel `at` that is in the interval. */
static double pixel_overlap(int at, double middle, double length)
{
	return fmin(at + 1, middle + length / 2) - fmax(at, middle - length / 2);
}

/* Mean of the background over the rectangle of a glass pixel. */
static double mean_behind(const struct reference_scene *s, const struct picture *b,
			  const struct basis_glass *g, int c)
{
	const double x = g->x + 0.5 + (double)g->dx / BASIS_GLASS_STEP;
	const double y = g->y + 0.5 + (double)g->dy / BASIS_GLASS_STEP;
	const double width = 1 + (double)g->spread[0] / BASIS_GLASS_SPREAD;
	const double height = 1 + (double)g->spread[1] / BASIS_GLASS_SPREAD;
	double sum = 0;

	for (int v = (int)floor(y - height / 2); v < y + height / 2; v++)
		for (int u = (int)floor(x - width / 2); u < x + width / 2; u++)
			sum += pixel_overlap(u, x, width) * pixel_overlap(v, y, height) *
			       background_at(s, b, u, v, c);
	return sum / (width * height);
}

/* Computes transmission * B' for the pixels of a tile. */
static void look_through(const struct reference_scene *s, int pose, int tile,
			 const struct picture *background, struct reference_tile *v)
{
	const struct basis_pose *p = &s->basis->poses[pose];

	for (size_t i = 0; s->settings->object && i < p->glass_count; i++) {
		const struct basis_glass *g = &p->glass[i];
		const int at = g->y % BASIS_TILE * BASIS_TILE + g->x % BASIS_TILE;

		for (int c = 0; c < 3 && basis_glass_tile(s->basis, g) == tile; c++)
			v->through[at][c] = mean_behind(s, background, g, c) * g->transmission[c] /
					    65535.0;
	}
}

/* A texel of the pyramid; beyond its edge, the nearest. */
static double texel_at(const struct mirror_map *map, int level, int x, int y, int c)
{
	const int side = BASIS_MIRROR_SIDE >> level;

	return (double)mirror_texels(
		map, level)[clamped_to(y, side) * MIRROR_STRIDE + clamped_to(x, side)][c];
}

static double bilinear_at(const struct mirror_map *map, int level, const struct basis_mirror *m,
			  int c)
{
	const double side = BASIS_MIRROR_SIDE >> level;
	const double x = m->u / 65536.0 * side - 0.5, y = m->v / 65536.0 * side - 0.5;
	double sum = 0;

	for (int k = 0; k < 4; k++)
		sum += (k % 2 ? x - floor(x) : 1 - x + floor(x)) *
		       (k / 2 ? y - floor(y) : 1 - y + floor(y)) *
		       texel_at(map, level, (int)floor(x) + k % 2, (int)floor(y) + k / 2, c);
	return sum;
}

/* Adds what the pixels of a tile mirror of the sky. */
static void look_up(const struct reference_scene *s, int pose, int tile, struct reference_tile *v)
{
	const struct basis_pose *p = &s->basis->poses[pose];

	for (size_t i = 0; s->settings->object && i < p->mirror_count; i++) {
		const struct basis_mirror *m = &p->mirror[i];
		const int at = m->y % BASIS_TILE * BASIS_TILE + m->x % BASIS_TILE;
		const int least = s->mirror->least * BASIS_MIRROR_STEP;
		const int steps = m->level > least ? m->level : least;
		const int level = steps / BASIS_MIRROR_STEP;
		const double next = steps % BASIS_MIRROR_STEP / (double)BASIS_MIRROR_STEP;

		for (int c = 0; c < 3 && basis_tile_of(s->basis, m->x, m->y) == tile; c++) {
			double light = (1 - next) * bilinear_at(s->mirror, level, m, c);

			if (next > 0)
				light += next * bilinear_at(s->mirror, level + 1, m, c);
			v->object[at][c] += s->settings->gain * s->mirror_gain[c] * light *
					    m->throughput[c] / 65535.0;
		}
	}
}

/* What people hide of a pixel, and their colour in code values 0..255. */
struct reference_veil {
	double front, anybody, foremost[3];
};

static struct reference_veil veil_at(const struct reference_scene *s, int tile, size_t at)
{
	const struct veil *veil = s->settings->veil;

	if (!veil || !s->settings->object || !veil->tile[tile])
		return (struct reference_veil){0};
	return (struct reference_veil){
		.front = veil->front[at] / 255.0,
		.anybody = veil->anybody[at] / 255.0,
		.foremost = {veil->foremost[4 * at + 2], veil->foremost[4 * at + 1],
			     veil->foremost[4 * at]},
	};
}

static void write_tile(const struct reference_scene *s, int pose, int index,
		       const struct picture *background, const struct reference_tile *v,
		       double *out)
{
	const struct basis_tile *tile = &s->basis->poses[pose].shown.tiles[index];
	const size_t width = s->basis->info.width;

	for (int y = 0; y < tile->height; y++) {
		for (int x = 0; x < tile->width; x++) {
			const size_t at = (size_t)(tile->y + y) * width + (size_t)(tile->x + x);
			const double a = s->settings->object
						 ? s->basis->poses[pose].coverage[at] / 65535.0
						 : 0;
			const struct reference_veil veil = veil_at(s, index, at);
			const double left = 1 - veil.front,
				     mixed = a * (veil.front > 0 && left > 0);
			const int p = y * BASIS_TILE + x;

			for (int c = 0; c < 3; c++) {
				const double code = code_at(background, tile->x + x, tile->y + y,
							    c);
				const double behind = transfer_curve_decode(
					&s->settings->background,
					(code + mixed * (veil.foremost[c] - code)) / 255);
				const double taken = (1 - veil.anybody) * v->taken[p][c];
				const double object = v->object[p][c] *
						      (s->settings->rows
							       ? s->settings->rows[tile->y + y][c] /
									 (double)LIT_ROWS_ONE
							       : 1);
				const double ratio = fmin(fmax(1 - taken, 0), COMPOSITOR_RATIO_MAX);

				out[at * 3 + (size_t)c] =
					255 *
					transfer_curve_encode(
						&s->settings->output,
						left * object + ratio * ((1 - left * a) * behind +
									 left * v->through[p][c]));
			}
		}
	}
}

static int reference_write(struct reference_scene *s, int pose, const struct picture *background,
			   double *out)
{
	const struct basis *basis = s->basis;
	const struct basis_layer *layer = s->settings->mode == COMPOSITOR_EXACT
						  ? &basis->poses[pose].exact
						  : &basis->poses[pose].shown;
	struct reference_tile *values = malloc(sizeof(*values));

	if (!values)
		return -ENOMEM;
	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++) {
		s->tile = &layer->tiles[t];
		fill_tile(s, s->tile, values);
		look_through(s, pose, t, background, values);
		look_up(s, pose, t, values);
		write_tile(s, pose, t, background, values, out);
	}
	free(values);
	return 0;
}

/* Finds the places of the pose's pixels, where lamps at places shine. */
static int find_places(struct reference_scene *s, int pose, const struct light_selection *lights)
{
	const size_t pixels = (size_t)s->basis->info.width * s->basis->info.height;
	int ret = near_sky_create(&s->sky, s->basis, lights->lamps, NULL);

	s->lamp = (const double(*)[3])lights->lamp;
	for (int k = 0; ret == 0 && s->sky && k < BASIS_SURFACES; k++) {
		s->distance[k] = calloc(pixels, sizeof(*s->distance[k]));
		ret = s->distance[k] ? basis_places_read(s->basis, pose, (enum basis_surface)k,
							 s->distance[k])
				     : -ENOMEM;
	}
	return ret;
}

int compositor_reference(const struct basis *basis, int pose,
			 const struct compositor_settings *settings,
			 const struct light_selection *lights, const struct picture *background,
			 double *out)
{
	const struct basis_info_chunk *info = &basis->info;
	struct reference_scene scene = {.basis = basis,
					.settings = settings,
					.mirror = lights->mirror,
					.mirror_gain = lights->mirror_gain};
	struct mirror_map map = {.cell = NULL};
	int ret;

	if (pose < 0 || (uint32_t)pose >= info->poses || background->width != (int)info->width ||
	    background->height != (int)info->height || lights->count != (int)info->lights)
		return -EINVAL;
	ret = basis_pose_load(basis, pose, NULL);
	if (ret < 0)
		return ret;
	if (settings->mode == COMPOSITOR_EXACT && !basis->poses[pose].exact.tiles)
		return -ENODATA;
	scene.radiance = calloc(info->lights, sizeof(*scene.radiance));
	scene.x = calloc(info->lights, sizeof(*scene.x));
	scene.y = calloc(info->coarse, sizeof(*scene.y));
	ret = scene.radiance && scene.x && scene.y ? find_places(&scene, pose, lights) : -ENOMEM;
	if (ret == 0 && basis->poses[pose].mirror_count && !scene.mirror) {
		ret = mirror_map_create(&map, basis, NULL);
		if (ret == 0)
			mirror_map_fill(&map, (const double(*)[3])lights->radiance,
					lights->ambient);
		scene.mirror = &map;
	}
	if (ret == 0) {
		for (int i = 0; i < lights->count; i++) {
			for (int c = 0; c < 3; c++)
				scene.radiance[i][c] = lights->radiance[i][c] + lights->ambient[c];
		}
		ret = reference_write(&scene, pose, background, out);
	}
	free(scene.radiance);
	free(scene.x);
	free(scene.y);
	for (int k = 0; k < BASIS_SURFACES; k++)
		free(scene.distance[k]);
	near_sky_destroy(scene.sky);
	mirror_map_free(&map);
	return ret;
}
