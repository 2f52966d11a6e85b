/* SPDX-License-Identifier: MIT */
/* Lamps at places: a bake that knows where its pixels are, composited in integers, against the same
 * formula in double precision, and against light from afar. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/mirror/mirror_map.h"
#include "hal/optics/dome_placed.h"
#include "hal/optics/vec.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 52, HEIGHT = 36, BYTES = WIDTH * HEIGHT * 4 };

#define SCENE                                                                                      \
	"[camera]\nposition = 0.5 -2.2 1.2\nlook_at = 0 0 0.2\nfield_deg = 24\nwidth = 52\n"       \
	"height = 36\n[dome]\nfrequency = 4\n[render]\nsamples = 4\nbounces = 2\n[ground]\n"       \
	"[object box]\nfile = box.obj\nup = z\nmaterial = clay\n[material clay]\n"                 \
	"colour = 0.7 0.5 0.4\n"

/* Flat ground; and ground that has a u of its own, as a real wall stands beside. */
static const char *const scenes[] = {
	SCENE,
	SCENE "[standin wall]\nfile = wall.obj\nup = z\n",
};

/* A chrome ball, which shows the lamps' cells or what a map of the sky has. */
#define BALL(reflect)                                                                              \
	"[camera]\nposition = 0.5 -2.2 1.2\nlook_at = 0 0 0.2\nfield_deg = 24\nwidth = 52\n"       \
	"height = 36\n[dome]\nfrequency = 4\n[render]\nsamples = 4\nreflect = " reflect            \
	"\n[ground]\n[object ball]\nfile = ball.obj\nup = z\nstand = yes\nmaterial = chrome\n"     \
	"[material chrome]\nkind = glossy\ncolour = 0 0 0\nspecular = 0.9 0.9 0.9\nroughness = 0\n"

struct near_test {
	struct basis basis;
	struct lamps lamps;
	struct light_selection lights;
	uint8_t background[BYTES], out[BYTES];
};

static void near_begin(struct near_test *t, const char *scene)
{
	small_scene_write("box.obj",
			  "v -.2 -.2 0\nv .2 -.2 0\nv .2 .2 0\nv -.2 .2 0\nv -.2 -.2 .5\n"
			  "v .2 -.2 .5\nv .2 .2 .5\nv -.2 .2 .5\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\n"
			  "f 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
	small_scene_write_sphere("ball.obj", 0.25, 24);
	small_scene_write("wall.obj", "v -1 .5 0\nv 1 .5 0\nv 1 .5 1\nv -1 .5 1\nf 1 2 3 4\n");
	small_scene_write("near.ini", "%s", scene);
	memset(t, 0, sizeof(*t));
	t->basis = small_scene_bake("near.ini");
	t->lamps = (struct lamps){
		.count = 2,
		.lamp = {{{-1.8, -0.8, 2.6}, 0.1}, {{1.2, -0.6, 1.8}, 0.4}},
		.fisheye = {0.1, -0.3, 0.02},
	};
	assert_int_equal(light_selection_create(&t->lights, &t->basis), 0);
	for (int p = 0; p < BYTES; p++)
		t->background[p] = (uint8_t)(120 + p % 4 * 20 + p / 4 % 7);
}

static void near_end(struct near_test *t)
{
	light_selection_free(&t->lights);
	basis_close(&t->basis);
}

/* An even sky, of this radiance. */
static void choose(struct near_test *t, float even)
{
	const int count = (int)t->basis.info.lights;
	float(*radiance)[3] = calloc((size_t)count, sizeof(*radiance));

	assert_non_null(radiance);
	for (int i = 0; i < 3 * count; i++)
		(&radiance[0][0])[i] = even;
	light_selection_choose(&t->lights, &t->basis, 0, (const float(*)[3])radiance, 0,
			       THRESHOLD_DROP, 1);
	free(radiance);
}

static struct compositor_settings settings_of(enum compositor_mode mode)
{
	return (struct compositor_settings){.mode = mode,
					    .background = {.named = TRANSFER_SRGB},
					    .output = {.named = TRANSFER_SRGB},
					    .gain = 1,
					    .object = true};
}

static struct picture picture_of(const uint8_t *pixels)
{
	return (struct picture){pixels, 4, WIDTH * 4, WIDTH, HEIGHT};
}

static void run(struct near_test *t, const char *kernel, const struct lamps *lamps,
		enum compositor_mode mode, struct pool *pool)
{
	const struct compositor_options options = {.kernel = kernel, .lamps = lamps, .pool = pool};
	const struct picture picture = picture_of(t->background);
	const struct backdrop backdrop = backdrop_of(&picture);
	const struct compositor_settings settings = settings_of(mode);
	struct fault fault = {.text = ""};
	struct compositor *compositor;

	expect_success(compositor_create(&compositor, &t->basis, &options, &fault), &fault);
	expect_equal(compositor_lamps(compositor), lamps ? lamps->count : 0, "lamps");
	compositor_set(compositor, &settings);
	assert_int_equal(compositor_run(compositor, 0, &t->lights, &backdrop, t->out, WIDTH * 4),
			 0);
	compositor_destroy(compositor);
}

/* The picture in double precision. */
static void run_reference(struct near_test *t, enum compositor_mode mode,
			  double exact[WIDTH * HEIGHT * 3])
{
	const struct picture picture = picture_of(t->background);
	const struct compositor_settings settings = settings_of(mode);

	t->lights.lamps = &t->lamps;
	assert_int_equal(compositor_reference(&t->basis, 0, &settings, &t->lights, &picture, exact),
			 0);
}

/* The largest distance of the picture from the formula in double precision, in levels. */
static double off_reference(struct near_test *t, enum compositor_mode mode)
{
	static double exact[WIDTH * HEIGHT * 3];
	double most = 0;

	run_reference(t, mode, exact);
	for (int p = 0; p < WIDTH * HEIGHT; p++)
		for (int c = 0; c < 3; c++)
			most = fmax(most, fabs(exact[3 * p + c] - t->out[4 * p + 2 - c]));
	return most;
}

/* Turns the lamps on or off. */
static void switch_lamps(struct near_test *t, const double power[2])
{
	for (int l = 0; l < 2; l++)
		for (int c = 0; c < 3; c++)
			t->lights.lamp[l][c] = power[l] * (1 - 0.2 * c);
}

/* Powers of the lamps: both; one alone in darkness; one a million times as strong as white. In a
 * shadow that nothing else lights, small errors of the ground's light show: it is bilinear over
 * quarters of a tile, here of 25 cm. */
static const struct {
	float even;
	double power[2], levels;
} lightings[] = {{0.3F, {1.2, 0.4}, 1}, {0, {0, 0.8}, 2}, {0, {0.01, 0}, 2}, {0.2F, {3e6, 0}, 2}};

TEST("lamps at places are composited as the formula has it")
{
	static struct near_test t;

	for (size_t s = 0; s < sizeof(scenes) / sizeof(*scenes); s++) {
		near_begin(&t, scenes[s]);
		for (size_t k = 0; k < sizeof(lightings) / sizeof(*lightings); k++) {
			choose(&t, lightings[k].even);
			switch_lamps(&t, lightings[k].power);
			for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
				double off;

				run(&t, "c", &t.lamps, (enum compositor_mode)mode, NULL);
				off = off_reference(&t, (enum compositor_mode)mode);
				print_message("# scene %zu, lighting %zu, mode %d: %.2f levels\n",
					      s, k, mode, off);
				expect_below(off, lightings[k].levels,
					     "scene %zu, lighting %zu, mode %d", s, k, mode);
			}
		}
		near_end(&t);
	}
}

