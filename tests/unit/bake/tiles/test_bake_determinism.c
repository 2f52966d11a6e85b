/* SPDX-License-Identifier: MIT */
/* The same scene and seed give the same file, byte by byte, with any number of threads. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/scene/scene.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define WIDTH (thorough() ? 70 : 40)
#define HEIGHT (thorough() ? 50 : 32)

static char *read_all(const char *name, size_t *bytes)
{
	FILE *stream = fopen(small_scene_path(name), "rb");
	char *data = malloc(8 << 20);

	assert_non_null(stream);
	assert_non_null(data);
	*bytes = fread(data, 1, 8 << 20, stream);
	assert_true(*bytes > 4096 && *bytes < 8 << 20);
	fclose(stream);
	return data;
}

static bool same(const char *a, const char *b)
{
	size_t bytes_a, bytes_b;
	char *data_a = read_all(a, &bytes_a), *data_b = read_all(b, &bytes_b);
	const bool equal = bytes_a == bytes_b && !memcmp(data_a, data_b, bytes_a);

	free(data_a);
	free(data_b);
	return equal;
}

static void write_scene(const char *name, const char *how, int seed)
{
	small_scene_write_sphere("ball.obj", 0.5, 12);
	small_scene_write("wall.obj", "v -2 1 0\nv 2 1 0\nv 2 1 2\nv -2 1 2\nf 1 2 3 4\n");
	small_scene_write(
		name,
		"[camera]\nposition = 1 -4 2\nlook_at = 0 0 0.4\nwidth = %d\nheight = %d\n"
		"[dome]\nfrequency = 3\n[render]\n%s\nseed = %d\n[ground]\n[standin wall]\n"
		"file = wall.obj\nup = z\n[object a]\nfile = ball.obj\nup = z\nmaterial = g\n"
		"stand = yes\n[object b]\nfile = ball.obj\nposition = 1 0 0.5\nmaterial = c\n"
		"scale = 0.6\n[material g]\nkind = glossy\n[material c]\nkind = glass\n",
		WIDTH, HEIGHT, how, seed);
}

static void bake(const char *scene_name, const char *out, int threads)
{
	struct scene *scene = small_scene_open(scene_name);

	small_scene_render(scene, out, threads);
	scene_close(scene);
}

TEST("threads")
{
	write_scene("a.ini", "samples = 3", 5);
	bake("a.ini", "1.inlay", 1);
	bake("a.ini", "3.inlay", 3);
	bake("a.ini", "7.inlay", 7);
	assert_true(same("1.inlay", "3.inlay"));
	assert_true(same("1.inlay", "7.inlay"));
}

/* A bake of enough camera rays to have a cache. */
TEST("cache")
{
	write_scene("c.ini", thorough() ? "samples = 64" : "samples = 16", 5);
	bake("c.ini", "c1.inlay", 1);
	bake("c.ini", "c3.inlay", 3);
	assert_true(same("c1.inlay", "c3.inlay"));
	write_scene("c.ini", thorough() ? "samples = 64\ncache = no" : "samples = 16\ncache = no",
		    5);
	bake("c.ini", "c0.inlay", 3);
	assert_false(same("c1.inlay", "c0.inlay"));
}

TEST("noise mode")
{
	write_scene("n.ini", "noise = 5", 5);
	bake("n.ini", "n1.inlay", 1);
	bake("n.ini", "n4.inlay", 4);
	assert_true(same("n1.inlay", "n4.inlay"));
}

TEST("seed")
{
	write_scene("a.ini", "samples = 2", 5);
	write_scene("b.ini", "samples = 2", 6);
	bake("a.ini", "a.inlay", 2);
	bake("b.ini", "b.inlay", 2);
	assert_false(same("a.inlay", "b.inlay"));
}

TEST("failure leaves nothing")
{
	struct scene *scene;
	struct render_settings settings;
	struct render_report report;
	struct fault fault = {.text = ""};

	write_scene("a.ini", "samples = 1", 1);
	scene = small_scene_open("a.ini");
	settings = render_settings_of(scene);
	settings.quiet = true;
	assert_true(render_run(scene, &settings, small_scene_path("no/such/folder.inlay"), &report,
			       &fault) < 0);
	assert_non_null(strstr(fault.text, "folder.inlay"));
	scene_close(scene);
}

TEST_GROUP(small_scene_begin, small_scene_end);
