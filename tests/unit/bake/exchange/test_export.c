/* SPDX-License-Identifier: MIT */
/* Jobs for other renderers: meshes read back, rays of the camera, and coverage. */
#include <errno.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/base/angles.h"
#include "bake/exchange/export_blender.h"
#include "bake/exchange/export_radiance.h"
#include "bake/scene/scene.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define WIDTH 24
#define HEIGHT 18
#define RAYS 4
#define FLOATS 6

static const char *const camera = "[camera]\nposition = 1 -3 1.5\nlook_at = 0 0 0.4\nwidth = 24\n"
				  "height = 18\n";
/* Barrel distortion, off centre. */
static const char *const lens =
	"[tsai]\nwidth = 24\nheight = 18\n"
	"rotation = 1 0 0 0 -0.397607437634 -0.917555625310 0 0.917555625310 -0.397607437634\n"
	"translation = 0 0.183511125062 3.349078032381\nfocal = 8\nkappa1 = -0.004\n"
	"distortion = distorts\ncentre = 13 8\npixel = 0.25 0.25\naspect = 1\n";

static struct scene *open_scene(const char *view)
{
	struct fault fault = {.text = ""};
	struct scene *scene;

	small_scene_write_sphere("ball.obj", 0.5, 12);
	small_scene_write("wall.obj", "v -2 1 0\nv 2 1 0\nv 2 1 1\nv -2 1 1\nf 1 2 3 4\n");
	small_scene_write(
		"job.scene",
		"%s[dome]\nfrequency = 1\n[ground]\nextent = 6\n[object ball]\nfile = ball.obj\n"
		"up = z\nstand = yes\nmaterial = m\n[standin wall]\nfile = wall.obj\nup = z\n"
		"[material m]\ncolour = 0.8 0.5 0.3\n",
		view);
	if (scene_open(&scene, small_scene_path("job.scene"), 0, 0, &fault))
		fail_msg("%s", fault.text);
	return scene;
}

static void export_to(const struct scene *scene, const char *folder)
{
	struct fault fault = {.text = ""};
	struct dome dome;

	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	if (export_radiance(scene, &dome, small_scene_path(folder), &fault))
		fail_msg("%s", fault.text);
	dome_free(&dome);
}

static float *read_rays(const char *name)
{
	const size_t count = (size_t)FLOATS * RAYS * RAYS * WIDTH * HEIGHT;
	FILE *stream = fopen(small_scene_path(name), "rb");
	float *rays = malloc(count * sizeof(*rays));

	assert_non_null(stream);
	assert_non_null(rays);
	assert_int_equal(fread(rays, sizeof(*rays), count, stream), count);
	assert_int_equal(fgetc(stream), EOF);
	fclose(stream);
	return rays;
}

/* Each ray is the camera's, through its lens, or empty. No ray meets two things, and each ray below
 * the horizon meets one. */
TEST("rays")
{
	struct scene *scene = open_scene(lens);
	float *object, *seen, *ground;
	long met = 0;

	export_to(scene, "rays");
	object = read_rays("rays/object.rays");
	seen = read_rays("rays/seen.rays");
	ground = read_rays("rays/ground.rays");
	for (int y = 0; y < RAYS * HEIGHT; y++)
		for (int x = 0; x < RAYS * WIDTH; x++) {
			const size_t at = (size_t)FLOATS * (size_t)(y * RAYS * WIDTH + x);
			const double px[2] = {(x + 0.5) / RAYS, (y + 0.5) / RAYS};
			double origin[3], dir[3], there[2], point[3];

			assert_int_equal(tsai_ray(&scene->camera, px, origin, dir), 0);
			assert_false(object[at + 4] != 0 && seen[at + 4] != 0);
			for (int k = 0; k < 3; k++) {
				const float sum = object[at + 3 + (size_t)k] +
						  seen[at + 3 + (size_t)k];

				if (object[at + 4] != 0 || seen[at + 4] != 0)
					assert_float_equal(sum, dir[k], 1e-6);
				point[k] = (double)ground[at + (size_t)k] +
					   2 * (double)ground[at + 3 + (size_t)k];
			}
			if (ground[at + 4] == 0)
				continue;
			met++;
			assert_int_equal(tsai_project(&scene->camera, point, there), 0);
			assert_float_equal(there[0], px[0], 1e-3);
			assert_float_equal(there[1], px[1], 1e-3);
		}
	assert_in_range(met, RAYS * RAYS * WIDTH * HEIGHT / 4, RAYS * RAYS * WIDTH * HEIGHT);
	free(object);
	free(seen);
	free(ground);
	scene_close(scene);
}

