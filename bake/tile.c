#include "bake/tile.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/transfer.h"

#define BATCH_FEWEST 4	   /* a spread of fewer batches says nothing */
#define BATCH_SAMPLES 4	   /* a pixel and batch, when noise says how many batches */
#define SAMPLES_MOST 16384 /* where noise gives up */
#define BACKGROUND 0.5	   /* behind the object when noise is judged */

static size_t row_size(const struct tile *tile)
{
	return 3 * (size_t)tile->cells->count;
}

int tile_create(struct tile *tile, const struct scene *scene, const struct cells *cells,
		const struct tile_settings *settings, int bounces)
{
	const size_t floats = TILE_PIXELS * 3 * (size_t)cells->count;
	const bool standins = world_has_standins(scene->world);
	int err;

	memset(tile, 0, sizeof(*tile));
	tile->scene = scene;
	tile->cells = cells;
	tile->settings = *settings;
	err = transport_create(&tile->transport, scene->world, cells, bounces);
	if (err)
		return err;
	tile->object = malloc(floats * sizeof(float));
	tile->change = malloc(floats * sizeof(float));
	if (standins)
		tile->without = malloc(floats * sizeof(float));
	if (tile->object && tile->change && (tile->without || !standins))
		return 0;
	tile_free(tile);
	return -ENOMEM;
}

void tile_free(struct tile *tile)
{
	transport_free(&tile->transport);
	free(tile->object);
	free(tile->change);
	free(tile->without);
	tile->object = tile->change = tile->without = NULL;
}

/* ---- samples ---- */

static void add_receiver(struct tile *tile, int at, const struct surface *surface, struct v3 wo,
			 uint32_t pixel, uint32_t sample)
{
	struct transport *t = &tile->transport;
	struct tile_pixel *p = &tile->pixels[at];
	const size_t row = (size_t)at * row_size(tile);

	p->receiver++;
	if (!tile->without) {
		p->changed |= transport_add_shadow(t, surface->position, tile->change + row);
		return;
	}
	transport_add(t, WITH_OBJECTS, surface, wo, tile->change + row);
	transport_begin(t, tile->settings.seed, pixel, sample);
	transport_add(t, WITHOUT_OBJECTS, surface, wo, tile->without + row);
}

static void add_sample(struct tile *tile, int at, uint32_t sample)
{
	const int x = tile->x + at % BASIS_TILE, y = tile->y + at / BASIS_TILE;
	const uint32_t pixel = (uint32_t)y * (uint32_t)tile->scene->camera.width + (uint32_t)x;
	const uint64_t scramble = random_hash(tile->settings.seed, pixel, 0xca3e5a);
	const uint32_t place = sobol_shuffle(sample, (uint32_t)random_mix(scramble));
	struct tile_pixel *p = &tile->pixels[at];
	struct surface surface;
	struct v3 direction;
	double at_pixel[2];
	bool met;

	sobol_point(place, scramble, at_pixel);
	tile->transport.ray_count++;
	transport_begin(&tile->transport, tile->settings.seed, pixel, sample);
	met = scene_look(tile->scene, WITH_OBJECTS, x + at_pixel[0], y + at_pixel[1], &surface,
			 &direction);
	if (met && surface.kind == SURFACE_OBJECT) {
		p->object++;
		p->changed = true;
		transport_add(&tile->transport, WITH_OBJECTS, &surface, v3_scale(direction, -1),
			      tile->object + (size_t)at * row_size(tile));
		return;
	}
	p->other++;
	if (met)
		add_receiver(tile, at, &surface, v3_scale(direction, -1), pixel, sample);
}

/* ---- noise ---- */

static double sum_row(const float *row, int count)
{
	double sum = 0;

	for (int i = 0; i < count; i++)
		sum += row[i];
	return sum;
}

