/* SPDX-License-Identifier: MIT */
#include "bake/exchange/export_blender.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* export_blender_py[]: bake/module.mk makes this header from export_blender.py. */
#include "bake/exchange/export_blender.py.h"
#include "bake/exchange/export_job.h"
#include "hal/base/json.h"

/* ---- camera ---- */

double export_camera_shift(const struct tsai_camera *camera)
{
	struct tsai_camera straight = *camera;
	double most = 0;

	straight.kappa1 = straight.kappa2 = straight.kappa3 = 0;
	straight.tangential[0] = straight.tangential[1] = 0;
	for (int y = 0; y < camera->height; y++)
		for (int x = 0; x < camera->width; x++) {
			const double px[2] = {x + 0.5, y + 0.5};
			double origin[3], dir[3], world[3], there[2];

			if (tsai_ray(camera, px, origin, dir))
				return HUGE_VAL;
			for (int k = 0; k < 3; k++)
				world[k] = origin[k] + dir[k];
			if (tsai_project(&straight, world, there))
				return HUGE_VAL;
			most = fmax(most, hypot(there[0] - px[0], there[1] - px[1]));
		}
	return most;
}

static int check_camera(const struct scene *scene, struct fault *fault)
{
	const double shift = export_camera_shift(&scene->camera);

	if (shift <= EXPORT_BLENDER_SHIFT_PX)
		return 0;
	if (isinf(shift))
		return fault_say(
			fault, -EINVAL,
			"%s: the camera's distortion leaves pixels that see nothing, expected at most %g pixels of distortion: Blender's camera has none (--radiance takes it)",
			scene->path, EXPORT_BLENDER_SHIFT_PX);
	return fault_say(
		fault, -EINVAL,
		"%s: the camera's distortion moves pixels by up to %.2f, expected at most %g: Blender's camera has no such distortion (--radiance takes it)",
		scene->path, shift, EXPORT_BLENDER_SHIFT_PX);
}

static void write_camera(struct json *json, const struct export_job *job)
{
	const struct tsai_camera *c = &job->scene->camera;
	const struct v3 eye = job->scene->eye;

	json_object_line(json, "camera");
	json_numbers(json, "size", (const double[]){c->width, c->height}, 2);
	json_numbers(json, "focal",
		     (const double[]){c->aspect * c->focal / c->pixel[0], c->focal / c->pixel[1]},
		     2);
	json_numbers(json, "centre", c->centre_px, 2);
	json_numbers(json, "position", (const double[]){eye.x, eye.y, eye.z}, 3);
	json_numbers(json, "clip", (const double[]){job->span / 1e4, job->span * 2 * EXPORT_REACH},
		     2);
	json_numbers(json, "rotation", c->rotation, 9);
	json_end(json);
}

/* ---- the rest of the scene ---- */

static void write_colour(struct json *json, const char *key, const struct rgb *colour)
{
	json_numbers(json, key, (const double[]){colour->c[0], colour->c[1], colour->c[2]}, 3);
}

static void write_material(struct json *json, const struct export_job *job, int k)
{
	const struct material *m = job->material[k];
	const struct texture *texture = m->texture;
	char name[32];

	json_object_line(json, NULL);
	json_text(json, "kind", material_kind_names[m->kind]);
	write_colour(json, "colour", &m->colour);
	write_colour(json, "specular", &m->specular);
	json_number(json, "roughness", (double)m->roughness);
	json_number(json, "ior", (double)m->ior);
	json_bool(json, "thin", m->thin);
	json_bool(json, "coloured", export_use_of(job, m).colours);
	snprintf(name, sizeof(name), "texture%d.hdr", k);
	json_text(json, "texture", texture ? name : NULL);
	if (texture) {
		json_bool(json, "clamp",
			  texture->wrap[0] == TEXTURE_CLAMP && texture->wrap[1] == TEXTURE_CLAMP);
		json_bool(json, "nearest", texture->nearest);
	}
	json_end(json);
}

static void write_ground(struct json *json, const struct export_job *job)
{
	const struct scene_ground_values *ground = &job->scene->file->ground;

	if (!ground->given) {
		json_text(json, "ground", NULL);
		return;
	}
	json_object_line(json, "ground");
	json_numbers(json, "albedo", job->scene->ground_albedo, 3);
	json_number(json, "reach", export_job_reach(job));
	json_bool(json, "round", ground->extent > 0);
	json_end(json);
}

/* Writes the array of one mesh file, or of none. */
static void write_mesh(struct json *json, const char *key, const char *file)
{
	json_line(json, key);
	if (file)
		json_text(json, NULL, file);
	json_end(json);
}

static void write_pictures(struct json *json, const struct export_job *job)
{
	static const char *const keys[] = {"object", "ground", "alone"};
	char name[16];

	json_object_line(json, "pictures");
	for (int k = 0; k < 3; k++) {
		snprintf(name, sizeof(name), "%c%%0%dd", keys[k][0], job->digits);
		json_text(json, keys[k], name);
	}
	json_text(json, "coverage", "coverage");
	json_end(json);
}

static int write_scene(const struct export_job *job, struct fault *fault)
{
	char command[512];
	struct json json;
	struct output out;
	int err = export_job_open(job, "scene.json", &out, fault);

	if (err)
		return err;
	export_job_import(job, "exr", command, sizeof(command));
	json_begin(&json, out.stream);
	json_number(&json, "bounces", job->scene->file->render.bounces);
	write_camera(&json, job);
	write_ground(&json, job);
	json_array(&json, "materials");
	for (int k = 0; k < job->material_count; k++)
		write_material(&json, job, k);
	json_end(&json);
	write_mesh(&json, "objects", job->has_objects ? "objects.obj" : NULL);
	write_mesh(&json, "standins", job->has_standins ? "standins.obj" : NULL);
	write_pictures(&json, job);
	json_text(&json, "import", command);
	json_end(&json);
	return output_commit(&out, fault);
}

static int write_script(const struct export_job *job, struct fault *fault)
{
	struct output out;
	int err = export_job_open(job, "render.py", &out, fault);

	if (err)
		return err;
	fputs(export_blender_py, out.stream);
	return output_commit(&out, fault);
}

int export_blender(const struct scene *scene, const struct dome *dome, const char *folder,
		   struct fault *fault)
{
	struct export_job job;
	int err = check_camera(scene, fault);

	if (!err)
		err = export_job_begin(&job, scene, dome, folder, true, fault);
	if (err)
		return err;
	err = write_scene(&job, fault);
	if (!err)
		err = write_script(&job, fault);
	export_job_end(&job);
	return err;
}
