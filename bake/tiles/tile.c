/* SPDX-License-Identifier: MIT */
#include "bake/tiles/tile.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mirror/mirror_pixel.h"
#include "bake/tiles/tile_glass.h"
#include "bake/tiles/tile_noise.h"
#include "bake/tiles/tile_sample.h"

/* If there is a target for the noise, each batch has this many samples a pixel, and the target is
 * given up at SAMPLES_MOST. */
#define BATCH_SAMPLES 4
#define SAMPLES_MOST 16384

/* ---- memory ---- */

static int create_rows(struct tile *tile, enum tile_kind kind, int channels)
{
	struct tile_rows *rows = &tile->rows[kind];

	rows->channels = channels;
	rows->direct = malloc(TILE_PIXELS * tile_direct_size(tile, kind) * sizeof(float));
	for (int half = 0; half < 2; half++) {
		rows->bounce[half] = malloc(TILE_PIXELS * tile_bounce_size(tile) * sizeof(float));
		if (!rows->bounce[half])
			return -ENOMEM;
	}
	return rows->direct ? 0 : -ENOMEM;
}

int tile_create(struct tile *tile, const struct scene *scene, const struct cells *cells,
		const struct tile_settings *settings, int bounces)
{
	const bool standins = world_has_standins(scene->world);
	int err;

	memset(tile, 0, sizeof(*tile));
	tile->scene = scene;
	tile->cells = cells;
	tile->settings = *settings;
	err = transport_create(&tile->transport, scene->world, cells, bounces);
	if (!err)
		err = bounce_create(&tile->bounce, cells->count);
	if (!err)
		err = tile_noise_create(tile);
	if (!err && settings->live) {
		tile->mirror = calloc(TILE_PIXELS, sizeof(*tile->mirror));
		err = tile->mirror ? 0 : -ENOMEM;
	}
	if (!err)
		err = create_rows(tile, TILE_OBJECT, 3);
	if (!err)
		err = create_rows(tile, TILE_CHANGE,
				  standins ? 3 : transport_shadow_channels(scene->world));
	if (!err && standins)
		err = create_rows(tile, TILE_WITHOUT, 3);
	tile->even_sky = malloc(3 * (size_t)cells->count * sizeof(float));
	if (err || !tile->even_sky) {
		tile_free(tile);
		return err ? err : -ENOMEM;
	}
	tile->radiance_scale = tile->even_sky + cells->count;
	tile->ratio_scale = tile->radiance_scale + cells->count;
	for (int i = 0; i < cells->count; i++) {
		tile->even_sky[i] = 1;
		tile->radiance_scale[i] = 1 / sqrtf(cells->sr[i]);
		tile->ratio_scale[i] = sqrtf(cells->share[i]);
	}
	return 0;
}

void tile_free(struct tile *tile)
{
	transport_free(&tile->transport);
	bounce_free(&tile->bounce);
	for (int kind = 0; kind < TILE_KINDS; kind++) {
		free(tile->rows[kind].direct);
		free(tile->rows[kind].bounce[0]);
		free(tile->rows[kind].bounce[1]);
		tile->rows[kind] = (struct tile_rows){.channels = 0};
	}
	free(tile->even_sky);
	tile->even_sky = NULL;
	free(tile->noise);
	tile->noise = NULL;
	free(tile->mirror);
	tile->mirror = NULL;
}

/* ---- samples ---- */

/* Adds a sample that met a coat of low roughness. What that mirrors straight of the sky is kept
 * apart, and is in the row as well until finish_mirror(), so that its noise counts. Returns false,
 * and adds nothing, where it has met something else. */
static bool tile_add_mirror(struct tile *tile, const struct tile_sample *s,
			    const struct transport_rows *rows)
{
	const struct v3 wo = v3_scale(s->direction, -1);
	struct transport *t = &tile->transport;

	if (!tile->mirror || s->surface.kind != SURFACE_OBJECT ||
	    s->surface.bsdf.kind != MATERIAL_GLOSSY ||
	    s->surface.bsdf.alpha > MATERIAL_MIRROR_ALPHA)
		return false;
	if (transport_add_apart(t, &s->surface, wo, rows) &&
	    mirror_pixel_add(&tile->mirror[s->at], &s->surface, wo, &t->apart))
		for (int c = 0; c < 3; c++)
			rows->direct[c * tile->cells->count + t->apart.cell] += t->apart.light.c[c];
	return true;
}

