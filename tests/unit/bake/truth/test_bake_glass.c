/* SPDX-License-Identifier: MIT */
/* Glass objects and stand-ins for real things: baked, composited and compared with path tracing,
 * over a background whose pattern shows where light comes from. */
#include <math.h>
#include <stdlib.h>

#include "bake/scene/scene.h"
#include "bake/tiles/sight.h"
#include "bake/truth/truth.h"
#include "hal/compositor/compositor.h"
#include "tests/support/bake/baked_rows.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define WIDTH 40
#define HEIGHT 30
#define PIXELS (WIDTH * HEIGHT)
#define SQUARE 5 /* side of the background's squares, px */

/* The picture is the same wherever the camera stands. */
#define SCENE(camera)                                                                              \
	"[camera]\n" camera "field_deg = 36\nwidth = 40\nheight = 30\n[dome]\nfrequency = 1\n"     \
	"[render]\nsamples = 64\n[ground]\n"

struct glass_comparison {
	struct basis basis;
	struct image truth;	 /* linear light */
	uint8_t out[PIXELS * 4]; /* BGRX */
	double rms, most, psnr, mean;
	int x, y; /* place of the largest difference */
};

/* Without its pattern, so that only light makes a difference. */
static bool plain_board;

static int board_code(int x, int y, int c)
{
	if (plain_board)
		return 150;
	return (x / SQUARE + y / SQUARE) % 2 ? 225 - 12 * c : 50 + 25 * ((x / SQUARE + c) % 3);
}

/* Light that is constant over each cell, so that cells approximate nothing; one holds a strong
 * lamp. */
static double light_of(int cell, int c)
{
	return 0.3 + (cell == 3 ? 2 + 0.3 * c : 0);
}

static void make_panorama(struct image *image)
{
	const int width = 256, height = 128;
	const struct panorama panorama = {.image = image, .scale = 1};
	struct fault fault = {.text = ""};
	struct dome dome;

	assert_int_equal(dome_create(&dome, 1, &fault), 0);
	assert_int_equal(image_create_f32(image, width, height), 0);
	for (int y = 0; y <= height / 2; y++)
		for (int x = 0; x < width; x++) {
			double d[3];

			/* the row below the horizon is like the one above */
			panorama_direction(&panorama, x + 0.5, fmin(y, height / 2 - 1) + 0.5, d);
			for (int c = 0; c < 3; c++)
				image->f32[3 * (y * width + x) + c] =
					(float)light_of(dome_cell_of(&dome, d), c);
		}
	dome_free(&dome);
}

static void composite(struct glass_comparison *to)
{
	static uint8_t board[PIXELS * 4];
	const struct picture picture = {board, 4, WIDTH * 4, WIDTH, HEIGHT};
	const struct backdrop backdrop = backdrop_of(&picture);
	const struct compositor_settings settings = {.background = {.named = TRANSFER_SRGB},
						     .output = {.named = TRANSFER_SRGB},
						     .gain = 1,
						     .object = true};
	const struct compositor_options options = {.pool = NULL};
	const int count = (int)to->basis.info.lights;
	float(*radiance)[3] = calloc((size_t)count, sizeof(*radiance));
	struct light_selection lights;
	struct compositor *compositor;

	assert_non_null(radiance);
	for (int i = 0; i < count; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)light_of(i, c);
	for (int i = 0; i < PIXELS; i++)
		for (int c = 0; c < 3; c++)
			board[i * 4 + 2 - c] = (uint8_t)board_code(i % WIDTH, i / WIDTH, c);
	assert_int_equal(light_selection_create(&lights, &to->basis), 0);
	light_selection_choose(&lights, &to->basis, 0, (const float(*)[3])radiance, 0,
			       THRESHOLD_AMBIENT, 1);
	assert_int_equal(compositor_create(&compositor, &to->basis, &options, NULL), 0);
	compositor_set(compositor, &settings);
	assert_int_equal(compositor_run(compositor, 0, &lights, &backdrop, to->out, WIDTH * 4), 0);
	compositor_destroy(compositor);
	light_selection_free(&lights);
	free(radiance);
}

static double true_level(const struct glass_comparison *c, int x, int y, int channel)
{
	return 255 *
	       transfer_encode(TRANSFER_SRGB, (double)c->truth.f32[3 * (y * WIDTH + x) + channel]);
}

static int level(const struct glass_comparison *c, int x, int y, int channel)
{
	return c->out[(y * WIDTH + x) * 4 + 2 - channel];
}