/* One more value of each pixel under a uniform sky, from the batch just made. */
static void add_batch(struct tile *tile, int at, int samples)
{
	struct tile_pixel *p = &tile->pixels[at];
	const int count = tile->cells->count;
	const double other = p->other - p->before_count[0];
	const double receiver = p->receiver - p->before_count[1];
	const double coverage = 1 - other / samples;

	for (int c = 0; c < 3; c++) {
		const size_t row = (size_t)at * row_size(tile) + (size_t)c * (size_t)count;
		const double total[3] = {
			p->object ? sum_row(tile->object + row, count) : 0,
			p->receiver ? sum_row(tile->change + row, count) : 0,
			p->receiver && tile->without ? sum_row(tile->without + row, count) : 0,
		};
		double fresh[3], value, deviation, ratio = 1;

		for (int k = 0; k < 3; k++) {
			fresh[k] = total[k] - p->before[c][k];
			p->before[c][k] = total[k];
		}
		if (receiver > 0 && !tile->without)
			ratio -= fresh[1] / other;
		else if (receiver > 0 && fresh[2] > 0)
			ratio -= (1 - fresh[1] / fresh[2]) * receiver / other;
		value = fresh[0] / samples + (1 - coverage) * fmax(ratio, 0) * BACKGROUND;
		deviation = value - p->mean[c];
		p->mean[c] += deviation / tile->batches;
		p->spread[c] += deviation * (value - p->mean[c]);
	}
	p->before_count[0] = p->other;
	p->before_count[1] = p->receiver;
}

static double levels_of(double mean, double error)
{
	return 127.5 * (transfer_encode(TRANSFER_SRGB, mean + error) -
			transfer_encode(TRANSFER_SRGB, mean - error));
}

/* The standard error of the mean over batches, RMS over the tile's changed pixels. */
static double judge_noise(struct tile *tile)
{
	tile->noise_square = 0;
	tile->noise_count = 0;
	if (tile->batches < 2)
		return 0;
	for (int at = 0; at < TILE_PIXELS; at++) {
		const struct tile_pixel *p = &tile->pixels[at];
		const double n = tile->batches;

		if (!p->changed)
			continue;
		for (int c = 0; c < 3; c++) {
			const double e = levels_of(p->mean[c], sqrt(p->spread[c] / (n * (n - 1))));

			tile->noise_square += e * e;
			tile->noise_count++;
		}
	}
	return tile->noise_count ? sqrt(tile->noise_square / (double)tile->noise_count) : 0;
}

static void find_changes(struct tile *tile)
{
	const size_t row = row_size(tile);

	if (!tile->without)
		return;
	for (int at = 0; at < TILE_PIXELS; at++)
		if (!tile->pixels[at].changed)
			tile->pixels[at].changed = memcmp(tile->change + (size_t)at * row,
							  tile->without + (size_t)at * row,
							  row * sizeof(float)) != 0;
}

static void run_batch(struct tile *tile, int samples)
{
	tile->batches++;
	for (int y = 0; y < tile->height; y++)
		for (int x = 0; x < tile->width; x++) {
			const int at = y * BASIS_TILE + x;

			for (int k = 0; k < samples; k++)
				add_sample(tile, at, (uint32_t)(tile->samples + k));
			add_batch(tile, at, samples);
		}
	tile->samples += samples;
	find_changes(tile);
}

static void run_batches(struct tile *tile)
{
	const struct tile_settings *s = &tile->settings;

	if (s->noise_levels > 0) {
		do
			run_batch(tile, BATCH_SAMPLES);
		while (tile->batches < BATCH_FEWEST ||
		       (judge_noise(tile) > s->noise_levels && tile->samples < SAMPLES_MOST));
	} else {
		const int batches = s->samples < 8 ? s->samples : 8;

		for (int k = 0; k < batches; k++)
			run_batch(tile, s->samples * (k + 1) / batches - s->samples * k / batches);
	}
	judge_noise(tile);
}

/* ---- finishing ---- */

static void add_part(struct tile *tile, enum basis_kind kind, const uint16_t *pixel, int pixels,
		     const float *value)
{
	if (pixels)
		tile->part[tile->part_count++] = (struct encode_samples){
			.kind = kind,
			.pixels = pixels,
			.pixel = pixel,
			.value = value,
		};
}

/* Means over samples, moved together in place. */
static void finish_object(struct tile *tile)
{
	const size_t row = row_size(tile);
	const float scale = 1.0f / (float)tile->samples;
	int kept = 0;

	for (int at = 0; at < TILE_PIXELS; at++) {
		const float *from = tile->object + (size_t)at * row;
		float *to = tile->object + (size_t)kept * row;

		if (!tile->pixels[at].object)
			continue;
		for (size_t i = 0; i < row; i++)
			to[i] = from[i] * scale;
		tile->object_pixel[kept++] = (uint16_t)at;
	}
	add_part(tile, BASIS_KIND_T, tile->object_pixel, kept, tile->object);
}

