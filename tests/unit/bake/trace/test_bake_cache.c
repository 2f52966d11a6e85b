/* SPDX-License-Identifier: MIT */
/* The cache of bounced light against paths that are followed to their ends, in a corner of coloured
 * walls, where most light is bounced. */
#include <stdlib.h>

#include "bake/tiles/tile.h"
#include "bake/trace/cache.h"
#include "hal/colour/transfer.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define SAMPLES 256
#define SIZE (2 * BASIS_TILE)
#define TILES 4
#define BOUNCES 8
#define RUN 16 /* pixels that are compared by their mean */
/* The bounds that bake/trace/README.md states, in 8-bit levels, RMS. */
#define EVEN_LEVELS 0.3
#define CELL_LEVELS 1.0
#define MEAN_SHARE 0.01

static struct scene *open_corner(const char *materials)
{
	small_scene_write("floor.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
	small_scene_write("left.obj", "v -1 -1 0\nv -1 1 0\nv -1 1 1.6\nv -1 -1 1.6\nf 1 2 3 4\n");
	small_scene_write("back.obj", "v -1 1 0\nv 1 1 0\nv 1 1 1.6\nv -1 1 1.6\nf 1 2 3 4\n");
	small_scene_write_sphere("ball.obj", 0.35, 16);
	small_scene_write("corner.ini",
			  "[camera]\nposition = 3 -4 2.6\nlook_at = 0 0 0.6\nfield_deg = 36\n"
			  "width = %d\nheight = %d\n[render]\n[ground]\n%s[object floor]\n"
			  "file = floor.obj\nup = z\nmaterial = white\nposition = 0 0 0.02\n"
			  "[object left]\nfile = left.obj\nup = z\nmaterial = red\n"
			  "position = 0 0 0.02\n[object back]\nfile = back.obj\nup = z\n"
			  "material = white\nposition = 0 0 0.02\n[object ball]\nfile = ball.obj\n"
			  "up = z\nmaterial = white\nposition = -0.35 0.3 0.37\n",
			  SIZE, SIZE, materials);
	return small_scene_open("corner.ini");
}

static bool look(void *context, double x, double y, struct surface *surface, struct v3 *direction)
{
	const struct scene *scene = context;

	return scene_look(scene, WITH_OBJECTS, x * scene->camera.width, y * scene->camera.height,
			  surface, direction);
}

static struct cache *make_cache(struct scene *scene, const struct cells *cells, int bounces,
				int threads)
{
	const struct cache_settings settings = {
		.world = scene->world,
		.cells = cells,
		.bounces = bounces,
		.seed = 1,
		.records = CACHE_RECORDS_MAX,
		.look = look,
		.context = scene,
	};
	struct cache *cache = NULL;
	struct pool *pool;

	assert_int_equal(pool_create(&pool, threads), 0);
	assert_int_equal(cache_create(&cache, &settings, pool), 0);
	pool_destroy(pool);
	return cache;
}

static void make_cells(struct dome *dome, struct cells *cells)
{
	struct fault fault;

	assert_int_equal(dome_create(dome, 3, &fault), 0);
	assert_int_equal(cells_create(cells, dome), 0);
}

/* ---- against followed paths ---- */

/* Sums of squared differences, in 8-bit levels, and of bounced light. */
struct comparison {
	double even, cell, bounced[2];
	long evens, cells;
};

static double level_of(double light)
{
	return 255 * transfer_encode(TRANSFER_SRGB, fmin(fmax(light, 0), 1));
}

/* Mean of one light and channel over a run of pixels, by which noise of the paths is lower. */
static double mean_of(const float *row, int first, size_t at, size_t size)
{
	double sum = 0;

	for (int p = first; p < first + RUN; p++)
		sum += (double)row[(size_t)p * size + at] / RUN;
	return sum;
}

static void compare_run(const struct cells *cells, const struct encode_samples part[2], int first,
			struct comparison *sum)
{
	const size_t n = (size_t)cells->count, size = 3 * n;

