/* SPDX-License-Identifier: MIT */
/* The filter of bounced light takes noise away, and never light. */
#include <math.h>
#include <stdlib.h>

#include "bake/base/random.h"
#include "bake/scene/scene.h"
#include "bake/tiles/tile.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define SEED 20
#define SAMPLES 16
#define REFERENCE (16 * SAMPLES)

/* Pixels row by row. */
static uint16_t every_pixel[TILE_PIXELS];

/* ---- made matrices ---- */

struct made {
	int rows, lights;
	float *light, *half[2], *mean, *even;
	double share[2];
};

/* About normal, with standard deviation 1. */
static double deviate(struct random *random)
{
	double sum = -6;

	for (int k = 0; k < 12; k++)
		sum += (double)random_next(random);
	return sum;
}

/* Light of a rank, each part `fall` times the one before, with noise in each half. */
static struct made bake_bounce_make(int rows, int lights, int rank, double fall, double noise,
				    double share)
{
	struct random random = {SEED};
	const size_t count = (size_t)rows * (size_t)lights;
	struct made m = {.rows = rows, .lights = lights, .share = {share, 1 - share}};
	double *left = malloc((size_t)rows * sizeof(*left));
	double *right = malloc((size_t)lights * sizeof(*right));

	m.light = calloc(count, sizeof(float));
	m.half[0] = malloc(count * sizeof(float));
	m.half[1] = malloc(count * sizeof(float));
	m.mean = malloc(count * sizeof(float));
	m.even = malloc((size_t)lights * sizeof(float));
	for (int k = 0; k < rank; k++) {
		for (int i = 0; i < rows; i++)
			left[i] = k ? deviate(&random) : 1 + 0.2 * deviate(&random);
		for (int i = 0; i < lights; i++)
			right[i] = (k ? deviate(&random) : 1 + 0.2 * deviate(&random)) *
				   pow(fall, k);
		for (size_t at = 0; at < count; at++)
			m.light[at] +=
				(float)(left[at / (size_t)lights] * right[at % (size_t)lights]);
	}
	for (size_t at = 0; at < count; at++) {
		for (int h = 0; h < 2; h++)
			m.half[h][at] = m.light[at] +
					(float)(noise / sqrt(2 * m.share[h]) * deviate(&random));
		m.mean[at] = (float)(m.share[0] * (double)m.half[0][at] +
				     m.share[1] * (double)m.half[1][at]);
	}
	for (int i = 0; i < lights; i++)
		m.even[i] = 1;
	free(left);
	free(right);
	return m;
}

static void unmake(struct made *m)
{
	free(m->light);
	free(m->half[0]);
	free(m->half[1]);
	free(m->mean);
	free(m->even);
}

static int filter(const struct made *m)
{
	const struct bounce_halves halves = {
		.rows = m->rows,
		.pixel = every_pixel,
		.half = {m->half[0], m->half[1]},
		.share = {m->share[0], m->share[1]},
		.sky = m->even,
		.scale = m->even,
	};
	struct bounce bounce;
	int kept;

	assert_int_equal(bounce_create(&bounce, m->lights), 0);
	kept = bounce_filter(&bounce, &halves);
	bounce_free(&bounce);
	bounce_free(&bounce);
	return kept;
}

static double distance(const float *a, const float *b, size_t count)
{
	double square = 0;

	for (size_t i = 0; i < count; i++)
		square += ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
	return sqrt(square / (double)count);
}

/* Filtered error as a share of the unfiltered error. */
static double error_of(const struct made *m)
{
	const size_t count = (size_t)m->rows * (size_t)m->lights;

	return distance(m->half[0], m->light, count) / distance(m->mean, m->light, count);
}