/* Traces NAME. Returns the noise, in levels. */
static double trace_truth(struct glass_comparison *to, const char *name)
{
	const struct truth_settings settings = {
		.samples = 384, .bounces = 8, .seed = 3, .threads = 2, .quiet = true};
	struct image image, board;
	const struct panorama panorama = {.image = &image, .scale = 1};
	struct scene *scene = small_scene_open(name);
	struct fault fault = {.text = ""};
	struct truth_report report;
	struct sky sky;

	make_panorama(&image);
	assert_int_equal(image_create_f32(&board, WIDTH, HEIGHT), 0);
	for (int i = 0; i < PIXELS; i++)
		for (int c = 0; c < 3; c++)
			board.f32[3 * i + c] = (float)transfer_decode(
				TRANSFER_SRGB, board_code(i % WIDTH, i / WIDTH, c) / 255.0);
	assert_int_equal(sky_create(&sky, &panorama, "made", &fault), 0);
	assert_int_equal(truth_run(scene, &sky, &board, &settings, &to->truth, &report, &fault), 0);
	sky_free(&sky);
	image_free(&image);
	image_free(&board);
	scene_close(scene);
	return report.noise_levels;
}

/* Bakes NAME, composites it, and traces the same scene. */
static void compare(struct glass_comparison *to, const char *name)
{
	const double noise = trace_truth(to, name);
	double square = 0;

	to->basis = small_scene_bake(name);
	composite(to);
	to->most = to->mean = 0;
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int c = 0; c < 3; c++) {
				const double off = level(to, x, y, c) - true_level(to, x, y, c);

				square += off * off / (3 * PIXELS);
				to->mean += off / (3 * PIXELS);
				if (fabs(off) > to->most) {
					to->most = fabs(off);
					to->x = x;
					to->y = y;
				}
			}
	to->rms = sqrt(square);
	to->psnr = 20 * log10(255 / to->rms);
	print_message(
		"# %s: %.1f dB, RMS %.2f levels, mean %+.3f, %.1f at most (%d, %d); truth's noise %.2f\n",
		name, to->psnr, to->rms, to->mean, to->most, to->x, to->y, noise);
}

static void compared(struct glass_comparison *c)
{
	basis_close(&c->basis);
	image_free(&c->truth);
}

static void write_box(const char *name, double x, double y, double z)
{
	small_scene_write(name,
			  "v %1$g %2$g 0\nv %4$g %2$g 0\nv %4$g %5$g 0\nv %1$g %5$g 0\n"
			  "v %1$g %2$g %3$g\nv %4$g %2$g %3$g\nv %4$g %5$g %3$g\nv %1$g %5$g %3$g\n"
			  "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
			  -x, -y, z, x, y);
}

/* ---- glass ---- */

/* Flat glass shows each pixel its own background, times the colour once for each of two surfaces.
 */
TEST("a tinted pane lets its own background through")
{
	const double tint[3] = {0.95, 0.7, 0.4};
	struct glass_comparison c;
	int whole = 0, foot = 0;

	write_box("pane.obj", 0.55, 0.04, 1.1);
	small_scene_write(
		"pane.ini",
		SCENE("position = 0.6 -3.2 1.6\nlook_at = 0 0 0.45\n") "[object pane]\n"
								       "file = pane.obj\nup = z\n"
								       "material = tint\n[material tint]\n"
								       "kind = glass\nior = 1\n"
								       "colour = 0.95 0.7 0.4\n");
	compare(&c, "pane.ini");
	for (size_t k = 0; k < c.basis.poses[0].glass_count; k++) {
		const struct basis_glass *g = &c.basis.poses[0].glass[k];
		double off = 0;

		expect_equal(g->dx, 0, "k=%zu", k);
		expect_equal(g->dy, 0, "k=%zu", k);
		if (baked_coverage(&c.basis, g->x, g->y) < 1)
			continue;
		for (int channel = 0; channel < 3; channel++)
			off = fmax(off, fabs(g->transmission[channel] / 65535.0 -
					     tint[channel] * tint[channel]));
		(off < 1e-4 ? &whole : &foot)[0]++;
	}
	/* near its foot, rays meet the ground before they leave the pane */
	assert_true(foot < 30);
	assert_true(whole > 100);
	assert_true(c.rms < 1.5);
	compared(&c);
}

