/* SPDX-License-Identifier: MIT */
#include "bake/exchange/export_job.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "bake/base/angles.h"
#include "hal/base/log.h"

int export_job_open(const struct export_job *job, const char *name, struct output *out,
		    struct fault *fault)
{
	char path[PATH_MAX];

	if (snprintf(path, sizeof(path), "%s/%s", job->folder, name) >= (int)sizeof(path))
		return fault_say(fault, -ENAMETOOLONG, "%s: the name is too long", job->folder);
	return output_open(out, path, fault);
}

double export_job_reach(const struct export_job *job)
{
	const struct scene_ground_values *ground = &job->scene->file->ground;

	if (!ground->given)
		return job->span;
	return ground->extent > 0 ? ground->extent : job->span * EXPORT_REACH;
}

void export_job_import(const struct export_job *job, const char *ending, char *text, size_t room)
{
	const int d = job->digits;

	snprintf(
		text, room,
		"inlay-bake import --angles angles.txt --object 'o%%0%dd.%s' --ground 'g%%0%dd.%s' --alone 'a%%0%dd.%s' --coverage coverage.%s -o out.inlay",
		d, ending, d, ending, d, ending, ending);
}

/* Every job has this file: it marks a folder as an earlier export. */
#define ANGLES "angles.txt"

/* 0 if the folder is empty or an earlier export, which this one replaces. */
static int check_job_folder(const char *folder, struct fault *fault)
{
	DIR *const open = opendir(folder);
	bool empty = true, job = false;
	const struct dirent *entry;

	if (!open)
		return fault_say(fault, -errno, "%s: cannot be opened: %s, expected a folder",
				 folder, strerror(errno));
	while ((entry = readdir(open)) != NULL) {
		empty &= !strcmp(entry->d_name, ".") || !strcmp(entry->d_name, "..");
		job |= !strcmp(entry->d_name, ANGLES);
	}
	closedir(open);
	if (empty || job)
		return 0;
	return fault_say(
		fault, -ENOTEMPTY,
		"%s: has other files in it, expected a new folder, an empty one, or one with the " ANGLES
		" of an earlier export, which is written over",
		folder);
}

static int make_job_folder(const char *folder, struct fault *fault)
{
	if (mkdir(folder, 0777) == 0)
		return 0;
	if (errno != EEXIST)
		return fault_say(fault, -errno, "%s: cannot be made: %s", folder, strerror(errno));
	return check_job_folder(folder, fault);
}

static int write_angles(const struct export_job *job, struct fault *fault)
{
	struct output out;
	int err = export_job_open(job, ANGLES, &out, fault);

	if (err)
		return err;
	angles_write(out.stream, job->dome);
	return output_commit(&out, fault);
}

/* ---- materials ---- */

static int write_job_texture(const struct export_job *job, int number, struct fault *fault)
{
	const struct material *material = job->material[number];
	const enum texture_wrap *wrap = material->texture->wrap;
	const struct image *from = &material->texture->image;
	const int width = from->width, height = from->height;
	const int top = wrap[1] == TEXTURE_MIRROR ? height
						  : 0; /* rows that the mirrored ones take */
	char path[PATH_MAX];
	struct image to;
	int err = image_create_f32(&to, width << (wrap[0] == TEXTURE_MIRROR), height + top);

	if (err)
		return fault_say(fault, err, "%s: out of memory", job->folder);
	for (size_t k = 0; k < 3 * (size_t)to.width * (size_t)to.height; k++) {
		const int x = (int)(k / 3 % (size_t)to.width), y = (int)(k / 3 / (size_t)to.width);
		const size_t across = (size_t)(x < width ? x : 2 * width - 1 - x);
		const size_t down = (size_t)(y < top ? top - 1 - y : y - top);
		const size_t at = 3 * (down * (size_t)width + across) + k % 3;
		const float value = from->f32 ? from->f32[at]
					      : material->texture->decode[from->u8[at]];

		to.f32[k] = fminf(value * material->colour.c[k % 3], 1);
	}
	if (snprintf(path, sizeof(path), "%s/texture%d.hdr", job->folder, number) >=
	    (int)sizeof(path))
		err = fault_say(fault, -ENAMETOOLONG, "%s: the name is too long", job->folder);
	else
		err = image_write(path, &to, fault);
	image_free(&to);
	return err;
}

static int write_job_textures(const struct export_job *job, struct fault *fault)
{
	int err = 0;

	for (int k = 0; !err && k < job->material_count; k++)
		if (job->material[k]->texture)
			err = write_job_texture(job, k, fault);
	return err;
}

