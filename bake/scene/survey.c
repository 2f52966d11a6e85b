/* SPDX-License-Identifier: MIT */
#include "bake/scene/survey.h"

#include <errno.h>
#include <string.h>

#include "hal/base/log.h"

/* The survey is to take a moment only: it sends at most this many rays through the picture, and
 * tries at most this many triangles of a mesh that they missed. */
#define RAYS_MOST 65536
#define TRIES_MOST 4096
#define GLASS_MAX 32 /* a ray passes at most this many surfaces of glass */
/* The winding number around a camera inside a closed mesh is 1, or -1; the tenth is for small
 * holes. */
#define INSIDE_LEAST 0.9
/* Objects are warned of if more than this share of their height is below the ground. */
#define SUNK_MUCH 0.5

static int mesh_number(const struct scene *scene, const struct mesh *mesh)
{
	return (int)(mesh - scene->meshes);
}

/* Marks the meshes that are seen through a point of the picture. */
static void find_visible(const struct scene *scene, double x, double y,
			 bool visible[SCENE_MESHES_MAX])
{
	struct v3 direction;
	struct surface s;
	bool met = scene_look(scene, WITH_OBJECTS, x, y, &s, &direction);

	memset(visible, 0, SCENE_MESHES_MAX * sizeof(*visible));
	for (int k = 0; met && s.mesh && k < GLASS_MAX; k++) {
		visible[mesh_number(scene, s.mesh)] = true;
		if (s.bsdf.kind != MATERIAL_GLASS)
			break;
		met = world_nearest(scene->world, WITH_OBJECTS, surface_leave(&s, direction),
				    direction, &s);
	}
}

static void count_pixels(const struct scene *scene, struct survey_mesh *mesh)
{
	const int width = scene->camera.width, height = scene->camera.height;
	bool visible[SCENE_MESHES_MAX];
	int step = 1, rays = 0;

	while ((width / step + 1) * (height / step + 1) > RAYS_MOST)
		step++;
	for (int y = 0; y < height; y += step)
		for (int x = 0; x < width; x += step, rays++) {
			find_visible(scene, fmin(x + 0.5 * step, width - 0.5),
				     fmin(y + 0.5 * step, height - 0.5), visible);
			for (int k = 0; k < scene->file->mesh_count; k++)
				mesh[k].share += visible[k];
		}
	for (int k = 0; k < scene->file->mesh_count; k++)
		mesh[k].share /= rays;
}

/* Tells whether a ray to the middle of a triangle of mesh k meets the mesh. */
static bool is_triangle_seen(const struct scene *scene, int k, const struct mesh_part *part, int t)
{
	const struct v3 sum = v3_add(v3_add(mesh_corner(part, t, 0), mesh_corner(part, t, 1)),
				     mesh_corner(part, t, 2));
	const double middle[3] = {(double)sum.x / 3, (double)sum.y / 3, (double)sum.z / 3};
	bool visible[SCENE_MESHES_MAX];
	double at[2];

	if (tsai_project(&scene->camera, middle, at) < 0 || !(at[0] >= 0) || !(at[1] >= 0) ||
	    at[0] >= scene->camera.width || at[1] >= scene->camera.height)
		return false;
	find_visible(scene, at[0], at[1], visible);
	return visible[k];
}

/* Tells whether any part of mesh k is seen, by rays to its triangles. */
static bool is_seen(const struct scene *scene, int k)
{
	const struct mesh *mesh = &scene->meshes[k];

	for (int p = 0; p < mesh->part_count; p++) {
		const int step = mesh->parts[p].triangles / TRIES_MOST + 1;

		for (int t = 0; t < mesh->parts[p].triangles; t += step)
			if (is_triangle_seen(scene, k, &mesh->parts[p], t))
				return true;
	}
	return false;
}

/*
 * Returns the mesh's winding number around the camera: the sum of its triangles' solid angles over
 * 4 pi. With a, b, c from the camera to the corners (van Oosterom and Strackee 1983),
 *     tan(angle / 2) = a . (b x c) / (|a||b||c| + (a . b)|c| + (b . c)|a| + (c . a)|b|)
 */