/* The filter keeps each row's sum and, of every column, each channel's mean. */
static void check_sums(const struct made *m)
{
	for (int row = 0; row < m->rows; row++) {
		double change = 0, size = 0;

		for (int i = 0; i < m->lights; i++) {
			const size_t at = (size_t)row * (size_t)m->lights + (size_t)i;

			change += (double)m->half[0][at] - (double)m->mean[at];
			size += fabs((double)m->mean[at]);
		}
		expect_at_most(fabs(change), 2e-5 * size + 1e-30, "row=%d", row);
	}
	for (int i = 0; i < m->lights; i++)
		for (int c = 0; c < 3; c++) {
			double change = 0, size = 0;

			for (int row = c; row < m->rows; row += 3) {
				const size_t at = (size_t)row * (size_t)m->lights + (size_t)i;

				change += (double)m->half[0][at] - (double)m->mean[at];
				size += fabs((double)m->mean[at]);
			}
			expect_at_most(fabs(change), 2e-5 * size + 1e-30, "i=%d, c=%d", i, c);
		}
}

/* RMS of the example of noise, as a share of the filtered error. */
static double example_of(const struct made *m)
{
	const size_t count = (size_t)m->rows * (size_t)m->lights;
	float *nothing = calloc(count, sizeof(*nothing));
	const double size = distance(m->half[1], nothing, count);

	free(nothing);
	return size / distance(m->half[0], m->light, count);
}

/* Few and many lights, low and higher rank, little and much noise, halves of equal and of different
 * size. */
TEST("made")
{
	static const struct {
		int rows, lights, rank;
		double fall, noise, share, most;
	} cases[] = {
		{768, 406, 1, 1, 1, 0.5, 0.15},	   {768, 406, 4, 0.5, 0.5, 0.5, 0.25},
		{768, 406, 4, 0.5, 20, 0.5, 0.5},  {768, 406, 30, 0.9, 0.3, 0.5, 0.7},
		{768, 6, 1, 1, 1, 0.5, 0.6},	   {768, 6, 6, 0.7, 1, 0.5, 1.01},
		{9, 406, 1, 1, 1, 0.5, 0.7},	   {768, 46, 3, 0.5, 1, 2.0 / 3, 0.5},
		{768, 6486, 3, 0.5, 1, 0.5, 0.15}, {3, 1, 1, 1, 1, 0.5, 1.01},
		{768, 406, 0, 1, 1, 0.5, 0.2},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(cases[0]); k++) {
		struct made m = bake_bounce_make(cases[k].rows, cases[k].lights, cases[k].rank,
						 cases[k].fall, cases[k].noise, cases[k].share);
		const int kept = filter(&m);
		const double error = error_of(&m);

		print_message(
			"# %d x %d, rank %d, noise %g: kept %d, error %.3f of the mean's, example %.3f of that\n",
			m.rows, m.lights, cases[k].rank, cases[k].noise, kept, error,
			example_of(&m));
		expect_at_most(error, cases[k].most, "k=%zu", k);
		/* a few values have any size by chance */
		expect_that(m.rows * m.lights < 100 || fabs(example_of(&m) - 0.95) < 0.15, "k=%zu",
			    k);
		check_sums(&m);
		unmake(&m);
	}
}

/* Light without noise, or of full rank, stays the same but for rounding. */
TEST("nothing to gain")
{
	for (int k = 0; k < 2; k++) {
		struct made m = bake_bounce_make(300, 200, 200, 1, k ? 1.0 : 0.0, 0.5);
		const size_t count = (size_t)m.rows * (size_t)m.lights;

		expect_equal(filter(&m), -1, "k=%d", k);
		expect_below(distance(m.half[0], m.mean, count), 1e-4, "k=%d", k);
		unmake(&m);
	}
}

/* Differences have both signs: rows whose sums are only noise must not grow. */
TEST("sums that cancel")
{
	struct made m = bake_bounce_make(300, 200, 3, 0.7, 1, 0.5);

	for (int row = 0; row < m.rows; row++) {
		double sum = 0;

		for (int i = 0; i < m.lights; i++)
			sum += (double)m.light[row * m.lights + i] / m.lights;
		for (int i = 0; i < m.lights; i++) {
			const int at = row * m.lights + i;

			m.light[at] -= (float)sum;
			m.mean[at] -= (float)sum;
			m.half[0][at] -= (float)sum;
			m.half[1][at] -= (float)sum;
		}
	}
	filter(&m);
	print_message("# sums that cancel: error %.3f of the mean's\n", error_of(&m));
	assert_true(error_of(&m) < 1.001);
	unmake(&m);
}

