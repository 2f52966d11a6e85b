/* SPDX-License-Identifier: MIT */
#include "bake/exchange/export_job.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The scene's material in place of a mesh's own, or NULL. */
static const struct material *named_material(const struct scene *scene, int mesh)
{
	const char *name = scene->file->mesh[mesh].material;

	return name[0] ? &scene->materials[scene_file_material(scene->file, name) -
					   scene->file->material]
		       : NULL;
}

int export_materials(struct export_job *job, struct fault *fault)
{
	const struct scene *scene = job->scene;
	size_t room = (size_t)scene->file->material_count + 1;
	int count = 0;

	for (int k = 0; k < scene->file->mesh_count; k++)
		room += (size_t)scene->meshes[k].material_count;
	job->material = calloc(room, sizeof(*job->material));
	if (!job->material)
		return fault_say(fault, -ENOMEM, "%s: out of memory", job->folder);
	for (int k = 0; k < scene->file->material_count; k++)
		job->material[count++] = &scene->materials[k];
	for (int k = 0; k < scene->file->mesh_count; k++)
		if (!named_material(scene, k))
			for (int m = 0; m < scene->meshes[k].material_count; m++)
				job->material[count++] = &scene->meshes[k].materials[m];
	job->material_count = count;
	return 0;
}

static int material_number(const struct export_job *job, const struct material *material)
{
	int k = 0;

	while (job->material[k] != material)
		k++;
	return k;
}

/* Finds where the colour's texture is looked up at a vertex; 0 where there are no coordinates. */
static void find_coordinates(const struct mesh_part *part, const struct material *material, int v,
			     float uv[2])
{
	struct material_point point = {.alpha = 1};

	for (int axis = 0; axis < 2; axis++) {
		point.uv[0][axis] = part->uv ? part->uv[v][axis] : 0;
		point.uv[1][axis] = part->uv2 ? part->uv2[v][axis] : 0;
		uv[axis] = point.uv[0][axis];
	}
	if (material->placed.texture)
		texture_use_place(&material->placed, &point, uv);
}

struct export_use export_use_of(const struct export_job *job, const struct material *material)
{
	const struct scene *scene = job->scene;
	struct export_use use = {.colours = false};

	for (int k = 0; k < scene->file->mesh_count; k++) {
		const struct material *named = named_material(scene, k);

		for (int p = 0; p < scene->meshes[k].part_count; p++) {
			const struct mesh_part *part = &scene->meshes[k].parts[p];

			if ((named ? named : &scene->meshes[k].materials[part->material]) !=
			    material)
				continue;
			use.colours |= part->colour != NULL;
			for (int v = 0; v < part->vertices && material->texture; v++) {
				float uv[2];

				find_coordinates(part, material, v, uv);
				use.beyond |= fminf(uv[0], uv[1]) < -1e-3f ||
					      fmaxf(uv[0], uv[1]) > 1 + 1e-3f;
			}
		}
	}
	return use;
}

/* Writes one part of a mesh. first: number of vertices written before. Returns the number
 * afterwards. */
static long write_part(const struct export_job *job, FILE *to, const struct mesh_part *part,
		       const struct material *material, long first)
{
	fprintf(to, "usemtl m%d\n", material_number(job, material));
	for (int v = 0; v < part->vertices; v++) {
		const float *p = part->position[v];
		const struct v3 n = part->normal[v];
		float uv[2];

		find_coordinates(part, material, v, uv);
		for (int axis = 0; axis < 2 && material->texture; axis++)
			if (material->texture->wrap[axis] == TEXTURE_MIRROR)
				uv[axis] /= 2;
		fprintf(to, "v %.9g %.9g %.9g", (double)p[0], (double)p[1], (double)p[2]);
		if (job->for_blender && part->colour)
			for (int c = 0; c < 3; c++)
				fprintf(to, " %.6g", (double)part->colour[v][c]);
		fprintf(to, "\nvn %.6g %.6g %.6g\nvt %.9g %.9g\n", (double)n.x, (double)n.y,
			(double)n.z, (double)uv[0], (double)uv[1]);
	}
	for (int t = 0; t < part->triangles; t++) {
		fputs("f", to);
		for (int k = 0; k < 3; k++) {
			const long at = first + 1 + (long)part->index[t][k];

			fprintf(to, " %ld/%ld/%ld", at, at, at);
		}
		fputs("\n", to);
	}
	return first + part->vertices;
}

void export_meshes(const struct export_job *job, bool standins, FILE *to)
{
	const struct scene *scene = job->scene;
	long vertices = 0;

	for (int k = 0; k < scene->file->mesh_count; k++) {
		const struct material *named = named_material(scene, k);
		const struct mesh *mesh = &scene->meshes[k];

		if (scene->file->mesh[k].standin != standins)
			continue;
		for (int p = 0; p < mesh->part_count; p++) {
			const struct mesh_part *part = &mesh->parts[p];
			const struct material *own = &mesh->materials[part->material];

			vertices = write_part(job, to, part, named ? named : own, vertices);
		}
	}
}
