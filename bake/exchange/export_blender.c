/* SPDX-License-Identifier: MIT */
#include "bake/exchange/export_blender.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* export_blender_py[]: bake/module.mk makes this header from export_blender.py. */
#include "bake/exchange/export_blender.py.h"
#include "bake/exchange/export_mesh.h"

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
		return fault_say(fault, -EINVAL,
				 "%s: the camera's distortion leaves pixels that see nothing, "
				 "expected at most %g pixels of distortion: Blender's camera has "
				 "none (--radiance takes it)",
				 scene->path, EXPORT_BLENDER_SHIFT_PX);
	return fault_say(fault, -EINVAL,
			 "%s: the camera's distortion moves pixels by up to %.2f, expected at "
			 "most %g: Blender's camera has no such distortion (--radiance takes it)",
			 scene->path, shift, EXPORT_BLENDER_SHIFT_PX);
}

static void write_camera(FILE *to, const struct export_job *job)
{
	const struct tsai_camera *c = &job->scene->camera;
	const struct v3 eye = job->scene->eye;

	fprintf(to,
		"\"camera\": {\"size\": [%d, %d], \"focal\": [%.12g, %.12g], "
		"\"centre\": [%.12g, %.12g],\n"
		" \"position\": [%.9g, %.9g, %.9g], \"clip\": [%.9g, %.9g],\n \"rotation\": [",
		c->width, c->height, c->aspect * c->focal / c->pixel[0], c->focal / c->pixel[1],
		c->centre_px[0], c->centre_px[1], (double)eye.x, (double)eye.y, (double)eye.z,
		job->span / 1e4, job->span * 2 * EXPORT_REACH);
	for (int k = 0; k < 9; k++)
		fprintf(to, "%s%.17g", k ? ", " : "", c->rotation[k]);
	fputs("]},\n", to);
}

/* ---- the rest of the scene ---- */

static void write_colour(FILE *to, const char *key, const struct rgb *colour)
{
	fprintf(to, "\"%s\": [%.9g, %.9g, %.9g], ", key, (double)colour->c[0], (double)colour->c[1],
		(double)colour->c[2]);
}

static void write_json_materials(FILE *to, const struct export_job *job)
{
	fputs("\"materials\": [", to);
	for (int k = 0; k < job->material_count; k++) {
		const struct material *m = job->material[k];

		fprintf(to, "%s\n {\"kind\": \"%s\", ", k ? "," : "", material_kind_names[m->kind]);
		write_colour(to, "colour", &m->colour);
		write_colour(to, "specular", &m->specular);
		fprintf(to, "\"roughness\": %.9g, \"ior\": %.9g, \"thin\": %s, \"coloured\": %s, ",
			(double)m->roughness, (double)m->ior, m->thin ? "true" : "false",
			export_use_of(job, m).colours ? "true" : "false");
		if (m->texture)
			fprintf(to,
				"\"texture\": \"texture%d.hdr\", \"clamp\": %s, \"nearest\": %s}",
				k,
				m->texture->wrap[0] == TEXTURE_CLAMP &&
						m->texture->wrap[1] == TEXTURE_CLAMP
					? "true"
					: "false",
				m->texture->nearest ? "true" : "false");
		else
			fputs("\"texture\": null}", to);
	}
	fputs("],\n", to);
}

static void write_ground(FILE *to, const struct export_job *job)
{
	const struct scene_ground_values *ground = &job->scene->file->ground;
	const double *a = job->scene->ground_albedo;

	if (!ground->given) {
		fputs("\"ground\": null,\n", to);
		return;
	}
	fprintf(to,
		"\"ground\": {\"albedo\": [%.9g, %.9g, %.9g], \"reach\": %.9g, \"round\": %s},\n",
		a[0], a[1], a[2], export_job_reach(job), ground->extent > 0 ? "true" : "false");
}

static int write_scene(const struct export_job *job, struct fault *fault)
{
	const int d = job->digits;
	char command[512];
	struct output out;
	int err = export_job_open(job, "scene.json", &out, fault);

	if (err)
		return err;
	export_job_import(job, "exr", command, sizeof(command));
	fprintf(out.stream, "{\"bounces\": %d,\n", job->scene->file->render.bounces);
	write_camera(out.stream, job);
	write_ground(out.stream, job);
	write_json_materials(out.stream, job);
	fprintf(out.stream, "\"objects\": [%s],\n\"standins\": [%s],\n",
		job->has_objects ? "\"objects.obj\"" : "",
		job->has_standins ? "\"standins.obj\"" : "");
	fprintf(out.stream,
		"\"pictures\": {\"object\": \"o%%0%dd\", \"ground\": \"g%%0%dd\", "
		"\"alone\": \"a%%0%dd\", \"coverage\": \"coverage\"},\n",
		d, d, d);
	fprintf(out.stream, "\"import\": \"%s\"}\n", command);
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

	if (dome->shape != DOME_CELLS)
		return fault_say(fault, -ENOTSUP,
				 "%s: the lights are tents, expected cells: Blender's job knows no "
				 "others (--lights cells; --radiance takes tents)",
				 scene->path);
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
