/* SPDX-License-Identifier: MIT */
/* The noise that a bake declares is that of its pictures under suns: pictures of bakes with
 * different seeds differ by as much. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/scene/scene.h"
#include "hal/colour/transfer.h"
#include "tests/support/bake/baked_rows.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define WIDTH 48
#define HEIGHT 32
#define SKIES (3 * 4) /* suns of three sizes at four heights */
#define GOLDEN 0.6180339887498949

struct shown {
	double declared;
	float level[SKIES][HEIGHT][WIDTH][3];
	bool changed[HEIGHT][WIDTH];
};

static const double blue[3] = {0.8, 1, 1.25};

static double projected(const struct basis_light *light)
{
	return light->solid_angle_sr * fmax(light->direction[2], 0.05);
}

/* A sky with a sun in the cell nearest to a direction. Returns what white ground sends back. */
static double light_by_sun(const struct basis *basis, int sky, double (*light)[BASIS_LIGHTS_MAX])
{
	/* numbers of the ensemble's suns among its skies */
	const int number = sky < 8 ? sky + 2 : sky + 22;
	static const double heights_deg[] = {75, 45, 25, 10}, sizes[] = {1, 4, 16};
	const double height = heights_deg[sky % 4] * M_PI / 180,
		     azimuth = 2 * M_PI * GOLDEN * number;
	const double to[3] = {cos(height) * cos(azimuth), cos(height) * sin(azimuth), sin(height)};
	double all = 0, most = -1;
	int cell = 0;

	for (int i = 0; i < (int)basis->info.lights; i++) {
		const struct basis_light *l = &basis->lights[i];
		const double near = l->direction[0] * to[0] + l->direction[1] * to[1] +
				    l->direction[2] * to[2];

		all += projected(l);
		if (near > most) {
			most = near;
			cell = i;
		}
	}
	for (int c = 0; c < 3; c++) {
		for (int i = 0; i < (int)basis->info.lights; i++)
			light[c][i] = blue[c];
		light[c][cell] += sizes[sky / 4] * all / projected(&basis->lights[cell]);
	}
	return (blue[2] + sizes[sky / 4]) * all / M_PI;
}

static void show_sky(const struct basis *basis, int sky, struct shown *to)
{
	static double light[3][BASIS_LIGHTS_MAX];
	const double white = light_by_sun(basis, sky, light);

	for (int c = 0; c < 3; c++) {
		const double *u = basis_ground(basis, 0, c);
		double ground = 0;

		for (uint32_t i = 0; i < basis->info.lights; i++)
			ground += u[i] * light[c][i];
		for (int y = 0; y < HEIGHT; y++)
			for (int x = 0; x < WIDTH; x++) {
				const double a = baked_coverage(basis, x, y);
				const double open = 1 - a + baked_through(basis, x, y, c);
				const double ratio = baked_ratio(basis, x, y, c, light[c]);
				const double value = baked_object(basis, x, y, c, light[c]) +
						     open * ratio * ground;

				to->changed[y][x] |= a > 0 || ratio != 1;
				to->level[sky][y][x][c] =
					(float)(255 *
						transfer_encode(TRANSFER_SRGB, value / white));
			}
	}
}

static void bake(const char *material, const char *how, int frequency, int seed, struct shown *to)
{
	struct fault fault;
	struct basis basis;
	struct scene *scene;

	small_scene_write_sphere("ball.obj", 0.5, 24);
	small_scene_write("n.scene",
			  "[camera]\nposition = 1 -4 2\nlook_at = 0 0 0.4\nwidth = %d\n"
			  "height = %d\nfield_deg = 34\n[dome]\nfrequency = %d\n[render]\n%s\n"
			  "seed = %d\n[ground]\n[object a]\nfile = ball.obj\nup = z\nstand = yes\n"
			  "material = m\n[material m]\n%s\n",
			  WIDTH, HEIGHT, frequency, how, seed, material);
	scene = small_scene_open("n.scene");
	small_scene_render(scene, "n.inlay", 1);
	scene_close(scene);
	assert_int_equal(basis_open(&basis, small_scene_path("n.inlay"), BASIS_WITH_EXACT, &fault),
			 0);
	memset(to, 0, sizeof(*to));
	to->declared = basis.info.noise_levels;
	for (int sky = 0; sky < SKIES; sky++)
		show_sky(&basis, sky, to);
	basis_close(&basis);
}

/* RMS over skies, channels and changed pixels of the difference, as a share of sqrt(2). */
static double found_noise(const struct shown *a, const struct shown *b)
{
	double square = 0;
	long count = 0;

	for (int k = 0; k < SKIES * HEIGHT * WIDTH; k++) {
		const int sky = k / (HEIGHT * WIDTH), y = k / WIDTH % HEIGHT, x = k % WIDTH;

		for (int c = 0; (a->changed[y][x] || b->changed[y][x]) && c < 3; c++) {
			square +=
				pow((double)a->level[sky][y][x][c] - (double)b->level[sky][y][x][c],
				    2) /
				2;
			count++;
		}
	}
	return sqrt(square / (double)count);
}

static void compare(const char *material, const char *how, int frequency)
{
	static struct shown shown[2];
	double declared, found;

	for (int k = 0; k < 2; k++)
		bake(material, how, frequency, 11 + k, &shown[k]);
	declared = sqrt((pow(shown[0].declared, 2) + pow(shown[1].declared, 2)) / 2);
	found = found_noise(&shown[0], &shown[1]);
	print_message("# f = %d, %s, %s: declared %.2f levels, found %.2f\n", frequency, material,
		      how, declared, found);
	expect_at_least(declared / found, 0.8, "f = %d, %s, %s", frequency, material, how);
	expect_at_most(declared / found, 1.25, "f = %d, %s, %s", frequency, material, how);
}

#define COATED "kind = glossy\ncolour = 0.5 0.4 0.3\nroughness = 0.3"
#define CHROME "kind = glossy\ncolour = 0.1 0.1 0.1\nspecular = 0.8 0.8 0.8\nroughness = 0.2"

TEST("of diffuse")
{
	compare("colour = 0.6 0.5 0.4", "samples = 16", 3);
	if (!thorough())
		return;
	compare("colour = 0.6 0.5 0.4", "samples = 50", 3);
	compare("colour = 0.6 0.5 0.4", "noise = 2", 3);
}

TEST("of coats")
{
	compare(COATED, "noise = 3", 3);
	if (!thorough())
		return;
	compare(COATED, "samples = 16", 3);
	compare(CHROME, "samples = 32", 3);
}

/* Small suns: most of their noise is in bounced light, and filtered. */
TEST("of fine domes")
{
	compare(CHROME, "samples = 16", 6);
	if (!thorough())
		return;
	compare("colour = 0.6 0.5 0.4", "samples = 16", 9);
	compare(COATED, "samples = 16", 9);
}

TEST("of glass")
{
	compare("kind = glass", "samples = 16", 3);
	if (thorough())
		compare("kind = glass", "noise = 4", 3);
}

TEST_GROUP(small_scene_begin, small_scene_end);