/* A pane of one surface, an open mesh: it reflects 2 F / (1 + F). */
TEST("a thin pane mirrors on both sides")
{
	const double once = 0.04, both = 2 * once / (1 + once);
	struct glass_comparison c;

	small_scene_write("sheet.obj",
			  "v -0.5 0 0\nv 0.5 0 0\nv 0.5 0 1.1\nv -0.5 0 1.1\nf 1 2 3 4\n");
	small_scene_write(
		"thin.ini",
		SCENE("position = 0 -3.5 0.5\nlook_at = 0 0 0.5\n") "[object pane]\n"
								    "file = sheet.obj\nup = z\n"
								    "material = g\n[material g]\n"
								    "kind = glass\nthin = yes\n"
								    "colour = 0.9 0.9 0.9\n");
	compare(&c, "thin.ini");
	for (int channel = 0; channel < 3; channel++)
		expect_below(fabs(baked_through(&c.basis, WIDTH / 2, HEIGHT / 2, channel) -
				  0.9 * (1 - both)),
			     2e-3, "channel=%d", channel);
	assert_true(c.rms < 1.5);
	compared(&c);
}

/* A glass ball shows the background upside down. */
TEST("a ball bends the background")
{
	struct glass_comparison c;
	int below = 0;

	small_scene_write_sphere("ball.obj", 0.5, 32);
	small_scene_write(
		"ball.ini",
		SCENE("position = 0.6 -3.2 1.6\nlook_at = 0 0 0.45\n") "[object ball]\n"
								       "file = ball.obj\nup = z\n"
								       "position = 0 0 0.5\nmaterial = g\n"
								       "[material g]\nkind = glass\n"
								       "colour = 0.98 0.98 0.98\n");
	compare(&c, "ball.ini");
	for (size_t k = 0; k < c.basis.poses[0].glass_count; k++)
		below += c.basis.poses[0].glass[k].dy > 2 * BASIS_GLASS_STEP;
	assert_true(c.basis.poses[0].glass_count > 100);
	assert_true(below > 20);
	assert_true(c.psnr > 28);
	compared(&c);
}

/* ---- light through panes ---- */

/* Writes a scene of an object of glass, and of what else is given. */
static void write_glass(const char *name, const char *mesh, const char *material,
			const char *others)
{
	small_scene_write(
		name,
		SCENE("position = 0.6 -3.2 1.6\nlook_at = 0 0 0.45\n") "%s[object glass]\n"
								       "file = %s\nup = z\nmaterial = g\n"
								       "[material g]\nkind = glass\n%s\n",
		others, mesh, material);
}

static void write_panes(void)
{
	small_scene_write("sheet.obj",
			  "v -0.5 0 0\nv 0.5 0 0\nv 0.5 0 1.1\nv -0.5 0 1.1\nf 1 2 3 4\n");
	small_scene_write("roof.obj", "v -0.6 -0.6 0.7\nv 0.6 -0.6 0.7\nv 0.6 0.6 0.7\n"
				      "v -0.6 0.6 0.7\nf 1 2 3 4\n");
	write_box("box.obj", 0.5, 0.4, 0.9);
}

/* The shadow of a black ball, under each cell, is the same with an invisible pane in the light's
 * way. Truth is the background where nothing but that is in the picture. */
static void check_invisible(const char *mesh, const char *material)
{
	const char *const ball = "[object ball]\nfile = ball.obj\nup = z\nmaterial = black\n"
				 "position = 0.9 0.2 0.2\n[material black]\ncolour = 0 0 0\n";
	struct glass_comparison c;
	struct basis alone, with;
	double most = 0, off = 0;

	small_scene_write("alone.ini", SCENE("position = 0.6 -3.2 1.6\nlook_at = 0 0 0.45\n") "%s",
			  ball);
	write_glass("clear.ini", mesh, material, ball);
	alone = small_scene_bake("alone.ini");
	with = small_scene_bake("clear.ini");
	write_glass("clear.ini", mesh, material, "");
	trace_truth(&c, "clear.ini");
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int channel = 0; channel < 3; channel++) {
				double v[2][64] = {{0}};

				baked_row(&alone, x, y, BASIS_KIND_V, channel, v[0]);
				baked_row(&with, x, y, BASIS_KIND_V, channel, v[1]);
				for (uint32_t i = 0; i < alone.info.lights; i++)
					most = fmax(most, fabs(v[0][i] - v[1][i]));
				off = fmax(off, fabs(true_level(&c, x, y, channel) -
						     board_code(x, y, channel)));
			}
	print_message("# invisible %s: baked light differs by %.5f, truth by %.4f levels\n", mesh,
		      most, off);
	expect_below(most, 1e-4, "%s", mesh);
	expect_below(off, 1e-3, "%s", mesh);
	basis_close(&alone);
	basis_close(&with);
	image_free(&c.truth);
}

