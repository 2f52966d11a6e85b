/* SPDX-License-Identifier: MIT */
/* make-cow FOLDER: writes the toy cow as cow.obj, cow.mtl and cow.png. The same on every run. */
#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "bake/demo/atlas.h"
#include "bake/demo/cow_coat.h"
#include "bake/demo/cow_shape.h"
#include "hal/base/output.h"

#define TEXTURE_SIDE 1024

static const char materials[] =
	"# The toy cow's materials. Pr is GGX roughness, Pm metalness.\n"
	"newmtl coat\nKd 1 1 1\nKs 0 0 0\nillum 1\nmap_Kd cow.png\n\n"
	"newmtl eye\nKd 0.012 0.010 0.010\nKs 0.5 0.5 0.5\nNs 800\nPr 0.08\nPm 0\nillum 2\n\n"
	"newmtl collar\nKd 0.50 0.02 0.02\nKs 0.3 0.3 0.3\nNs 40\nPr 0.35\nPm 0\nillum 2\n\n"
	"newmtl bell\nKd 0.95 0.66 0.20\nKs 0.95 0.66 0.20\nNs 120\nPr 0.22\nPm 1\nillum 3\n";

/* The OBJ file. Counters run on over its parts; only a part with a texture has points. */
struct obj {
	FILE *stream;
	int vertices, points;
};

static void write_part(struct obj *obj, const struct cow_part *part, const struct trimesh *mesh,
		       const struct atlas *atlas)
{
	fprintf(obj->stream, "o %s\nusemtl %s\n", part->name, part->material);
	for (int v = 0; v < mesh->vertex_count; v++)
		fprintf(obj->stream, "v %.6f %.6f %.6f\n", mesh->position[v][0],
			mesh->position[v][1], mesh->position[v][2]);
	for (int v = 0; v < mesh->vertex_count; v++)
		fprintf(obj->stream, "vn %.5f %.5f %.5f\n", mesh->normal[v][0], mesh->normal[v][1],
			mesh->normal[v][2]);
	/* In the file v runs upwards. */
	for (int k = 0; atlas && k < atlas->point_count; k++)
		fprintf(obj->stream, "vt %.6f %.6f\n", atlas->point[k][0], 1 - atlas->point[k][1]);
	for (int t = 0; t < mesh->triangle_count; t++) {
		fputc('f', obj->stream);
		for (int k = 0; k < 3; k++) {
			const int v = mesh->triangle[t][k] + 1 + obj->vertices;

			if (atlas)
				fprintf(obj->stream, " %d/%d/%d", v,
					atlas->corner[t][k] + 1 + obj->points, v);
			else
				fprintf(obj->stream, " %d//%d", v, v);
		}
		fputc('\n', obj->stream);
	}
	obj->vertices += mesh->vertex_count;
	obj->points += atlas ? atlas->point_count : 0;
}

static int write_cow_texture(const char *folder, const struct atlas *atlas, struct fault *fault)
{
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s/cow.png", folder);
	return image_write(path, &atlas->picture, fault);
}

static int make_cow_part(struct obj *obj, const struct cow_part *part, const char *folder,
			 struct fault *fault)
{
	struct trimesh mesh = {0};
	struct atlas atlas = {0};
	const bool textured = part == &cow_parts[0];
	int err;

	err = polygonise(&mesh, &part->solid, part->step);
	if (!err && textured)
		err = atlas_create(&atlas, &mesh, TEXTURE_SIDE, cow_colour);
	if (err) {
		fault_say(fault, err, "cannot make the cow's %s: %s", part->name, strerror(-err));
		goto out;
	}
	write_part(obj, part, &mesh, textured ? &atlas : NULL);
	if (textured)
		err = write_cow_texture(folder, &atlas, fault);
out:
	atlas_free(&atlas);
	trimesh_free(&mesh);
	return err;
}

static int write_cow_materials(const char *folder, struct fault *fault)
{
	struct output out = {0};
	char path[PATH_MAX];
	int err;

	snprintf(path, sizeof(path), "%s/cow.mtl", folder);
	err = output_open(&out, path, fault);
	if (err)
		return err;
	fputs(materials, out.stream);
	return output_commit(&out, fault);
}

static int write_mesh(const char *folder, struct fault *fault)
{
	struct output out = {0};
	char path[PATH_MAX];
	int err;

	snprintf(path, sizeof(path), "%s/cow.obj", folder);
	err = output_open(&out, path, fault);
	if (err)
		return err;

	struct obj obj = {.stream = out.stream};

	fputs("# A toy cow, made by make-cow: metres, y up, looking along +z.\nmtllib cow.mtl\n",
	      out.stream);
	for (int k = 0; k < COW_PARTS && !err; k++)
		err = make_cow_part(&obj, &cow_parts[k], folder, fault);
	if (err) {
		output_abandon(&out);
		return err;
	}
	return output_commit(&out, fault);
}

int main(int argc, char **argv)
{
	struct fault fault = {0};
	int err;

	if (argc != 2 || argv[1][0] == '-') {
		fprintf(stderr, "usage: make-cow FOLDER\n"
				"Writes cow.obj, cow.mtl and cow.png there.\n");
		return argc == 2 && !strcmp(argv[1], "--help") ? 0 : 2;
	}
	if (mkdir(argv[1], 0777) && errno != EEXIST) {
		fprintf(stderr, "make-cow: cannot make folder \"%s\": %s\n", argv[1],
			strerror(errno));
		return 1;
	}
	err = write_cow_materials(argv[1], &fault);
	if (!err)
		err = write_mesh(argv[1], &fault);
	if (err) {
		fprintf(stderr, "make-cow: %s\n", fault.text);
		return 1;
	}
	return 0;
}
