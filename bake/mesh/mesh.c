/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include <xxhash.h>

#include "bake/mesh/formats/formats.h"
#include "bake/mesh/gltf/gltf.h"
#include "bake/mesh/mesh_winding.h"
#include "hal/base/input.h"
#include "hal/optics/vec.h"

/* Largest distance from the origin, as a multiple of the mesh's size: there single precision rounds
 * vertices to 1/100 of the size. */
#define FAR_MOST (0.01 * (1 << 24))
#define REACH_MOST 1e9 /* world units: a thousand times what a scene file may say */
#define FLAT_MOST 1e-6 /* sine of a triangle's angle that rounding alone can make */

/* ---- placement ---- */

/* p = M p + t */
struct affine {
	double m[9];
	double t[3];
};

static void matrix_multiply(const double a[9], const double b[9], double out[9])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] +
					 a[3 * i + 2] * b[6 + j];
}

static struct affine affine_of(const struct mesh_placement *p)
{
	static const double upright[9] = {1, 0, 0, 0, 0, -1, 0, 1, 0};
	struct affine a = {.m = {1, 0, 0, 0, 1, 0, 0, 0, 1}};

	if (p->y_up)
		memcpy(a.m, upright, sizeof(upright));
	for (int axis = 0; axis < 3; axis++) {
		const double angle = p->rotate_deg[axis] * (M_PI / 180);
		const int j = (axis + 1) % 3, k = (axis + 2) % 3;
		double r[9] = {0}, product[9];

		r[4 * axis] = 1;
		r[4 * j] = r[4 * k] = cos(angle);
		r[3 * j + k] = -sin(angle);
		r[3 * k + j] = sin(angle);
		matrix_multiply(r, a.m, product);
		memcpy(a.m, product, sizeof(product));
	}
	for (int i = 0; i < 9; i++)
		a.m[i] *= p->scale;
	memcpy(a.t, p->position, sizeof(a.t));
	return a;
}

static struct v3 affine_apply(const struct affine *a, const float p[4], double shift)
{
	const double *m = a->m;

	return v3_make((float)(m[0] * p[0] + m[1] * p[1] + m[2] * p[2] + shift * a->t[0]),
		       (float)(m[3] * p[0] + m[4] * p[1] + m[5] * p[2] + shift * a->t[1]),
		       (float)(m[6] * p[0] + m[7] * p[1] + m[8] * p[2] + shift * a->t[2]));
}

static void mesh_place(struct mesh *mesh, const struct mesh_placement *placement)
{
	const struct affine a = affine_of(placement);
	float lowest = INFINITY;

	for (int k = 0; k < mesh->part_count; k++) {
		struct mesh_part *part = &mesh->parts[k];

		for (int i = 0; i < part->vertices; i++) {
			const float n[4] = {part->normal[i].x, part->normal[i].y,
					    part->normal[i].z};
			const struct v3 p = affine_apply(&a, part->position[i], 1);

			part->position[i][0] = p.x;
			part->position[i][1] = p.y;
			part->position[i][2] = p.z;
			part->normal[i] = v3_unit(affine_apply(&a, n, 0));
			if (part->tangent) {
				const struct v3 t = affine_apply(&a, part->tangent[i], 0);

				memcpy(part->tangent[i], (float[]){t.x, t.y, t.z},
				       3 * sizeof(float));
			}
			lowest = fminf(lowest, p.z);
		}
	}
	if (!placement->stand)
		return;
	for (int k = 0; k < mesh->part_count; k++)
		for (int i = 0; i < mesh->parts[k].vertices; i++)
			mesh->parts[k].position[i][2] -= lowest;
}

/* ---- checks ---- */

/* Refuses a small mesh far from the origin: single precision rounds its vertices to a coarse
 * grid. */