static void tile_add_object(struct tile *tile, const struct tile_sample *s)
{
	struct tile_pixel *p = &tile->pixels[s->at];
	const struct transport_rows rows = tile_rows_for(tile, TILE_OBJECT, s->at,
							 p->object++ == 0);

	p->changed = true;
	p->distance[BASIS_OBJECT] +=
		(double)v3_length(v3_sub(s->surface.position, tile->scene->eye));
	if (s->surface.bsdf.kind == MATERIAL_GLASS)
		tile_glass_add(tile, s, &rows);
	else if (s->surface.kind == SURFACE_GROUND)
		transport_add_mirrored(&tile->transport, &s->surface, v3_scale(s->direction, -1),
				       &rows);
	else if (!tile_add_mirror(tile, s, &rows))
		transport_add(&tile->transport, WITH_OBJECTS, &s->surface,
			      v3_scale(s->direction, -1), rgb_make(1, 1, 1), &rows);
}

static void tile_add_sample(struct tile *tile, int at, uint32_t sample)
{
	const int x = tile->x + at % BASIS_TILE, y = tile->y + at / BASIS_TILE;
	const uint32_t pixel = (uint32_t)y * (uint32_t)tile->scene->camera.width + (uint32_t)x;
	const uint64_t scramble = random_hash(tile->settings.seed, pixel, 0xca3e5a);
	const uint32_t place = sobol_shuffle(sample, (uint32_t)random_mix(scramble));
	struct tile_sample s = {.at = at, .pixel = pixel, .sample = sample};
	double unit[2];
	bool met;

	sobol_point(place, scramble, unit);
	scene_place(tile->scene, x, y, unit, s.place);
	tile->transport.ray_count++;
	transport_begin(&tile->transport, tile->settings.seed, pixel, sample);
	met = scene_look(tile->scene, WITH_OBJECTS, s.place[0], s.place[1], &s.surface,
			 &s.direction);
	if (met &&
	    (s.surface.kind == SURFACE_OBJECT ||
	     (!tile_has_standins(tile) &&
	      transport_mirrors_object(&tile->transport, &s.surface, v3_scale(s.direction, -1))))) {
		tile_add_object(tile, &s);
		return;
	}
	tile->pixels[at].other_weight++;
	if (!met)
		return;
	tile->pixels[at].direct++;
	tile->pixels[at].distance[BASIS_RECEIVER] +=
		(double)v3_length(v3_sub(s.surface.position, tile->scene->eye));
	tile_add_receiver(tile, &s, &s.surface, s.direction, 1);
}

/* ---- batches ---- */

static bool same_rows(const float *a, const float *b, size_t floats)
{
	return !memcmp(a, b, floats * sizeof(float));
}

static void find_changes(struct tile *tile)
{
	const struct tile_rows *with = &tile->rows[TILE_CHANGE];
	const struct tile_rows *without = &tile->rows[TILE_WITHOUT];
	const size_t size = tile_bounce_size(tile);

	if (!tile_has_standins(tile))
		return;
	for (size_t at = 0; at < TILE_PIXELS; at++) {
		struct tile_pixel *p = &tile->pixels[at];

		if (!p->receiver || p->changed)
			continue;
		p->changed = !same_rows(with->direct + at * size, without->direct + at * size,
					size);
		for (int half = 0; half < 2; half++)
			p->changed |= !same_rows(with->bounce[half] + at * size,
						 without->bounce[half] + at * size, size);
	}
}

static void run_batch(struct tile *tile, int samples)
{
	tile->batches++;
	tile_noise_begin(tile, samples);
	for (int y = 0; y < tile->height; y++)
		for (int x = 0; x < tile->width; x++) {
			const int at = y * BASIS_TILE + x;

			for (int k = 0; k < samples; k++)
				tile_add_sample(tile, at, (uint32_t)(tile->samples + k));
			tile_noise_add(tile, at);
		}
	tile->samples += samples;
	tile->half_samples[tile_half_of_batch(tile)] += samples;
	find_changes(tile);
}