static int write_meshes(const struct export_job *job, bool standins, const char *name,
			struct fault *fault)
{
	struct output out;
	int err = export_job_open(job, name, &out, fault);

	if (err)
		return err;
	export_meshes(job, standins, out.stream);
	return output_commit(&out, fault);
}

/* ---- the scene ---- */

static double mesh_reach(const struct mesh *mesh)
{
	double most = 0;

	for (int k = 0; k < mesh->part_count; k++) {
		const struct mesh_part *part = &mesh->parts[k];

		for (int v = 0; v < part->vertices; v++) {
			const float *p = part->position[v];

			most = fmax(most, sqrt((double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2])));
		}
	}
	return most;
}

static void survey_scene(struct export_job *job)
{
	const struct scene *scene = job->scene;

	job->span = (double)v3_length(scene->eye);
	for (int k = 0; k < scene->file->mesh_count; k++) {
		job->span = fmax(job->span, mesh_reach(&scene->meshes[k]));
		*(scene->file->mesh[k].standin ? &job->has_standins : &job->has_objects) = true;
	}
	job->digits = snprintf(NULL, 0, "%d", job->dome->count - 1);
	job->digits = job->digits < 3 ? 3 : job->digits;
}

/* Warns of what pictures cannot hold, and of what no job tells its renderer. */
static void say_what_is_lost(const struct export_job *job)
{
	bool glass = false, metal = false, fine = false, colours = false, edges = false;

	for (int k = 0; k < job->material_count; k++) {
		const struct material *m = job->material[k];
		const struct export_use use = export_use_of(job, m);
		const bool clamp[2] = {m->texture && m->texture->wrap[0] == TEXTURE_CLAMP,
				       m->texture && m->texture->wrap[1] == TEXTURE_CLAMP};

		colours |= use.colours && !(job->for_blender && rgb_peak(m->metal) <= 0);
		edges |= use.beyond &&
			 (job->for_blender ? clamp[0] != clamp[1] : clamp[0] || clamp[1]);
		glass |= m->kind == MATERIAL_GLASS;
		fine |= m->map.use.texture || m->bumps.texture || m->alpha_mode != ALPHA_OPAQUE;
		metal |= m->kind == MATERIAL_GLOSSY && m->texture && rgb_peak(m->metal) > 0;
	}
	if (glass)
		log_warning(
			"%s: what is seen through glass will be the scene's own surfaces, as they are in the pictures; render shows the background's picture there",
			job->scene->path);
	if (fine)
		log_warning(
			"%s: textures of roughness and metalness (their means are kept), bumps and alpha are left out",
			job->scene->path);
	if (colours)
		log_warning("%s: colours of vertices%s are left out", job->scene->path,
			    job->for_blender ? " of a metal" : "");
	if (edges)
		log_warning("%s: a texture that does not repeat%s repeats", job->scene->path,
			    job->for_blender ? " in one direction" : "");
	if (metal)
		log_warning("%s: the texture of a metal is left out", job->scene->path);
}

int export_job_begin(struct export_job *job, const struct scene *scene, const struct dome *dome,
		     const char *folder, bool for_blender, struct fault *fault)
{
	int err;

	*job = (struct export_job){
		.scene = scene, .dome = dome, .folder = folder, .for_blender = for_blender};
	survey_scene(job);
	if (!scene->file->ground.given && !job->has_standins)
		return fault_say(
			fault, -EINVAL,
			"%s: no [ground] and no [standin], expected something real that pictures can show",
			scene->path);
	if (world_ground_bsdf(scene->world)->kind != MATERIAL_DIFFUSE)
		return fault_say(
			fault, -ENOTSUP,
			"%s: [ground] material: glossy, expected a diffuse one, or a [standin]: the exported ground has no coat",
			scene->path);
	err = make_job_folder(folder, fault);
	if (!err)
		err = export_materials(job, fault);
	if (!err)
		say_what_is_lost(job);
	if (!err)
		err = write_angles(job, fault);
	if (!err)
		err = write_job_textures(job, fault);
	if (!err && job->has_objects)
		err = write_meshes(job, false, "objects.obj", fault);
	if (!err && job->has_standins)
		err = write_meshes(job, true, "standins.obj", fault);
	if (err)
		export_job_end(job);
	return err;
}

void export_job_end(struct export_job *job)
{
	free(job->material);
	*job = (struct export_job){.material = NULL};
}