/* Samples that see neither object nor real surface are unchanged, and count so. */
static void finish_shadow(struct tile *tile)
{
	const int count = tile->cells->count;
	const size_t row = row_size(tile);
	int kept = 0;

	for (int at = 0; at < TILE_PIXELS; at++) {
		const struct tile_pixel *p = &tile->pixels[at];
		const float *from = tile->change + (size_t)at * row;
		float *to = tile->change + (size_t)kept * row;

		if (!p->receiver || !p->changed)
			continue;
		for (int c = 0; c < 3; c++)
			for (int i = 0; i < count; i++)
				to[c * count + i] = from[c * count + i] /
						    ((float)p->other * tile->cells->share[i]);
		tile->change_pixel[kept++] = (uint16_t)at;
	}
	add_part(tile, BASIS_KIND_V, tile->change_pixel, kept, tile->change);
}

/* The largest |d / u| of a pixel: no lighting changes its ratio by more. */
static double largest_change(const float *d, const float *u, size_t count)
{
	double most = 0;

	for (size_t i = 0; i < count; i++)
		if (u[i] > 0)
			most = fmax(most, fabs((double)d[i] / (double)u[i]));
		else if (d[i] != 0)
			return INFINITY;
	return most;
}

static void finish_difference(struct tile *tile)
{
	const size_t row = row_size(tile);
	int kept = 0;

	for (int at = 0; at < TILE_PIXELS; at++) {
		const struct tile_pixel *p = &tile->pixels[at];
		const float *with = tile->change + (size_t)at * row;
		const float *without = tile->without + (size_t)at * row;
		float *d = tile->change + (size_t)kept * row;
		float *u = tile->without + (size_t)kept * row;
		double change;

		if (!p->receiver || !p->changed)
			continue;
		for (size_t i = 0; i < row; i++) {
			d[i] = (without[i] - with[i]) / (float)p->other;
			u[i] = without[i] / (float)p->receiver;
		}
		change = largest_change(d, u, row);
		if (change <= tile->settings.ratio_cut) {
			tile->ratio_error = fmax(tile->ratio_error, change);
			continue;
		}
		tile->change_pixel[kept++] = (uint16_t)at;
	}
	add_part(tile, BASIS_KIND_D, tile->change_pixel, kept, tile->change);
	add_part(tile, BASIS_KIND_U, tile->change_pixel, kept, tile->without);
}

static void clear(struct tile *tile)
{
	const size_t bytes = TILE_PIXELS * row_size(tile) * sizeof(float);

	memset(tile->object, 0, bytes);
	memset(tile->change, 0, bytes);
	if (tile->without)
		memset(tile->without, 0, bytes);
	memset(tile->pixels, 0, sizeof(tile->pixels));
	tile->batches = tile->samples = tile->part_count = 0;
	tile->ratio_error = 0;
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
	clear(tile);
	run_batches(tile);
	for (int at = 0; at < TILE_PIXELS; at++)
		tile->coverage[at] =
			(uint16_t)lround(65535.0 * tile->pixels[at].object / tile->samples);
	finish_object(tile);
	if (tile->without)
		finish_difference(tile);
	else
		finish_shadow(tile);
}

void tile_peaks(const struct tile *tile, float (*peak)[3])
{
	const int count = tile->cells->count;

	for (int k = 0; k < tile->part_count; k++) {
		const struct encode_samples *part = &tile->part[k];

		if (part->kind != BASIS_KIND_T)
			continue;
		for (int p = 0; p < part->pixels; p++)
			for (int c = 0; c < 3; c++) {
				const float *row = part->value + (size_t)p * row_size(tile) +
						   (size_t)c * (size_t)count;

				for (int i = 0; i < count; i++)
					peak[i][c] = fmaxf(peak[i][c], row[i]);
				peak[count][c] = fmaxf(peak[count][c], (float)sum_row(row, count));
			}
	}
}