static void run_batches(struct tile *tile)
{
	const struct tile_settings *s = &tile->settings;

	if (s->noise_levels > 0) {
		do
			run_batch(tile, BATCH_SAMPLES);
		while (!tile_noise_ready(tile) ||
		       (tile_noise_judge(tile) > s->noise_levels && tile->samples < SAMPLES_MOST));
	} else {
		const int batches = s->samples < 8 ? s->samples : 8;

		for (int k = 0; k < batches; k++)
			run_batch(tile, s->samples * (k + 1) / batches - s->samples * k / batches);
	}
}

/* ---- finishing ---- */

static bool is_ratio(const struct tile *tile, enum tile_kind kind)
{
	return kind == TILE_CHANGE && !tile_has_standins(tile);
}

/*
 * Turns a pixel's sums into means, and moves its rows from pixel `at` to place `kept`, so that kept
 * pixels lie side by side. Rows are divided by samples, those of the ground's ratio also by what is
 * seen of each light, cells->shown; there direct light is counted in whole shares. Each half is
 * scaled as if all samples were like its own, so that the weighted mean of both halves is the mean
 * of all samples.
 */
static void move_rows(struct tile *tile, enum tile_kind kind, int at, int kept, double samples)
{
	const struct tile_rows *rows = &tile->rows[kind];
	const size_t count = (size_t)tile->cells->count;
	const size_t direct = tile_direct_size(tile, kind), bounce = tile_bounce_size(tile);
	const float *from = rows->direct + (size_t)at * direct;
	const bool ratio = is_ratio(tile, kind);
	const float *share = tile->cells->share, *shown = tile->cells->shown;
	float *to = rows->direct + (size_t)kept * direct;

	for (size_t i = 0, k = 0; i < direct; i++, k = k + 1 < count ? k + 1 : 0)
		to[i] = from[i] / (float)samples * (ratio ? share[k] / shown[k] : 1);
	for (int half = 0; half < 2; half++) {
		const double scale = (double)tile->samples /
				     ((double)tile->half_samples[half] * samples);

		from = rows->bounce[half] + (size_t)at * bounce;
		to = rows->bounce[half] + (size_t)kept * bounce;
		if (!tile->half_samples[half])
			continue;
		for (size_t i = 0, k = 0; i < bounce; i++, k = k + 1 < count ? k + 1 : 0)
			to[i] = from[i] * (float)scale / (ratio ? shown[k] : 1);
	}
}

/* Filters bounced light, and joins its two halves if there are two. */
static void finish_bounce(struct tile *tile, enum tile_kind kind, const uint16_t *pixel, int pixels)
{
	const struct tile_rows *rows = &tile->rows[kind];
	const bool ratio = is_ratio(tile, kind);
	const struct bounce_halves halves = {
		.rows = 3 * pixels,
		.pixel = pixel,
		.half = {rows->bounce[0], rows->bounce[1]},
		.share = {(double)tile->half_samples[0] / tile->samples,
			  (double)tile->half_samples[1] / tile->samples},
		.sky = ratio ? tile->cells->shown : tile->even_sky,
		.scale = ratio ? tile->ratio_scale : tile->radiance_scale,
	};

	if (!tile->half_samples[1])
		return;
	bounce_filter(&tile->bounce, &halves);
	tile_noise_filtered(tile, kind, pixel, pixels);
}

static void tile_add_part(struct tile *tile, enum tile_kind kind, enum basis_kind basis_kind,
			  const uint16_t *pixel, int pixels)
{
	const struct tile_rows *rows = &tile->rows[kind];
	const bool bounces = tile->transport.bounces > 0;

	if (!pixels)
		return;
	if (bounces)
		finish_bounce(tile, kind, pixel, pixels);
	tile->result.part[tile->result.part_count++] = (struct encode_samples){
		.kind = basis_kind,
		.pixels = pixels,
		.pixel = pixel,
		.channels = rows->channels,
		.direct = rows->direct,
		.bounce = bounces ? rows->bounce[0] : NULL,
	};
}

/* Clamps light at 0: the filter may leave it slightly negative. */
static void keep_positive(const struct encode_samples *light, float *bounce, size_t count)
{
	for (size_t i = 0; light->bounce && i < count; i++)
		bounce[i] = fmaxf(bounce[i], -light->direct[i]);
}