TEST("odd values")
{
	static const float odd[] = {NAN, INFINITY, 1e30F, 1e-40F};
	struct made m;

	m = bake_bounce_make(30, 20, 0, 1, 0, 0.5);
	assert_int_equal(filter(&m), -1);
	for (int k = 0; k < 600; k++)
		expect_equal(m.half[0][k], 0, "k=%d", k);
	unmake(&m);
	for (size_t k = 0; k < sizeof(odd) / sizeof(odd[0]); k++) {
		m = bake_bounce_make(30, 20, 1, 1, 1, 0.5);
		m.half[0][77] = odd[k];
		filter(&m);
		/* NaN and infinity must reach the encoder, which refuses them */
		expect_equal(isfinite(odd[k]), isfinite(m.half[0][77]), "k=%zu", k);
		unmake(&m);
	}
}

/* ---- tiles that meet ---- */

#define WIDE (2 * BASIS_TILE) /* two tiles side by side */
#define SEAM_LIGHTS 200

/* Light that is smooth over both tiles: each light has a mean, a slope and a curvature of its own.
 */
static double smooth(const double *of_light, int x, int y)
{
	const double u = x / (double)WIDE - 0.5, v = y / (double)WIDE - 0.25;

	return 1 + 0.2 * of_light[0] + (0.3 + 0.3 * of_light[1]) * u + 0.3 * of_light[2] * v +
	       0.1 * of_light[3] * u * u;
}

/* Step between the columns of pixels on both sides of x, beyond the slope there: for each light the
 * mean over the length of the edge, then RMS over lights. */
static double step_at(const float *const tile[2], int x)
{
	static const double part[] = {0.25, 0, -1.25, 1.25, 0, -0.25};
	double square = 0;

	for (int i = 0; i < 3 * SEAM_LIGHTS; i++) {
		double step = 0;

		for (int y = 0; y < BASIS_TILE; y++)
			for (int k = 0; k < 6; k++) {
				const int at = x - 3 + k, p = y * BASIS_TILE + at % BASIS_TILE;

				step += part[k] / BASIS_TILE *
					(double)tile[at / BASIS_TILE][p * 3 * SEAM_LIGHTS + i];
			}
		square += step * step;
	}
	return sqrt(square / (3 * SEAM_LIGHTS));
}

/* Tiles are filtered independently. Their common edge shows no more than the noise of means and
 * slopes; where noise is loudest, a filter that keeps means alone exceeds that. */
TEST("seam")
{
	static const double noises[] = {0.02, 0.3, 0.5};

	for (size_t k = 0; k < 3; k++) {
		struct random random = {SEED + k};
		struct made m[2];
		double of_light[SEAM_LIGHTS][4], edge, inside, before;

		for (int i = 0; i < SEAM_LIGHTS * 4; i++)
			of_light[i / 4][i % 4] = deviate(&random);
		for (int t = 0; t < 2; t++) {
			m[t] = bake_bounce_make(BOUNCE_ROWS_MAX, SEAM_LIGHTS, 0, 1, noises[k], 0.5);
			for (int at = 0; at < BOUNCE_ROWS_MAX * SEAM_LIGHTS; at++) {
				const int i = at % SEAM_LIGHTS, p = at / SEAM_LIGHTS / 3;
				const float is = (float)smooth(of_light[i],
							       t * BASIS_TILE + p % BASIS_TILE,
							       p / BASIS_TILE);

				m[t].light[at] = is;
				m[t].mean[at] = is;
				for (int h = 0; h < 2; h++) {
					m[t].half[h][at] = is + (float)(noises[k] * M_SQRT2 *
									deviate(&random));
					m[t].mean[at] += (m[t].half[h][at] - is) / 2;
				}
			}
		}
		before = step_at((const float *const[]){m[0].mean, m[1].mean}, BASIS_TILE);
		for (int t = 0; t < 2; t++)
			filter(&m[t]);
		edge = step_at((const float *const[]){m[0].half[0], m[1].half[0]}, BASIS_TILE);
		inside = step_at((const float *const[]){m[0].half[0], m[1].half[0]},
				 BASIS_TILE / 2);
		print_message(
			"# noise %g: errors %.3f and %.3f of the mean's; step %.4f at the edge, %.4f inside, %.4f unfiltered\n",
			noises[k], error_of(&m[0]), error_of(&m[1]), edge, inside, before);
		/* the variance of a plane at the edge is (1 + 3) / 256 of a pixel's */
		expect_below(edge, inside + 1.2 * noises[k] * sqrt(2 * 4 / 256.0) + 0.002, "k=%zu",
			     k);
		expect_that(error_of(&m[0]) < 0.2 && error_of(&m[1]) < 0.2, "k=%zu", k);
		for (int t = 0; t < 2; t++) {
			check_sums(&m[t]);
			unmake(&m[t]);
		}
	}
}

