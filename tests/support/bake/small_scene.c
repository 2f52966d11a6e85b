/* SPDX-License-Identifier: MIT */
#include "tests/support/bake/small_scene.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char small_scene_folder[64];

int small_scene_begin(void **state)
{
	(void)state;
	strcpy(small_scene_folder, "/tmp/inlay-bake-XXXXXX");
	return mkdtemp(small_scene_folder) ? 0 : -1;
}

int small_scene_end(void **state)
{
	char command[128];

	(void)state;
	snprintf(command, sizeof(command), "rm -rf '%s'", small_scene_folder);
	return system(command);
}

const char *small_scene_path(const char *name)
{
	static char path[4][128];
	static int turn;
	char *out = path[turn = (turn + 1) % 4];

	snprintf(out, sizeof(path[0]), "%s/%s", small_scene_folder, name);
	return out;
}

void small_scene_write(const char *name, const char *format, ...)
{
	FILE *stream = fopen(small_scene_path(name), "w");
	va_list args;

	assert_non_null(stream);
	va_start(args, format);
	vfprintf(stream, format, args);
	va_end(args);
	assert_int_equal(fclose(stream), 0);
}

void small_scene_write_sphere(const char *name, double radius, int rings)
{
	FILE *stream = fopen(small_scene_path(name), "w");
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

struct scene *small_scene_open(const char *name)
{
	struct fault fault = {.text = ""};
	struct scene *scene = NULL;

	if (scene_open(&scene, small_scene_path(name), 0, 0, &fault) < 0)
		fail_msg("%s", fault.text);
	return scene;
}

struct render_report small_scene_render(struct scene *scene, const char *out, int threads)
{
	struct render_settings settings = render_settings_of(scene);
	struct fault fault = {.text = ""};
	struct render_report report;

	settings.threads = threads;
	settings.quiet = true;
	settings.exact = true;
	if (render_run(scene, &settings, small_scene_path(out), &report, &fault) < 0)
		fail_msg("%s", fault.text);
	return report;
}

struct basis small_scene_bake(const char *name)
{
	struct fault fault = {.text = ""};
	struct scene *scene = small_scene_open(name);
	struct basis basis;

	small_scene_render(scene, "out.inlay", 2);
	scene_close(scene);
	if (basis_open(&basis, small_scene_path("out.inlay"), BASIS_WITH_EXACT, &fault) < 0)
		fail_msg("%s", fault.text);
	return basis;
}