TEST("an invisible pane throws no shadow")
{
	write_panes();
	small_scene_write_sphere("ball.obj", 0.2, 24);
	check_invisible("roof.obj", "thin = yes\nior = 1\ncolour = 1 1 1");
	if (!thorough())
		return;
	check_invisible("sheet.obj", "thin = yes\nior = 1\ncolour = 1 1 1");
	check_invisible("box.obj", "ior = 1\ncolour = 1 1 1");
}

/* The zenith's cell, which spans 7 degrees at f = 9, through a pane over ground that is almost
 * black: what is taken is 1 - tint (1 - 2 F / (1 + F)), F = 0.04. */
TEST("a tinted roof takes by fresnel")
{
	static const double tint[3] = {0.9, 0.6, 0.3};
	struct basis basis;

	small_scene_write("roof.obj", "v -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nf 1 2 3 4\n");
	small_scene_write(
		"roof.ini",
		"[camera]\nposition = 0 -9 0.4\nlook_at = 0 0 0\nfield_deg = 0.1\n"
		"width = 3\nheight = 3\n[dome]\nfrequency = 9\n[render]\nsamples = 16\n"
		"[ground]\nmaterial = dark\n[object roof]\nfile = roof.obj\nup = z\n"
		"position = 0 0 0.7\nmaterial = g\n[material dark]\ncolour = 0.001 0.001 0.001\n"
		"[material g]\nkind = glass\nthin = yes\ncolour = 0.9 0.6 0.3\n");
	basis = small_scene_bake("roof.ini");
	for (int channel = 0; channel < 3; channel++) {
		const double want = 1 - tint[channel] * (1 - 2 * 0.04 / 1.04);
		double v[512];

		assert_true(baked_row(&basis, 1, 1, BASIS_KIND_V, channel, v));
		expect_below(fabs(v[0] - want), 2e-4, "channel=%d", channel);
		expect_below(fabs(v[405]), 2e-4, "channel=%d", channel); /* beside the roof */
	}
	basis_close(&basis);
}

/* Baked and traced light agree wherever glass lies on its way. At the outline of glass a pixel has
 * one ratio for what is beside the glass and behind it; those pixels are left out. */
static void check_shadow(const char *what, const char *mesh, const char *material,
			 const char *others, double most, double most_mean)
{
	struct glass_comparison c;
	double square = 0, sum = 0;
	int count = 0;

	write_glass("shadow.ini", mesh, material, others);
	plain_board = true;
	compare(&c, "shadow.ini");
	plain_board = false;
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int channel = 0; channel < 3; channel++) {
				const double off = level(&c, x, y, channel) -
						   true_level(&c, x, y, channel);

				if (fmod(baked_coverage(&c.basis, x, y), 1) != 0)
					continue;
				square += off * off;
				sum += off;
				count++;
			}
	print_message("# %s: RMS %.2f levels, mean %+.3f\n", what, sqrt(square / count),
		      sum / count);
	expect_below(sqrt(square / count), most, "%s", what);
	expect_below(fabs(sum / count), most_mean, "%s", what);
	compared(&c);
}

TEST("shadows of glass agree with truth")
{
	const char *const metal = "[object ball]\nfile = ball.obj\nup = z\nposition = 0 0.1 0.4\n"
				  "material = metal\n[material metal]\nkind = glossy\n"
				  "colour = 0 0 0\nspecular = 0.9 0.8 0.6\nroughness = 0.4\n";
	const char *const floor = "[standin floor]\nfile = floor.obj\nup = z\nmaterial = grey\n"
				  "position = 0 0 0.05\n[material grey]\ncolour = 0.6 0.6 0.6\n";

	write_panes();
	small_scene_write("floor.obj", "v -3 -3 0\nv 3 -3 0\nv 3 3 0\nv -3 3 0\nf 1 2 3 4\n");
	small_scene_write_sphere("ball.obj", 0.35, 24);
	/* beside noise: the mirrored lamp's border is as coarse as the panorama's texels */
	check_shadow("tinted roof over a real floor", "roof.obj",
		     "thin = yes\ncolour = 0.9 0.5 0.2", floor, 1.6, 0.2);
	/* The mean is 0.25 to 0.28 beside 1,536 samples of truth, drawn by the coat or not. */
	check_shadow("metal in a solid box", "box.obj", "colour = 0.9 0.7 0.5", metal, 5, 0.35);
	if (!thorough())
		return;
	check_shadow("box of ior 1", "box.obj", "ior = 1\ncolour = 0.9 0.7 0.5", "", 0.8, 0.2);
	check_shadow("metal behind a pane", "sheet.obj", "thin = yes\ncolour = 0.9 0.7 0.5", metal,
		     2.6, 0.2);
	check_shadow("pane", "sheet.obj", "thin = yes\ncolour = 0.9 0.9 0.9", "", 1, 0.2);
	check_shadow("tinted roof", "roof.obj", "thin = yes\ncolour = 0.9 0.5 0.2", "", 1.6, 0.2);
	check_shadow("solid ball", "ball.obj\nstand = yes", "colour = 0.98 0.98 0.98\n", "", 2.2,
		     0.2);
}