/* ---- real tiles ---- */

/* Unfiltered tiles of one sample a pixel, summed up. */
struct tile_sums {
	float *value[BASIS_KIND_COUNT]; /* [TILE_PIXELS][3][lights] */
	bool seen[BASIS_KIND_COUNT];
};

static void add_tiles(const struct scene *scene, const struct cells *cells, int index, int seed,
		      int samples, struct tile_sums *sums)
{
	const size_t row = 3 * (size_t)cells->count;
	struct tile *tile = malloc(sizeof(*tile));
	const struct tile_settings settings = {.samples = 1};

	assert_non_null(tile);
	assert_int_equal(tile_create(tile, scene, cells, &settings, 32), 0);
	for (int kind = 0; kind < BASIS_KIND_COUNT; kind++)
		sums->value[kind] = calloc(TILE_PIXELS * row, sizeof(float));
	for (int s = 0; s < samples; s++) {
		tile->settings.seed = (uint64_t)(seed + s);
		tile_render(tile, index);
		for (int k = 0; k < tile->result.part_count; k++) {
			const struct encode_samples *part = &tile->result.part[k];

			sums->seen[part->kind] = true;
			for (size_t p = 0; p < (size_t)part->pixels; p++)
				for (size_t i = 0; i < row; i++)
					sums->value[part->kind][part->pixel[p] * row + i] +=
						part->bounce[p * row + i] / (float)samples;
		}
	}
	tile_free(tile);
	free(tile);
}

static void free_sums(struct tile_sums *sums)
{
	for (int kind = 0; kind < BASIS_KIND_COUNT; kind++)
		free(sums->value[kind]);
}

/* Error of a tile's mean under a sun in one cell and a sky of a tenth of its light: the size of the
 * step to neighbouring tiles. */
static double step_of(const float *value, const float *reference, int lights, const float *weight)
{
	double worst = 0;

	for (int sun = 0; sun < lights; sun += 1 + lights / 7) {
		double error = 0, all = 1e-12;

		for (int row = 0; row < 3 * TILE_PIXELS; row++)
			for (int i = 0; i < lights; i++) {
				const size_t at = (size_t)row * (size_t)lights + (size_t)i;
				const double l = (i == sun ? 1 / (double)weight[i] : 0.1) *
						 (double)weight[i];

				error += l * ((double)value[at] - (double)reference[at]);
				all += l * fabs((double)reference[at]);
			}
		worst = fmax(worst, fabs(error) / all);
	}
	return worst;
}

