/* SPDX-License-Identifier: MIT */
/* Small scenes written to a temporary folder, baked, and read back in double precision. */
#ifndef INLAY_TESTS_SUPPORT_BAKING_H
#define INLAY_TESTS_SUPPORT_BAKING_H

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/tiles/render.h"
#include "hal/basis/basis.h"
#include "hal/basis/basis_layout.h"

static char baking_folder[64];

static inline int baking_begin(void **state)
{
	(void)state;
	strcpy(baking_folder, "/tmp/inlay-bake-XXXXXX");
	return mkdtemp(baking_folder) ? 0 : -1;
}

static inline int baking_end(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf '%s'", baking_folder);
	return system(command);
}

static inline const char *baking_path(const char *name)
{
	static char path[4][128];
	static int turn;
	char *out = path[turn = (turn + 1) % 4];

	snprintf(out, sizeof(path[0]), "%s/%s", baking_folder, name);
	return out;
}

__attribute__((format(printf, 2, 3))) static inline void baking_write(const char *name,
								      const char *format, ...)
{
	FILE *stream = fopen(baking_path(name), "w");
	va_list args;

	assert_non_null(stream);
	va_start(args, format);
	vfprintf(stream, format, args);
	va_end(args);
	assert_int_equal(fclose(stream), 0);
}

/* A sphere around the origin, Z up, with exact normals and outward winding. */
static inline void baking_write_sphere(const char *name, double radius, int rings)
{
	FILE *stream = fopen(baking_path(name), "w");
	const int sides = 2 * rings;

	assert_non_null(stream);
	for (int j = 0; j <= rings; j++)
		for (int i = 0; i < sides; i++) {
			const double theta = M_PI * j / rings, phi = 2 * M_PI * i / sides;
			const double n[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi),
					     cos(theta)};

			fprintf(stream, "v %.9f %.9f %.9f\nvn %.9f %.9f %.9f\n", radius * n[0],
				radius * n[1], radius * n[2], n[0], n[1], n[2]);
		}
	for (int j = 0; j < rings; j++)
		for (int i = 0; i < sides; i++) {
			const int a = j * sides + i + 1, b = j * sides + (i + 1) % sides + 1;
			const int c = a + sides, d = b + sides;

			if (j > 0)
				fprintf(stream, "f %d//%d %d//%d %d//%d\n", a, a, c, c, b, b);
			if (j < rings - 1)
				fprintf(stream, "f %d//%d %d//%d %d//%d\n", b, b, c, c, d, d);
		}
	assert_int_equal(fclose(stream), 0);
}

static inline struct scene *baking_scene(const char *name)
{
	struct fault fault = {.text = ""};
	struct scene *scene = NULL;

	if (scene_open(&scene, baking_path(name), 0, 0, &fault) < 0)
		fail_msg("%s", fault.text);
	return scene;
}

static inline struct render_report baking_render(struct scene *scene, const char *out, int threads)
{
	struct render_settings settings = render_settings_of(scene);
	struct fault fault = {.text = ""};
	struct render_report report;

	settings.threads = threads;
	settings.quiet = true;
	settings.exact = true;
	if (render_run(scene, &settings, baking_path(out), &report, &fault) < 0)
		fail_msg("%s", fault.text);
	return report;
}

/* Bakes NAME.ini, opens the result. */
static inline struct basis baking_bake(const char *name)
{
	struct fault fault = {.text = ""};
	struct scene *scene = baking_scene(name);
	struct basis basis;

	baking_render(scene, "out.inlay", 2);
	scene_close(scene);
	if (basis_open(&basis, baking_path("out.inlay"), BASIS_WITH_EXACT, &fault) < 0)
		fail_msg("%s", fault.text);
	return basis;
}

/* Adds what a block without patterns holds of its pixel number p and channel c. */
static inline void baking_add(const struct basis *basis, const struct basis_block *block, int p,
			      int c, double *out)
{
	const int channel = block->channels == 3 ? c : 0;
	const double tint = block->tint
				    ? block->tint[c * block->pixels + p] / (double)BASIS_TINT_ONE
				    : 1;

	assert_int_equal(block->patterns, 0);
	assert_int_equal(block->bits, 16);
	for (int n = 0; n < block->columns; n++) {
		const size_t panels = (size_t)basis_panels16(block->pixels);
		const size_t line = ((size_t)channel * panels + (size_t)(p / BASIS_LINE16)) *
					    (size_t)block->columns +
				    (size_t)n;
		const int i = block->light[n];

		out[i] += tint * (double)block->column_scale[n] *
			  block->column16[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)] *
			  (block->kind == BASIS_KIND_V ? 1 : basis->lights[i].solid_angle_sr);
	}
}

/* Row of a kind at a pixel and channel, from the exact layer: t, v, d or u of each light.
 * False: there is none. */
static inline bool baking_row(const struct basis *basis, int x, int y, enum basis_kind kind, int c,
			      double *out)
{
	const int tile = y / BASIS_TILE * basis->tiles_across + x / BASIS_TILE;
	const struct basis_tile *t = &basis->poses[0].exact.tiles[tile];
	const int want = y % BASIS_TILE * BASIS_TILE + x % BASIS_TILE;
	bool found = false;

	memset(out, 0, basis->info.lights * sizeof(*out));
	for (int b = 0; b < t->block_count; b++) {
		const struct basis_block *block = &t->blocks[b];

		for (int p = 0; block->kind == kind && p < block->pixels; p++)
			if (block->pixel[p] == want) {
				baking_add(basis, block, p, c, out);
				found = true;
			}
	}
	return found;
}

/* sum over i of t_i L_i; light NULL: all 1. */
static inline double baking_object(const struct basis *basis, int x, int y, int c,
				   const double *light)
{
	double row[BASIS_LIGHTS_MAX], sum = 0;

	baking_row(basis, x, y, BASIS_KIND_T, c, row);
	for (uint32_t i = 0; i < basis->info.lights; i++)
		sum += row[i] * (light ? light[i] : 1);
	return sum;
}

/* s / u, from V or from D and U. */
static inline double baking_ratio(const struct basis *basis, int x, int y, int c,
				  const double *light)
{
	static double change[BASIS_LIGHTS_MAX], own[BASIS_LIGHTS_MAX];
	const double *u = own;
	double taken = 0, all = 0;
	bool shared = false;

	if (!baking_row(basis, x, y, BASIS_KIND_D, c, change) ||
	    !baking_row(basis, x, y, BASIS_KIND_U, c, own)) {
		if (!baking_row(basis, x, y, BASIS_KIND_V, c, change))
			return 1;
		u = basis_ground(basis, 0, c);
		shared = true;
	}
	for (uint32_t i = 0; i < basis->info.lights; i++) {
		const double l = light ? light[i] : 1;

		taken += change[i] * l * (shared ? u[i] : 1);
		all += u[i] * l;
	}
	return all > 0 ? 1 - taken / all : 1;
}

/* What arrives of the background through the object. */
static inline double baking_through(const struct basis *basis, int x, int y, int c)
{
	const struct basis_pose *pose = &basis->poses[0];

	for (size_t k = 0; k < pose->glass_count; k++)
		if (pose->glass[k].x == x && pose->glass[k].y == y)
			return pose->glass[k].transmission[c] / 65535.0;
	return 0;
}

static inline double baking_coverage(const struct basis *basis, int x, int y)
{
	return basis->poses[0].coverage[(size_t)y * basis->info.width + (size_t)x] / 65535.0;
}

#endif