static int check_precision(const struct mesh *mesh, const char *path, struct fault *fault)
{
	float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
	double size = 0, far = 0;

	for (int k = 0; k < mesh->part_count; k++)
		for (int i = 0; i < mesh->parts[k].vertices; i++)
			for (int axis = 0; axis < 3; axis++) {
				const float at = mesh->parts[k].position[i][axis];

				low[axis] = fminf(low[axis], at);
				high[axis] = fmaxf(high[axis], at);
			}
	for (int axis = 0; axis < 3; axis++) {
		size = fmax(size, (double)high[axis] - (double)low[axis]);
		far = fmax(far, fmax(-(double)low[axis], (double)high[axis]));
	}
	if (far < FAR_MOST * size || size == 0)
		return 0;
	return fault_say(fault, -ERANGE,
			 "%s: it is %.4g across and up to %.6g from the origin, where single "
			 "precision rounds its vertices, expected less than %.3g: move it nearer",
			 path, size, far, FAR_MOST * size);
}

static bool has_area(const struct mesh_part *part, const uint32_t corner[3])
{
	const float *p[3];
	double a[3], b[3], across[3];

	for (int k = 0; k < 3; k++)
		p[k] = part->position[corner[k]];
	for (int axis = 0; axis < 3; axis++) {
		a[axis] = (double)p[1][axis] - (double)p[0][axis];
		b[axis] = (double)p[2][axis] - (double)p[0][axis];
	}
	vec_cross(a, b, across);
	return vec_length(across) > FLAT_MOST * vec_length(a) * vec_length(b);
}

static int check_area(const struct mesh *mesh, const char *path, struct fault *fault)
{
	for (int k = 0; k < mesh->part_count; k++)
		for (int i = 0; i < mesh->parts[k].triangles; i++)
			if (has_area(&mesh->parts[k], mesh->parts[k].index[i]))
				return 0;
	return fault_say(fault, -ENODATA,
			 "%s: its faces all have no area, expected some that can be seen", path);
}

static int mesh_check(const struct mesh *mesh, const char *path, struct fault *fault)
{
	long triangles = 0;
	int err;

	for (int k = 0; k < mesh->part_count; k++) {
		const struct mesh_part *part = &mesh->parts[k];

		triangles += part->triangles;
		for (int i = 0; i < part->vertices; i++)
			for (int axis = 0; axis < 3; axis++)
				if (!isfinite(part->position[i][axis]))
					return fault_say(fault, -EDOM,
							 "%s: vertex %d is not finite, expected "
							 "numbers",
							 path, i + 1);
		for (int i = 0; i < part->triangles; i++)
			for (int corner = 0; corner < 3; corner++)
				if (part->index[i][corner] >= (uint32_t)part->vertices)
					return fault_say(
						fault, -EBADMSG,
						"%s: triangle %d names vertex %u, expected "
						"less than %d",
						path, i, part->index[i][corner], part->vertices);
	}
	if (!triangles)
		return fault_say(fault, -ENODATA,
				 "%s: no faces, expected a mesh of triangles or "
				 "polygons",
				 path);
	err = check_area(mesh, path, fault);
	return err ? err : check_precision(mesh, path, fault);
}

/* Refuses vertices that a huge scale, of the scene or of the file, has put too far away or made
 * infinite. */
static int check_reach(const struct mesh *mesh, const char *path, struct fault *fault)
{
	double far = 0;

	for (int k = 0; k < mesh->part_count; k++)
		for (int i = 0; i < mesh->parts[k].vertices; i++)
			for (int axis = 0; axis < 3; axis++)
				far = fmax(far, fabs((double)mesh->parts[k].position[i][axis]));
	if (far <= REACH_MOST)
		return 0;
	return fault_say(fault, -ERANGE,
			 "%s: it reaches %.3g world units from the origin, expected at most %g: "
			 "look at its vertices and its scale",
			 path, far, REACH_MOST);
}