static void check_tile(const struct scene *scene, const struct cells *cells, const char *what,
		       int index, double *log_sum, int *log_count)
{
	static const char *const names[] = {"T", "V", "D", "U"};
	const size_t row = 3 * (size_t)cells->count, count = TILE_PIXELS * row;
	struct tile_sums half[2] = {0}, reference = {0};
	struct bounce bounce;
	float *sky = malloc(row * sizeof(float)), *scale = malloc(row * sizeof(float));
	float *mean = malloc(count * sizeof(float));

	assert_int_equal(bounce_create(&bounce, cells->count), 0);
	for (int h = 0; h < 2; h++)
		add_tiles(scene, cells, index, 1000 + h * SAMPLES, SAMPLES / 2, &half[h]);
	add_tiles(scene, cells, index, 5000, REFERENCE, &reference);
	for (int kind = 0; kind < BASIS_KIND_COUNT; kind++) {
		const struct bounce_halves in = {
			.rows = BOUNCE_ROWS_MAX,
			.pixel = every_pixel,
			.half = {half[0].value[kind], half[1].value[kind]},
			.share = {0.5, 0.5},
			.sky = sky,
			.scale = scale,
		};
		const bool ratio = kind == BASIS_KIND_V;
		double before, after, step;
		int kept;

		if (!half[0].seen[kind])
			continue;
		for (int i = 0; i < cells->count; i++) {
			sky[i] = ratio ? cells->share[i] : 1;
			scale[i] = ratio ? sqrtf(cells->share[i]) : 1 / sqrtf(cells->sr[i]);
		}
		for (size_t i = 0; i < count; i++)
			mean[i] = 0.5F * (in.half[0][i] + in.half[1][i]);
		before = distance(mean, reference.value[kind], count);
		step = step_of(mean, reference.value[kind], cells->count, sky);
		kept = bounce_filter(&bounce, &in);
		after = distance(in.half[0], reference.value[kind], count);
		print_message(
			"# %s, %d lights, %s: kept %d, error %.3f of the mean's; step %.4f of it, before %.4f\n",
			what, cells->count, names[kind], kept, after / before,
			step_of(in.half[0], reference.value[kind], cells->count, sky), step);
		expect_below(step_of(in.half[0], reference.value[kind], cells->count, sky),
			     step + 1e-4, "kind=%d", kind);
		expect_at_most(after, before * 1.005, "kind=%d", kind);
		*log_sum += log(after / before);
		++*log_count;
	}
	for (int h = 0; h < 2; h++)
		free_sums(&half[h]);
	free_sums(&reference);
	bounce_free(&bounce);
	free(sky);
	free(scale);
	free(mean);
}

static void check_scene(const char *what, const char *material, const char *standin)
{
	static const int frequencies[] = {3, 1, 9};
	struct scene *scene;
	double log_sum = 0;
	int log_count = 0;

	small_scene_write_sphere("ball.obj", 0.8, 24);
	small_scene_write("plane.obj", "v -9 1 0\nv 9 1 0\nv 9 1 9\nv -9 1 9\nf 1 2 3 4\n");
	small_scene_write(
		"s.ini",
		"[camera]\nposition = 0 -6 4\nlook_at = 0 0 0.4\nfield_deg = 40\nwidth = 64\n"
		"height = 64\n[render]\n[ground]\nmaterial = m\n%s[object ball]\n"
		"file = ball.obj\nup = z\nmaterial = b\nstand = yes\n[material m]\n"
		"colour = 0.6 0.5 0.4\n[material b]\n%s",
		standin, material);
	scene = small_scene_open("s.ini");
	for (size_t k = 0; k < (thorough() ? 3 : 1); k++) {
		struct fault fault;
		struct cells cells;
		struct dome dome;

		assert_int_equal(dome_create(&dome, frequencies[k], &fault), 0);
		assert_int_equal(cells_create(&cells, &dome), 0);
		/* the edge of the ball above the ground, the middle of the ball */
		check_tile(scene, &cells, what, 10, &log_sum, &log_count);
		if (thorough())
			check_tile(scene, &cells, what, 5, &log_sum, &log_count);
		cells_free(&cells);
		dome_free(&dome);
	}
	print_message("# %s: error %.3f of the mean's in all\n", what, exp(log_sum / log_count));
	assert_true(exp(log_sum / log_count) < 0.92);
	scene_close(scene);
}

TEST("diffuse")
{
	check_scene("diffuse", "colour = 0.8 0.6 0.3\n", "");
}

TEST("glossy")
{
	check_scene("glossy",
		    "kind = glossy\ncolour = 0.3 0.4 0.6\nspecular = 0.3 0.3 0.3\n"
		    "roughness = 0.3\n",
		    "");
}

TEST("standin")
{
	check_scene("stand-in", "colour = 0.8 0.6 0.3\n",
		    "[standin wall]\nfile = plane.obj\nup = z\nmaterial = m\n");
}

static int begin_group(void **state)
{
	for (int p = 0; p < TILE_PIXELS; p++)
		every_pixel[p] = (uint16_t)p;
	return small_scene_begin(state);
}

TEST_GROUP(begin_group, small_scene_end);