TEST("every kernel and any number of threads give the same bytes")
{
	static struct near_test t;
	static uint8_t first[BYTES];
	struct pool *pool;

	near_begin(&t, scenes[0]);
	choose(&t, 0.2F);
	t.lights.lamp[0][0] = t.lights.lamp[1][2] = 0.7;
	run(&t, "c", &t.lamps, COMPOSITOR_FAST, NULL);
	memcpy(first, t.out, BYTES);
	for (int k = 0; kernels_all[k]; k++)
		if (compositor_has_kernel(kernels_all[k]->name)) {
			run(&t, kernels_all[k]->name, &t.lamps, COMPOSITOR_FAST, NULL);
			expect_equal(memcmp(first, t.out, BYTES), 0, "%s", kernels_all[k]->name);
		}
	assert_int_equal(pool_create(&pool, 3), 0);
	run(&t, "auto", &t.lamps, COMPOSITOR_FAST, pool);
	expect_equal(memcmp(first, t.out, BYTES), 0, "threads");
	pool_destroy(pool);
	near_end(&t);
}

TEST("lamps that are off change no byte")
{
	static struct near_test t;
	static uint8_t without[BYTES];

	for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
		near_begin(&t, scenes[0]);
		choose(&t, 0.4F);
		run(&t, "auto", NULL, (enum compositor_mode)mode, NULL);
		memcpy(without, t.out, BYTES);
		run(&t, "auto", &t.lamps, (enum compositor_mode)mode, NULL);
		expect_equal(memcmp(without, t.out, BYTES), 0, "mode %d", mode);
		near_end(&t);
	}
}

/* Adds, at each value of the picture, factor times the compositor's level minus the true one. */
static void add_error(struct near_test *t, double factor, double error[WIDTH * HEIGHT * 3])
{
	static double exact[WIDTH * HEIGHT * 3];

	run(t, "auto", &t->lamps, COMPOSITOR_FAST, NULL);
	run_reference(t, COMPOSITOR_FAST, exact);
	for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
		error[i] += factor * (t->out[i / 3 * 4 + 2 - i % 3] - exact[i]);
}