static double winding(const struct mesh *mesh, struct v3 eye)
{
	double sum = 0;

	for (int p = 0; p < mesh->part_count; p++)
		for (int t = 0; t < mesh->parts[p].triangles; t++) {
			const struct v3 a = v3_sub(mesh_corner(&mesh->parts[p], t, 0), eye);
			const struct v3 b = v3_sub(mesh_corner(&mesh->parts[p], t, 1), eye);
			const struct v3 c = v3_sub(mesh_corner(&mesh->parts[p], t, 2), eye);
			const float la = v3_length(a), lb = v3_length(b), lc = v3_length(c);

			sum += 2 * atan2((double)v3_dot(a, v3_cross(b, c)),
					 (double)(la * lb * lc + v3_dot(a, b) * lc +
						  v3_dot(b, c) * la + v3_dot(c, a) * lb));
		}
	return sum / (4 * M_PI);
}

static void measure(const struct scene *scene, const struct mesh *mesh, struct survey_mesh *to)
{
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};

	for (int p = 0; p < mesh->part_count; p++)
		for (int v = 0; v < mesh->parts[p].vertices; v++)
			for (int axis = 0; axis < 3; axis++) {
				const double at = (double)mesh->parts[p].position[v][axis];

				low[axis] = fmin(low[axis], at);
				high[axis] = fmax(high[axis], at);
			}
	for (int axis = 0; axis < 3; axis++)
		to->size[axis] = high[axis] - low[axis];
	if (world_has_ground(scene->world) && low[2] < 0)
		to->sunk = high[2] <= 0 ? 1 : -low[2] / to->size[2];
	to->inside = winding(mesh, scene->eye) > INSIDE_LEAST;
}

void survey_scene(const struct scene *scene, struct survey_mesh mesh[SCENE_MESHES_MAX])
{
	const double pixels = (double)scene->camera.width * scene->camera.height;

	for (int k = 0; k < SCENE_MESHES_MAX; k++)
		mesh[k] = (struct survey_mesh){.share = 0};
	count_pixels(scene, mesh);
	for (int k = 0; k < scene->file->mesh_count; k++) {
		measure(scene, &scene->meshes[k], &mesh[k]);
		if (mesh[k].share == 0 && is_seen(scene, k))
			mesh[k].share = 1 / pixels;
	}
}

static void say_object(const char *name, const struct survey_mesh *object, FILE *to)
{
	fprintf(to, "%s: %.4g x %.4g x %.4g world units, %.3g %% of the picture", name,
		object->size[0], object->size[1], object->size[2], 100 * object->share);
	if (object->sunk > 0)
		fprintf(to, ", %.0f %% of its height below the ground", 100 * object->sunk);
	fputs("\n", to);
}

static void warn_of_object(const char *path, const char *name, const struct survey_mesh *object)
{
	if (object->inside)
		log_warning(
			"%s: [object %s]: the camera is inside of it, expected it outside: look at [camera], and at position and scale",
			path, name);
	else if (object->share == 0)
		log_warning("%s: [object %s]: nothing of it is seen in the picture", path, name);
	if (object->sunk >= SUNK_MUCH)
		log_warning(
			"%s: [object %s]: %.0f %% of its height is below the ground; stand = yes puts it onto the ground",
			path, name, 100 * object->sunk);
}

int survey_say(const struct scene *scene, FILE *to, struct fault *fault)
{
	const struct scene_file *file = scene->file;
	struct survey_mesh mesh[SCENE_MESHES_MAX];
	int objects = 0, visible = 0;

	survey_scene(scene, mesh);
	for (int k = 0; k < file->mesh_count; k++) {
		if (file->mesh[k].standin)
			continue;
		objects++;
		visible += mesh[k].share > 0;
		if (to)
			say_object(file->mesh[k].name, &mesh[k], to);
	}
	if (objects && !visible)
		return fault_say(
			fault, -ENODATA,
			"%s: the camera sees no object; expected one in the picture: look at [camera], and at position, scale and up of [object]",
			scene->path);
	for (int k = 0; k < file->mesh_count; k++)
		if (!file->mesh[k].standin)
			warn_of_object(scene->path, file->mesh[k].name, &mesh[k]);
	return 0;
}