/* Coverage of a pixel is the share of its rays that meet an object. */
TEST("coverage")
{
	struct scene *scene = open_scene(camera);
	struct fault fault = {.text = ""};
	struct image coverage;
	float *object;

	export_to(scene, "cover");
	object = read_rays("cover/object.rays");
	if (image_read(small_scene_path("cover/coverage.hdr"), &coverage, &fault))
		fail_msg("%s", fault.text);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			int hits = 0;

			for (int k = 0; k < RAYS * RAYS; k++)
				hits += object[FLOATS * ((y * RAYS + k / RAYS) * RAYS * WIDTH +
							 x * RAYS + k % RAYS) +
					       4] != 0;
			assert_float_equal(coverage.f32[3 * (y * WIDTH + x)],
					   hits / (double)(RAYS * RAYS), 0.01);
		}
	image_free(&coverage);
	free(object);
	scene_close(scene);
}

/* The exported meshes are the scene's, in their places. */
TEST("meshes")
{
	const struct mesh_placement as_it_is = {.scale = 1, .crease_deg = 180};
	struct scene *scene = open_scene(camera);
	struct fault fault = {.text = ""};
	struct mesh mesh;

	export_to(scene, "mesh");
	for (int k = 0; k < 2; k++) {
		const struct mesh_part *own = &scene->meshes[k].parts[0];
		float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};

		if (mesh_read(&mesh, small_scene_path(k ? "mesh/standins.obj" : "mesh/objects.obj"),
			      &as_it_is, &fault))
			fail_msg("%s", fault.text);
		expect_equal(mesh.part_count, 1, "k=%d", k);
		expect_equal(mesh.parts[0].triangles, own->triangles, "k=%d", k);
		for (int v = 0; v < own->vertices; v++) {
			low[0] = fminf(low[0], own->position[v][2]);
			high[0] = fmaxf(high[0], own->position[v][0]);
		}
		for (int v = 0; v < mesh.parts[0].vertices; v++) {
			low[1] = fminf(low[1], mesh.parts[0].position[v][2]);
			high[1] = fmaxf(high[1], mesh.parts[0].position[v][0]);
		}
		assert_float_equal(low[0], low[1], 1e-6);
		assert_float_equal(high[0], high[1], 1e-6);
		mesh_free(&mesh);
	}
	scene_close(scene);
}

/* Coordinates of a texture that is moved are exported where it is looked up. */
TEST("placed texture")
{
	struct scene *scene = open_scene(camera);
	struct mesh_part *part = &scene->meshes[0].parts[0];
	struct texture texture = {.image = {.width = 1, .height = 1, .u8 = (uint8_t[]){9, 9, 9}}};
	char line[256];
	float u = 0, v = 0;
	FILE *stream;

	texture_prepare(&texture);
	part->uv2 = calloc((size_t)part->vertices, sizeof(*part->uv2));
	assert_non_null(part->uv2);
	part->uv2[0][0] = 0.25f;
	part->uv2[0][1] = 0.5f;
	scene->materials[0].texture = &texture;
	scene->materials[0].placed = (struct texture_use){&texture, 1, {2, 0, 0.125f, 0, 3, 0}};
	export_to(scene, "placed");
	stream = fopen(small_scene_path("placed/objects.obj"), "r");
	assert_non_null(stream);
	while (fgets(line, sizeof(line), stream) && sscanf(line, "vt %f %f", &u, &v) != 2)
		;
	fclose(stream);
	assert_float_equal(u, 0.625, 1e-6);
	assert_float_equal(v, 1.5, 1e-6);
	scene_close(scene);
}

/* Reads a file of an export whole. */
static void read_text(const char *name, char *text, size_t room)
{
	FILE *stream = fopen(small_scene_path(name), "r");

	assert_non_null(stream);
	text[fread(text, 1, room - 1, stream)] = '\0';
	fclose(stream);
}

/* Blender gets colours of vertices, and how a texture goes on beyond its edges; one that is
 * mirrored is written twice. */