/* How much the ground's ratio under a single cell differs between two seeds. A single path through
 * the ball for each sample would make it 0.116. */
TEST("light bent by a ball has little noise")
{
	struct basis basis[2];
	double square = 0, noise;
	int count = 0;

	small_scene_write_sphere("ball.obj", 0.5, 32);
	for (int k = 0; k < 2; k++) {
		small_scene_write("seed.ini",
				  "[camera]\nposition = 0.6 -3.2 1.6\nlook_at = 0 0 0.45\n"
				  "field_deg = 36\nwidth = 40\nheight = 30\n[dome]\n"
				  "frequency = 4\n[render]\nsamples = 64\nseed = %d\n[ground]\n"
				  "[object ball]\nfile = ball.obj\nup = z\nstand = yes\n"
				  "material = g\n[material g]\nkind = glass\n",
				  k + 1);
		basis[k] = small_scene_bake("seed.ini");
	}
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			double v[2][128];

			if (baked_coverage(&basis[0], x, y) > 0)
				continue;
			for (int k = 0; k < 2; k++)
				baked_row(&basis[k], x, y, BASIS_KIND_V, 1, v[k]);
			for (uint32_t i = 0; i < basis[0].info.lights; i++, count++)
				square += (v[0][i] - v[1][i]) * (v[0][i] - v[1][i]) / 2;
		}
	noise = sqrt(square / count);
	print_message("# under a single cell, bent light has noise %.4f\n", noise);
	expect_below(noise, 0.07, "of %d", count);
	basis_close(&basis[0]);
	basis_close(&basis[1]);
}

/* ---- real things ---- */

/* A real box in front of the object hides it, and there the picture does not change; a real step
 * receives the object's shadow. */
TEST("real things hide and receive")
{
	struct glass_comparison c;
	int hidden = 0, shown = 0, dark = 0, wrong = 0;

	write_box("box.obj", 0.3, 0.2, 0.45);
	write_box("step.obj", 1.2, 0.5, 0.25);
	small_scene_write_sphere("ball.obj", 0.45, 24);
	small_scene_write(
		"real.ini",
		SCENE("position = 0.6 -3.6 1.6\nlook_at = 0 0 0.4\n") "[object ball]\n"
								      "file = ball.obj\nup = z\n"
								      "position = 0 0 0.45\nmaterial = red\n"
								      "[material red]\ncolour = 0.8 0.2 0.1\n"
								      "[standin box]\nfile = box.obj\n"
								      "up = z\nposition = -0.3 -0.9 0\n"
								      "material = grey\n[standin step]\n"
								      "file = step.obj\nup = z\n"
								      "position = 0.2 1.1 0\n"
								      "material = grey\n[material grey]\n"
								      "colour = 0.6 0.6 0.6\n");
	compare(&c, "real.ini");
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const double ratio = baked_ratio(&c.basis, x, y, 1, NULL);
			const double a = baked_coverage(&c.basis, x, y);

			shown += a == 1;
			dark += a == 0 && ratio < 0.85;
			hidden += a == 0 && ratio > 0.98;
			wrong += fabs(level(&c, x, y, 1) - true_level(&c, x, y, 1)) > 12;
		}
	assert_true(shown > 40 && dark > 20 && hidden > 300);
	assert_int_equal(wrong, 0);
	assert_true(c.rms < 2);
	compared(&c);
}

TEST_GROUP(small_scene_begin, small_scene_end);