/* Reads a file by the reader of its kind. */
static int mesh_import(struct mesh *mesh, const char *path, double crease_deg, bool materials,
		       struct fault *fault)
{
	const char *dot = strrchr(path, '.');

	if (gltf_is(path))
		return gltf_read(mesh, path, crease_deg, materials, fault);
	if (dot && strcasecmp(dot, ".obj") == 0)
		return obj_read(mesh, path, crease_deg, materials, fault);
	if (dot && strcasecmp(dot, ".ply") == 0)
		return ply_read(mesh, path, crease_deg, materials, fault);
	if (dot && strcasecmp(dot, ".stl") == 0)
		return stl_read(mesh, path, crease_deg, materials, fault);
	return fault_say(
		fault, -ENOTSUP,
		"%s: by its ending no kind of mesh that is read, expected glTF (.gltf, .glb), "
		"OBJ, PLY or STL: Blender opens most other kinds and exports glTF",
		path);
}

int mesh_read(struct mesh *mesh, const char *path, const struct mesh_placement *placement,
	      struct fault *fault)
{
	int err;

	*mesh = (struct mesh){.part_count = 0};
	input_note(path);
	if (access(path, R_OK) < 0) {
		err = -errno;
		return fault_say(fault, err, "cannot open \"%s\": %s", path, strerror(-err));
	}
	err = mesh_import(mesh, path, placement->crease_deg, placement->own_materials, fault);
	if (!err)
		err = mesh_check(mesh, path, fault);
	if (err) {
		mesh_free(mesh);
		return err;
	}
	mesh_place(mesh, placement);
	mesh_turn_outwards(mesh);
	err = mesh_check(mesh, path, fault); /* a huge scale may exceed the range of float */
	return err ? err : check_reach(mesh, path, fault);
}

uint64_t mesh_hash(const struct mesh *mesh)
{
	XXH3_state_t *state = XXH3_createState();
	uint64_t hash;

	XXH3_64bits_reset(state);
	for (int k = 0; k < mesh->part_count; k++) {
		const struct mesh_part *part = &mesh->parts[k];
		const size_t vertices = (size_t)part->vertices;

		XXH3_64bits_update(state, part->position, vertices * sizeof(*part->position));
		XXH3_64bits_update(state, part->normal, vertices * sizeof(*part->normal));
		if (part->uv)
			XXH3_64bits_update(state, part->uv, vertices * sizeof(*part->uv));
		if (part->uv2)
			XXH3_64bits_update(state, part->uv2, vertices * sizeof(*part->uv2));
		if (part->tangent)
			XXH3_64bits_update(state, part->tangent, vertices * sizeof(*part->tangent));
		if (part->colour)
			XXH3_64bits_update(state, part->colour, vertices * sizeof(*part->colour));
		XXH3_64bits_update(state, part->index,
				   (size_t)part->triangles * sizeof(*part->index));
		XXH3_64bits_update(state, &part->material, sizeof(part->material));
	}
	for (int k = 0; k < mesh->material_count; k++)
		material_hash(&mesh->materials[k], state);
	for (int k = 0; k < mesh->texture_count; k++)
		texture_hash(mesh->textures[k], state);
	hash = XXH3_64bits_digest(state);
	XXH3_freeState(state);
	return hash;
}

void mesh_free(struct mesh *mesh)
{
	for (int k = 0; k < mesh->part_count; k++) {
		free(mesh->parts[k].position);
		free(mesh->parts[k].normal);
		free(mesh->parts[k].uv);
		free(mesh->parts[k].uv2);
		free(mesh->parts[k].tangent);
		free(mesh->parts[k].colour);
		free(mesh->parts[k].index);
	}
	for (int k = 0; k < mesh->texture_count; k++) {
		image_free(&mesh->textures[k]->image);
		free(mesh->textures[k]);
	}
	free(mesh->parts);
	free(mesh->materials);
	free(mesh->textures);
	*mesh = (struct mesh){.part_count = 0};
}