TEST("blender")
{
	static uint8_t texels[] = {255, 0, 0, 0, 255, 0};
	struct scene *scene = open_scene(camera);
	struct mesh_part *part = &scene->meshes[0].parts[0];
	struct texture texture = {.image = {.width = 2, .height = 1, .u8 = texels},
				  .wrap = {TEXTURE_MIRROR, TEXTURE_MIRROR},
				  .nearest = true};
	struct fault fault = {.text = ""};
	struct image picture;
	struct dome dome;
	static char text[1 << 16];

	texture_prepare(&texture);
	part->colour = calloc((size_t)part->vertices, sizeof(*part->colour));
	assert_non_null(part->colour);
	part->colour[0][1] = 0.25f;
	scene->materials[0].texture = &texture;
	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	if (export_blender(scene, &dome, small_scene_path("blender"), &fault))
		fail_msg("%s", fault.text);
	dome_free(&dome);
	read_text("blender/scene.json", text, sizeof(text));
	assert_non_null(strstr(
		text,
		"\"coloured\": true, \"texture\": \"texture0.hdr\", \"clamp\": false, \"nearest\": true"));
	read_text("blender/objects.obj", text, sizeof(text));
	assert_non_null(strstr(text, " 0 0.25 0\nvn "));
	if (image_read(small_scene_path("blender/texture0.hdr"), &picture, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(picture.width, 4);
	assert_int_equal(picture.height, 2);
	for (int y = 0; y < 2; y++)
		for (int x = 0; x < 4; x++)
			expect_that((picture.f32[3 * (4 * y + x)] > 0) == (x == 0 || x == 3),
				    "x=%d", x);
	image_free(&picture);
	scene_close(scene);
}

/* The exported angles read back as the same dome. */
TEST("angles")
{
	struct scene *scene = open_scene(camera);
	struct fault fault = {.text = ""};
	struct dome dome;
	int *light;

	export_to(scene, "angles");
	if (angles_read(small_scene_path("angles/angles.txt"), &dome, &light, &fault))
		fail_msg("%s", fault.text);
	assert_int_equal(dome.count, 6);
	for (int k = 0; k < dome.count; k++)
		expect_equal(light[k], k, "k=%d", k);
	free(light);
	dome_free(&dome);
	scene_close(scene);
}

/* Solid angle of all suns in a light's file. */
static double suns_sr(const char *path)
{
	FILE *stream = fopen(path, "r");
	char line[256];
	double sum = 0, x, y, z, angle_deg;

	assert_non_null(stream);
	while (fgets(line, sizeof(line), stream))
		if (sscanf(line, "cell source %*s 0 0 4 %lf %lf %lf %lf", &x, &y, &z, &angle_deg) ==
		    4)
			sum += 2 * M_PI * (1 - cos(angle_deg / 2 * M_PI / 180));
	fclose(stream);
	return sum;
}

/* The suns of a light have its solid angle together. */
TEST("suns")
{
	struct scene *scene = open_scene(camera);
	struct fault fault = {.text = ""};
	struct dome dome;

	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	expect_success(export_radiance(scene, &dome, small_scene_path("suns"), &fault), &fault);
	expect_below(
		fabs(suns_sr(small_scene_path("suns/light003.rad")) / dome.solid_angle_sr[3] - 1),
		1e-6, "light 3");
	dome_free(&dome);
	scene_close(scene);
}

/* A lens without distortion, one with a known distortion, and one that Blender does not have. */
TEST("shift")
{
	struct scene *scene = open_scene(lens);
	struct tsai_camera straight = scene->camera;
	struct fault fault = {.text = ""};
	/* the upper left pixel is the farthest: 12.5 by 9.5 px of 0.25 units */
	const double radius = 0.25 * hypot(12.5, 9.5);
	double undistorted, expected;
	struct dome dome;

	straight.kappa1 = 0;
	assert_float_equal(export_camera_shift(&straight), 0, 1e-9);
	assert_int_equal(tsai_straight_radius(scene->camera.kappa1, radius, &undistorted), 0);
	expected = (undistorted - radius) / 0.25;
	assert_float_equal(export_camera_shift(&scene->camera), expected, 1e-6);
	assert_true(expected > EXPORT_BLENDER_SHIFT_PX);
	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	assert_int_equal(export_blender(scene, &dome, small_scene_path("no"), &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "moves pixels by up to"));
	assert_int_equal(access(small_scene_path("no"), F_OK), -1);
	dome_free(&dome);
	scene_close(scene);
}

TEST("no polished floor")
{
	struct fault fault = {.text = ""};
	struct scene *scene;
	struct dome dome;

	small_scene_write_sphere("ball.obj", 0.5, 12);
	small_scene_write("polished.scene",
			  "%s[ground]\nmaterial = m\n[object ball]\nfile = ball.obj\n"
			  "[material m]\nkind = glossy\n",
			  camera);
	scene = small_scene_open("polished.scene");
	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	assert_int_equal(export_radiance(scene, &dome, small_scene_path("no"), &fault), -ENOTSUP);
	assert_non_null(strstr(fault.text, "[ground] material: glossy, expected a diffuse one"));
	assert_int_equal(access(small_scene_path("no"), F_OK), -1);
	dome_free(&dome);
	scene_close(scene);
}

TEST_GROUP(small_scene_begin, small_scene_end);