	for (size_t c = 0; c < 3; c++) {
		double all[2] = {0, 0};

		for (size_t i = 0; i < n; i++) {
			/* a cell alone makes a white surface that faces it shine with 1 */
			const double alone = M_PI / (double)cells->sr[i];
			double value[2], off;

			for (int k = 0; k < 2; k++) {
				const double bounced = mean_of(part[k].bounce, first, c * n + i,
							       size);

				value[k] = mean_of(part[k].direct, first, c * n + i, size) +
					   bounced;
				all[k] += value[k];
				sum->bounced[k] += bounced;
			}
			off = level_of(alone * value[0]) - level_of(alone * value[1]);
			sum->cell += off * off;
			sum->cells++;
		}
		sum->even += pow(level_of(all[0]) - level_of(all[1]), 2);
		sum->evens++;
	}
}

static void compare_object(const struct cells *cells, const struct encode_samples part[2],
			   struct comparison *sum)
{
	assert_int_equal(part[0].pixels, part[1].pixels);
	for (int first = 0; first + RUN <= part[0].pixels; first += RUN)
		compare_run(cells, part, first, sum);
}

static void check_corner(const char *what, const char *materials)
{
	const struct tile_settings settings = {.samples = SAMPLES, .seed = 3};
	struct scene *scene = open_corner(materials);
	struct comparison sum = {.even = 0};
	const int tiles = thorough() ? TILES : 1;
	struct tile *tile = calloc(2, sizeof(*tile));
	struct cache *cache;
	struct cells cells;
	struct dome dome;

	assert_non_null(tile);
	make_cells(&dome, &cells);
	cache = make_cache(scene, &cells, BOUNCES, 2);
	assert_non_null(cache);
	for (int k = 0; k < 2; k++)
		assert_int_equal(tile_create(&tile[k], scene, &cells, &settings, BOUNCES), 0);
	tile[1].transport.cache = cache;
	/* The first tile has the walls and the ball. */
	for (int index = 0; index < tiles; index++) {
		for (int k = 0; k < 2; k++)
			tile_render(&tile[k], index);
		if (tile[0].result.part_count && tile[0].result.part[0].kind == BASIS_KIND_T) {
			const struct encode_samples part[2] = {tile[0].result.part[0],
							       tile[1].result.part[0]};

			compare_object(&cells, part, &sum);
		}
	}
	assert_true(sum.evens > 12 * tiles);
	sum.even = sqrt(sum.even / (double)sum.evens);
	sum.cell = sqrt(sum.cell / (double)sum.cells);
	print_message(
		"# %s: off by %.3f levels under an even sky, %.3f under single cells; bounced light %+.2f %%\n",
		what, sum.even, sum.cell, 100 * (sum.bounced[1] / sum.bounced[0] - 1));
	assert_true(sum.even < EVEN_LEVELS);
	assert_true(sum.cell < CELL_LEVELS);
	assert_true(fabs(sum.bounced[1] / sum.bounced[0] - 1) < MEAN_SHARE);
	for (int k = 0; k < 2; k++)
		tile_free(&tile[k]);
	free(tile);
	cache_destroy(cache);
	cells_free(&cells);
	dome_free(&dome);
	scene_close(scene);
}

TEST("diffuse")
{
	check_corner("diffuse", "[material red]\ncolour = 0.8 0.1 0.08\n[material white]\n");
}

TEST("glossy")
{
	check_corner("glossy", "[material red]\nkind = glossy\ncolour = 0.8 0.1 0.08\n"
			       "[material white]\nkind = glossy\nroughness = 0.2\n");
}

/* ---- the cache alone ---- */

/* White walls and white ground send back all light: each row sums to 1. */
TEST("furnace")
{
	struct scene *scene = open_corner("material = white\n[material red]\ncolour = 1 1 1\n"
					  "[material white]\ncolour = 1 1 1\n");
	struct surface surface;
	struct v3 direction;
	struct cache *cache;
	struct cells cells;
	struct dome dome;

	make_cells(&dome, &cells);
	cache = make_cache(scene, &cells, 64, 1);
	assert_non_null(cache);
	for (int x = 0; x < SIZE; x++) {
		double sum = 0;

		if (!scene_look(scene, WITH_OBJECTS, x + 0.5, SIZE / 2, &surface, &direction))
			continue;
		for (int i = 0; i < cells.count; i++)
			sum += (double)cache_row(cache, cache_find(cache, &surface))[i];
		assert_true(fabs(sum - 1) < 0.02);
	}
	cache_destroy(cache);
	cells_free(&cells);
	dome_free(&dome);
	scene_close(scene);
}

TEST("threads")
{
	struct scene *scene = open_corner("[material red]\n[material white]\n");
	struct surface surface;
	struct v3 direction;
	struct cache *cache[2];
	struct cells cells;
	struct dome dome;

	make_cells(&dome, &cells);
	cache[0] = make_cache(scene, &cells, BOUNCES, 1);
	cache[1] = make_cache(scene, &cells, BOUNCES, 5);
	for (int x = 0; x < SIZE * SIZE; x++) {
		int record[2];

		if (!scene_look(scene, WITH_OBJECTS, x % SIZE, (double)x / SIZE, &surface,
				&direction))
			continue;
		for (int k = 0; k < 2; k++)
			record[k] = cache_find(cache[k], &surface);
		assert_int_equal(record[0], record[1]);
		assert_memory_equal(cache_row(cache[0], record[0]), cache_row(cache[1], record[0]),
				    3 * (size_t)cells.count * sizeof(float));
	}
	cache_destroy(cache[0]);
	cache_destroy(cache[1]);
	cells_free(&cells);
	dome_free(&dome);
	scene_close(scene);
}

/* A ball in the air: no path meets a second surface. */
TEST("nothing to cache")
{
	struct scene *scene;
	struct cells cells;
	struct dome dome;

	small_scene_write_sphere("ball.obj", 0.5, 12);
	small_scene_write("ball.ini", "[camera]\nposition = 0 -4 2\nlook_at = 0 0 1\nwidth = 16\n"
				      "height = 16\n[object ball]\nfile = ball.obj\nup = z\n"
				      "position = 0 0 1\n");
	scene = small_scene_open("ball.ini");
	make_cells(&dome, &cells);
	assert_null(make_cache(scene, &cells, BOUNCES, 1));
	cells_free(&cells);
	dome_free(&dome);
	scene_close(scene);
}

TEST_GROUP(small_scene_begin, small_scene_end);