/* Finds which share of the object's light under an even sky has bounced, in its finished rows. */
static void find_bounced(struct tile *tile, const struct encode_samples *part)
{
	const size_t count = tile_bounce_size(tile);

	for (int k = 0; part->bounce && k < part->pixels; k++) {
		double direct = 0, bounced = 0;

		for (size_t i = (size_t)k * count; i < ((size_t)k + 1) * count; i++) {
			direct += (double)part->direct[i];
			bounced += (double)part->bounce[i];
		}
		if (bounced > 0)
			tile->result.distance[BASIS_BOUNCED][part->pixel[k]] =
				(float)((direct + bounced) / bounced);
	}
}

static void finish_object(struct tile *tile)
{
	int kept = 0;

	for (int at = 0; at < TILE_PIXELS; at++) {
		if (!tile->pixels[at].object)
			continue;
		move_rows(tile, TILE_OBJECT, at, kept, tile->samples);
		tile->result.object_pixel[kept++] = (uint16_t)at;
	}
	tile_add_part(tile, TILE_OBJECT, BASIS_KIND_T, tile->result.object_pixel, kept);
	if (kept)
		keep_positive(&tile->result.part[tile->result.part_count - 1],
			      tile->rows[TILE_OBJECT].bounce[0],
			      (size_t)kept * tile_bounce_size(tile));
	if (kept)
		find_bounced(tile, &tile->result.part[tile->result.part_count - 1]);
}

/* Finishes the shadow on flat ground. Samples that see neither object nor real surface count as
 * unchanged. */
static void finish_shadow(struct tile *tile)
{
	int kept = 0;

	for (int at = 0; at < TILE_PIXELS; at++) {
		const struct tile_pixel *p = &tile->pixels[at];

		if (!p->receiver || !p->changed)
			continue;
		move_rows(tile, TILE_CHANGE, at, kept, p->other_weight);
		tile->result.change_pixel[kept++] = (uint16_t)at;
	}
	tile_add_part(tile, TILE_CHANGE, BASIS_KIND_V, tile->result.change_pixel, kept);
}

/* with = without - with */
static void subtract_rows(const float *without, float *with, size_t count)
{
	for (size_t i = 0; i < count; i++)
		with[i] = without[i] - with[i];
}

/* Returns the largest |d / u| of a pixel's lights: no lighting changes its ratio by more. */
static double largest_change(const struct tile *tile, int at)
{
	const struct tile_rows *rows[2] = {&tile->rows[TILE_CHANGE], &tile->rows[TILE_WITHOUT]};
	const size_t size = tile_bounce_size(tile), first = (size_t)at * size;
	const struct tile_pixel *p = &tile->pixels[at];
	double most = 0;

	for (size_t i = first; i < first + size; i++) {
		double sum[2];

		for (int k = 0; k < 2; k++)
			sum[k] = (double)rows[k]->direct[i] + (double)rows[k]->bounce[0][i] +
				 (double)rows[k]->bounce[1][i];
		if (sum[1] > 0)
			most = fmax(most,
				    fabs(sum[0] / sum[1]) * p->receiver_weight / p->other_weight);
		else if (sum[0] != 0)
			return INFINITY;
	}
	return most;
}

static void finish_difference(struct tile *tile)
{
	const struct tile_rows *with = &tile->rows[TILE_CHANGE];
	const struct tile_rows *without = &tile->rows[TILE_WITHOUT];
	const size_t size = tile_bounce_size(tile);
	int kept = 0;

	for (int at = 0; at < TILE_PIXELS; at++) {
		struct tile_pixel *p = &tile->pixels[at];
		const size_t row = (size_t)at * size;
		double change;

		if (!p->receiver || !p->changed)
			continue;
		subtract_rows(without->direct + row, with->direct + row, size);
		for (int half = 0; half < 2; half++) {
			subtract_rows(without->bounce[half] + row, with->bounce[half] + row, size);
		}
		change = largest_change(tile, at);
		if (change <= tile->settings.ratio_cut) {
			tile->result.ratio_error = fmax(tile->result.ratio_error, change);
			p->changed = p->object > 0;
			continue;
		}
		move_rows(tile, TILE_CHANGE, at, kept, p->other_weight);
		move_rows(tile, TILE_WITHOUT, at, kept, p->receiver_weight);
		tile->result.change_pixel[kept++] = (uint16_t)at;
	}
	tile_add_part(tile, TILE_CHANGE, BASIS_KIND_D, tile->result.change_pixel, kept);
	tile_add_part(tile, TILE_WITHOUT, BASIS_KIND_U, tile->result.change_pixel, kept);
	if (kept)
		keep_positive(&tile->result.part[tile->result.part_count - 1], without->bounce[0],
			      (size_t)kept * size);
}