/* Rounding of four levels makes a jump of up to 2; one more is allowed. */
TEST("switching lamps leaves no step at the edges of tiles")
{
	static struct near_test t;
	static double error[WIDTH * HEIGHT * 3];
	double most = 0; /* jump of the error */

	near_begin(&t, scenes[0]);
	choose(&t, 0.05F);
	switch_lamps(&t, (const double[]){2, 0.8});
	add_error(&t, 1, error);
	switch_lamps(&t, (const double[]){0, 0});
	add_error(&t, -1, error);
	for (int i = 0; i < WIDTH * HEIGHT * 3; i++) {
		const int x = i / 3 % WIDTH, y = i / 3 / WIDTH;

		if (x && x % BASIS_TILE == 0)
			most = fmax(most, fabs(error[i] - error[i - 3]));
		if (y && y % BASIS_TILE == 0)
			most = fmax(most, fabs(error[i] - error[i - 3 * WIDTH]));
	}
	print_message("# %.2f levels\n", most);
	expect_below(most, 2 + 1, "levels at edges");
	near_end(&t);
}

/* The same light, given to the cells as the sampler places it. */
TEST("a lamp at a kilometre is light from afar")
{
	static struct near_test t;
	static uint8_t near[BYTES];
	const double direction[3] = {-0.48, -0.36, 0.8};
	struct fault fault = {.text = ""};
	struct dome_placed *placed;
	struct dome dome;
	double weight[3];
	int to[3], facet = -1, count, most = 0;

	near_begin(&t, scenes[0]);
	choose(&t, 0.2F);
	t.lamps.count = 1;
	t.lamps.lamp[0] = (struct lamp){{-480, -360, 800}, 1};
	for (int c = 0; c < 3; c++)
		t.lights.lamp[0][c] = 0.9;
	run(&t, "auto", &t.lamps, COMPOSITOR_EXACT, NULL);
	memcpy(near, t.out, BYTES);
	assert_int_equal(dome_create(&dome, 4, &fault), 0);
	assert_int_equal(dome_placed_create(&placed, &dome), 0);
	count = dome_placed_share(placed, dome_cell_of(&dome, direction), &facet, direction, to,
				  weight);
	for (int n = 0; n < count; n++)
		for (int c = 0; c < 3; c++)
			t.lights.radiance[to[n]][c] += 0.9 * weight[n] / dome.solid_angle_sr[to[n]];
	run(&t, "auto", NULL, COMPOSITOR_EXACT, NULL);
	for (int p = 0; p < BYTES; p++)
		most = abs(near[p] - t.out[p]) > most ? abs(near[p] - t.out[p]) : most;
	expect_below(most, 2, "levels");
	dome_placed_destroy(placed);
	dome_free(&dome);
	near_end(&t);
}

/* Level of the brightest pixel that does hardly anything but mirror the sky, which such_pixel[]
 * tells of, in the light of the lamps alone. */
static int brightest(struct near_test *t, const bool such_pixel[WIDTH * HEIGHT])
{
	int most = 0;

	choose(t, 0);
	switch_lamps(t, (const double[]){1.2, 0.4});
	run(t, "auto", &t->lamps, COMPOSITOR_EXACT, NULL);
	for (int p = 0; p < WIDTH * HEIGHT; p++)
		if (such_pixel[p] && t->out[4 * p + 1] > most)
			most = t->out[4 * p + 1];
	return most;
}

/* The picture of the sky has a named lamp's light, so the lamp itself must not add it again. */
TEST("a mirror shows a named lamp by the picture of the sky alone")
{
	static bool such_pixel[WIDTH * HEIGHT];
	static int throughput[WIDTH * HEIGHT];
	static struct near_test t;
	struct fault fault = {.text = ""};
	struct mirror_map dark;
	int by_picture, by_cells;

	near_begin(&t, BALL("live"));
	for (size_t i = 0; i < t.basis.poses[0].mirror_count; i++) {
		const struct basis_mirror *m = &t.basis.poses[0].mirror[i];
		const int p = m->y * WIDTH + m->x;

		throughput[p] += m->throughput[1];
		such_pixel[p] = throughput[p] > 0.85 * 65535;
	}
	assert_int_equal(mirror_map_create(&dark, &t.basis, &fault), 0);
	t.lights.mirror = &dark;
	by_picture = brightest(&t, such_pixel);
	mirror_map_free(&dark);
	near_end(&t);
	near_begin(&t, BALL("cells"));
	by_cells = brightest(&t, such_pixel);
	print_message("# level %d where the sky is dark, %d of cells\n", by_picture, by_cells);
	expect_at_most(by_picture, 16, "level"); /* what is mirrored of the lit ground */
	expect_above(by_cells, 200, "level by cells");
	near_end(&t);
}

TEST_GROUP(small_scene_begin, small_scene_end);
