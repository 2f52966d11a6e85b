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
#include "hal/base/log.h"
#include "hal/optics/vec.h"

/* Largest distance from the origin, as a multiple of the mesh's size: there single precision rounds
 * vertices to 1/100 of the size; and where it is worth a word. */
#define FAR_MOST (0.01 * (1 << 24))
#define FAR_SEEN (FAR_MOST / 20)
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
	float out[3];

	for (int i = 0; i < 3; i++)
		out[i] = (float)(a->m[3 * i] * (double)p[0] + a->m[3 * i + 1] * (double)p[1] +
				 a->m[3 * i + 2] * (double)p[2] + shift * a->t[i]);
	return v3_make(out[0], out[1], out[2]);
}

/* Moves the origin of positions into t, and the lowest of them to Z = 0 if the mesh stands. */
static void affine_settle(struct affine *a, const struct mesh *mesh, int stand)
{
	const double *m = a->m, *o = mesh->origin;
	double lowest = INFINITY;

	for (int i = 0; i < 3; i++)
		a->t[i] += m[3 * i] * o[0] + m[3 * i + 1] * o[1] + m[3 * i + 2] * o[2];
	for (int k = 0; k < mesh->part_count && stand; k++)
		for (int i = 0; i < mesh->parts[k].vertices; i++) {
			const float *p = mesh->parts[k].position[i];

			lowest = fmin(lowest, m[6] * (double)p[0] + m[7] * (double)p[1] +
						      m[8] * (double)p[2]);
		}
	if (stand)
		a->t[2] = -lowest;
}

static void mesh_place(struct mesh *mesh, const struct mesh_placement *placement)
{
	struct affine a = affine_of(placement);

	affine_settle(&a, mesh, placement->stand);
	memset(mesh->origin, 0, sizeof(mesh->origin));
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
		}
	}
}

/* ---- checks ---- */

/* Refuses a small mesh far from the origin: single precision rounds its vertices to a coarse grid,
 * in the world or in the file. A file was written in single precision if all its vertices are such
 * numbers. position: that of the placement; NULL: not placed yet. */
static int check_precision(const struct mesh *mesh, const double *position, const char *path,
			   struct fault *fault)
{
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
	double size = 0, far = 0, middle[3] = {0};
	char nearer[96] = "nearer";
	bool single = true;

	for (int k = 0; k < mesh->part_count; k++)
		for (int i = 0; i < mesh->parts[k].vertices; i++)
			for (int axis = 0; axis < 3; axis++) {
				const double at = mesh->origin[axis] +
						  (double)mesh->parts[k].position[i][axis];

				low[axis] = fmin(low[axis], at);
				high[axis] = fmax(high[axis], at);
				single &= (double)(float)at == at;
			}
	for (int axis = 0; axis < 3; axis++) {
		size = fmax(size, high[axis] - low[axis]);
		far = fmax(far, fmax(-low[axis], high[axis]));
		if (position)
			middle[axis] = position[axis] - (low[axis] + high[axis]) / 2;
	}
	if (far < FAR_SEEN * size || size == 0 || !single)
		return 0;
	if (position)
		snprintf(nearer, sizeof(nearer), "to the origin by position = %.8g %.8g %.8g",
			 middle[0], middle[1], middle[2]);
	if (far >= FAR_MOST * size)
		return fault_say(
			fault, -ERANGE,
			"%s: it is %.4g across and up to %.6g from the origin, where single precision rounds its vertices, expected less than %.3g: move it %s",
			path, size, far, FAR_MOST * size, nearer);
	log_warning_once(
		"%s: it is %.4g across and up to %.6g from the origin%s, where single precision rounds its vertices by 1/%.0f of its size: move it %s",
		path, size, far, position ? "" : " of its file", size / far * (1 << 25), nearer);
	return 0;
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

	for (int k = 0; k < mesh->part_count; k++) {
		const struct mesh_part *part = &mesh->parts[k];

		triangles += part->triangles;
		for (int i = 0; i < part->vertices; i++)
			for (int axis = 0; axis < 3; axis++)
				if (!isfinite(part->position[i][axis]))
					return fault_say(
						fault, -EDOM,
						"%s: vertex %d is not finite, expected numbers",
						path, i + 1);
		for (int i = 0; i < part->triangles; i++)
			for (int corner = 0; corner < 3; corner++)
				if (part->index[i][corner] >= (uint32_t)part->vertices)
					return fault_say(
						fault, -EBADMSG,
						"%s: triangle %d names vertex %u, expected less than %d",
						path, i, part->index[i][corner], part->vertices);
	}
	if (!triangles)
		return fault_say(fault, -ENODATA,
				 "%s: no faces, expected a mesh of triangles or polygons", path);
	return check_area(mesh, path, fault);
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
	return fault_say(
		fault, -ERANGE,
		"%s: it reaches %.3g world units from the origin, expected at most %g: look at its vertices and its scale",
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
		"%s: by its ending no kind of mesh that is read, expected glTF (.gltf, .glb), OBJ, PLY or STL: Blender opens most other kinds and exports glTF",
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
	for (int k = 0; k < mesh->part_count && !err; k++)
		if (mesh_drop_unused(&mesh->parts[k]) < 0)
			err = fault_say(fault, -ENOMEM, "%s: out of memory", path);
	if (!err)
		err = check_precision(mesh, NULL, path, fault);
	if (err) {
		mesh_free(mesh);
		return err;
	}
	mesh_place(mesh, placement);
	mesh_turn_outwards(mesh);
	err = mesh_check(mesh, path, fault); /* a huge scale may exceed the range of float */
	if (!err)
		err = check_precision(mesh, placement->position, path, fault);
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