/* What is only seen through glass counts as being where the glass is. Flat ground is left out. */
static void finish_places(struct tile *tile)
{
	for (int at = 0; at < TILE_PIXELS; at++) {
		const struct tile_pixel *p = &tile->pixels[at];
		float *to[] = {&tile->result.distance[BASIS_OBJECT][at],
			       &tile->result.distance[BASIS_RECEIVER][at]};

		tile->result.distance[BASIS_BOUNCED][at] = 0;
		*to[0] = p->object ? (float)(p->distance[BASIS_OBJECT] / p->object) : 0;
		*to[1] = p->direct ? (float)(p->distance[BASIS_RECEIVER] / p->direct) : *to[0];
		if (!tile_has_standins(tile) || !p->receiver)
			*to[1] = 0;
	}
}

/* Lists the look-ups of a pixel, and leaves to T what they do not have. */
static void finish_mirror(struct tile *tile, int at)
{
	const struct mirror_pixel *p = &tile->mirror[at];
	const size_t lights = (size_t)tile->cells->count;
	float *row = tile->rows[TILE_OBJECT].direct +
		     (size_t)at * tile_direct_size(tile, TILE_OBJECT);
	struct basis_mirror *m = tile->result.mirror + tile->result.mirror_count;
	double scale[3];
	const int count = mirror_pixel_divide(&tile->mirror[at], tile->cells, tile->samples, m,
					      scale);

	tile->result.mirror_count += count;
	for (int k = 0; k < count; k++) {
		m[k].x = (uint16_t)(tile->x + at % BASIS_TILE);
		m[k].y = (uint16_t)(tile->y + at / BASIS_TILE);
	}
	for (int k = 0; k < p->count; k++)
		for (size_t c = 0; c < 3; c++)
			row[c * lights + (size_t)p->sample[k].cell] +=
				(p->sample[k].rest * (float)scale[c] - 1) * p->sample[k].light.c[c];
}

static void tile_clear(struct tile *tile)
{
	memset(tile->pixels, 0, sizeof(tile->pixels));
	tile_noise_clear(tile);
	tile->result.mirror_count = 0;
	for (int at = 0; tile->mirror && at < TILE_PIXELS; at++)
		mirror_pixel_clear(&tile->mirror[at]);
	tile->batches = tile->samples = tile->result.part_count = 0;
	tile->half_samples[0] = tile->half_samples[1] = 0;
	tile->result.ratio_error = 0;
}

void tile_render(struct tile *tile, int index)
{
	const struct tsai_camera *camera = &tile->scene->camera;
	const int across = (camera->width + BASIS_TILE - 1) / BASIS_TILE;

	tile->x = index % across * BASIS_TILE;
	tile->y = index / across * BASIS_TILE;
	tile->width = camera->width - tile->x < BASIS_TILE ? camera->width - tile->x : BASIS_TILE;
	tile->height = camera->height - tile->y < BASIS_TILE ? camera->height - tile->y
							     : BASIS_TILE;
	tile_clear(tile);
	run_batches(tile);
	for (int at = 0; at < TILE_PIXELS; at++)
		tile->result.coverage[at] =
			(uint16_t)lround(65535.0 * tile->pixels[at].object / tile->samples);
	finish_places(tile);
	tile_glass_finish(tile);
	for (int at = 0; tile->mirror && at < TILE_PIXELS; at++)
		if (tile->mirror[at].count)
			finish_mirror(tile, at);
	finish_object(tile);
	if (tile_has_standins(tile))
		finish_difference(tile);
	else
		finish_shadow(tile);
	tile_noise_judge(tile);
}
