/* SPDX-License-Identifier: MIT */
#include "bake/mesh/formats/soup.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "bake/mesh/mesh.h"
#include "hal/base/input.h"
#include "hal/colour/transfer.h"
#include "hal/optics/vec.h"

#define TRIANGLES_MAX (64 << 20)
#define NONE UINT32_MAX

/* Triangles of one material that all have normals, or none. */
struct soup_part {
	int material;
	unsigned has; /* what any of its polygons has */
	struct soup_corner *vertex;
	uint32_t *slot; /* hash table of the vertices; NONE: empty */
	uint32_t (*triangle)[3];
	size_t vertices, vertex_room, slots, triangles, triangle_room;
};

int soup_open(struct soup *soup, struct mesh *mesh, const char *path, bool materials,
	      struct fault *fault)
{
	int err;

	*soup = (struct soup){.path = path,
			      .fault = fault,
			      .with_materials = materials,
			      .textures = {.mesh = mesh, .mesh_path = path, .fault = fault}};
	err = input_read(path, INPUT_MAX, &soup->file, &soup->bytes, fault);
	text_begin(&soup->lines, (const char *)soup->file, soup->bytes);
	soup->textures.budget.file_bytes = soup->bytes;
	return err;
}

int soup_lack(const struct soup *soup)
{
	return fault_say(soup->fault, -ENOMEM, "%s: out of memory", soup->path);
}

bool soup_has_normal(const struct soup_corner *corner)
{
	const float *n = corner->normal, length = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);

	return length > 0 && isfinite(length);
}

struct material soup_material(bool coloured)
{
	const float grey = coloured ? 1 : 0.8f;

	return (struct material){.ior = 1.5f, .alpha = 1, .colour = {{grey, grey, grey}}};
}

double soup_full_colour(double most)
{
	return most < 2 ? 1 : most <= 255 ? 255 : 65535;
}

void soup_decode_colours(float *value, size_t count, double full)
{
	for (size_t k = 0; k < count; k++) {
		const double code = (double)value[k] / full;

		value[k] = (float)transfer_decode(TRANSFER_SRGB, code > 0 ? fmin(code, 1) : 0);
	}
}

/* ---- vertices ---- */

bool soup_room(void *array, size_t used, size_t *room, size_t size)
{
	const size_t wanted = *room ? 2 * *room : 64;
	void *grown;

	if (used < *room)
		return true;
	grown = realloc(*(void **)array, wanted * size);
	if (!grown)
		return false;
	*(void **)array = grown;
	*room = wanted;
	return true;
}

static uint32_t *part_slot(const struct soup_part *part, const struct soup_corner *corner)
{
	size_t k = XXH3_64bits(corner, sizeof(*corner)) & (part->slots - 1);

	while (part->slot[k] != NONE &&
	       memcmp(&part->vertex[part->slot[k]], corner, sizeof(*corner)) != 0)
		k = (k + 1) & (part->slots - 1);
	return &part->slot[k];
}

/* Keeps the hash table at most half full. */
static bool part_grow_slots(struct soup_part *part)
{
	const size_t slots = part->slots ? 2 * part->slots : 256;
	uint32_t *slot;

	if (2 * part->vertices < part->slots)
		return true;
	slot = malloc(slots * sizeof(*slot));
	if (!slot)
		return false;
	memset(slot, 0xff, slots * sizeof(*slot));
	free(part->slot);
	part->slot = slot;
	part->slots = slots;
	for (size_t v = 0; v < part->vertices; v++)
		*part_slot(part, &part->vertex[v]) = (uint32_t)v;
	return true;
}

/* Rounds to single precision from the origin, which is near any corner of the mesh. Returns NONE
 * when memory is short. */
static uint32_t part_vertex(const double origin[3], struct soup_part *part,
			    const struct soup_corner *from, unsigned has)
{
	struct soup_corner corner = {.colour = {1, 1, 1}};
	uint32_t *slot;

	for (int axis = 0; axis < 3; axis++)
		corner.position[axis] = (double)(float)(from->position[axis] - origin[axis]);
	if (has & SOUP_NORMALS)
		memcpy(corner.normal, from->normal, sizeof(corner.normal));
	for (int k = 0; k < 2 && has & SOUP_UVS; k++)
		corner.uv[k] = isfinite(from->uv[k]) ? from->uv[k] : 0;
	if (has & SOUP_COLOURS)
		memcpy(corner.colour, from->colour, sizeof(corner.colour));
	if (!part_grow_slots(part))
		return NONE;
	slot = part_slot(part, &corner);
	if (*slot != NONE)
		return *slot;
	if (!soup_room(&part->vertex, part->vertices, &part->vertex_room, sizeof(*part->vertex)))
		return NONE;
	*slot = (uint32_t)part->vertices;
	part->vertex[part->vertices++] = corner;
	return *slot;
}

static struct soup_part *soup_part_of(struct soup *soup, int material, unsigned has)
{
	struct soup_part *grown;

	/* that which was used last comes first */
	for (int k = 0; k < soup->part_count; k++) {
		const int at = (soup->last + k) % soup->part_count;
		struct soup_part *part = &soup->parts[at];

		if (part->material == material && !((part->has ^ has) & SOUP_NORMALS)) {
			soup->last = at;
			return part;
		}
	}
	grown = realloc(soup->parts, ((size_t)soup->part_count + 1) * sizeof(*grown));
	if (!grown)
		return NULL;
	soup->parts = grown;
	soup->last = soup->part_count;
	grown[soup->last] = (struct soup_part){.material = material, .has = has & SOUP_NORMALS};
	return &grown[soup->part_count++];
}

static int soup_add_triangle(struct soup *soup, struct soup_part *part, const struct soup_corner *a,
			     const struct soup_corner *b, const struct soup_corner *c, unsigned has)
{
	const struct soup_corner *const corner[3] = {a, b, c};
	double *origin = soup->textures.mesh->origin;
	uint32_t(*triangle)[3];

	if (!soup->placed)
		mesh_set_origin(origin, a->position);
	soup->placed = true;
	if (part->triangles >= TRIANGLES_MAX)
		return fault_say(soup->fault, -EFBIG,
				 "%s: expected at most %d triangles of a material", soup->path,
				 TRIANGLES_MAX);
	if (!soup_room(&part->triangle, part->triangles, &part->triangle_room,
		       sizeof(*part->triangle)))
		return soup_lack(soup);
	triangle = &part->triangle[part->triangles];
	for (int k = 0; k < 3; k++) {
		(*triangle)[k] = part_vertex(origin, part, corner[k], has);
		if ((*triangle)[k] == NONE)
			return soup_lack(soup);
	}
	part->triangles++;
	return 0;
}

/* ---- polygons ---- */

/* Sees a polygon along the axis that its normal is nearest to, turned counter-clockwise. The normal
 * is Newell's, whose length is twice the area. */
static void polygon_see(const struct soup_corner *corner, int count, double (*at)[2])
{
	double normal[3] = {0, 0, 0};
	int axis = 2;

	for (int k = 0; k < count; k++) {
		double a[3], b[3], across[3];

		for (int i = 0; i < 3; i++) {
			a[i] = corner[k].position[i] - corner[0].position[i];
			b[i] = corner[(k + 1) % count].position[i] - corner[0].position[i];
		}
		vec_cross(a, b, across);
		for (int i = 0; i < 3; i++)
			normal[i] += across[i];
	}
	for (int i = 0; i < 2; i++)
		if (fabs(normal[i]) > fabs(normal[axis]))
			axis = i;
	for (int k = 0; k < count; k++) {
		const double y = corner[k].position[(axis + 2) % 3];

		at[k][0] = corner[k].position[(axis + 1) % 3];
		at[k][1] = normal[axis] < 0 ? -y : y;
	}
}

static bool polygon_room(struct soup *soup, int count)
{
	void *at, *cut;

	if (count <= soup->polygon_room)
		return true;
	at = realloc(soup->at, (size_t)count * sizeof(*soup->at));
	soup->at = at ? at : soup->at;
	cut = realloc(soup->cut, (size_t)count * sizeof(*soup->cut));
	soup->cut = cut ? cut : soup->cut;
	soup->polygon_room = at && cut ? count : soup->polygon_room;
	return at && cut;
}

int soup_add(struct soup *soup, const struct soup_corner *corners, int count, int material,
	     unsigned has)
{
	struct soup_part *part = soup_part_of(soup, material, has);
	bool fan = true;
	int err = 0;

	if (!part || !polygon_room(soup, count))
		return soup_lack(soup);
	part->has |= has;
	if (count > 3) {
		polygon_see(corners, count, soup->at);
		fan = ears_convex((const double(*)[2])soup->at, count);
	}
	if (!fan && ears_cut((const double(*)[2])soup->at, count, soup->cut))
		return soup_lack(soup);
	for (int k = 0; k + 2 < count && !err; k++) {
		const int *cut = fan ? (int[]){0, k + 1, k + 2} : soup->cut[k];

		err = soup_add_triangle(soup, part, &corners[cut[0]], &corners[cut[1]],
					&corners[cut[2]], has);
	}
	return err;
}

/* ---- the mesh ---- */

static bool part_move(struct soup_part *from, struct mesh_part *to)
{
	const size_t vertices = from->vertices;

	to->material = from->material;
	to->vertices = (int)vertices;
	to->triangles = (int)from->triangles;
	to->index = from->triangle;
	from->triangle = NULL;
	to->position = calloc(vertices + 1, sizeof(*to->position));
	to->normal = calloc(vertices + 1, sizeof(*to->normal));
	if (from->has & SOUP_UVS)
		to->uv = calloc(vertices + 1, sizeof(*to->uv));
	if (from->has & SOUP_COLOURS)
		to->colour = calloc(vertices + 1, sizeof(*to->colour));
	if (!to->position || !to->normal || !to->uv != !(from->has & SOUP_UVS) ||
	    !to->colour != !(from->has & SOUP_COLOURS))
		return false;
	for (size_t v = 0; v < vertices; v++) {
		const struct soup_corner *c = &from->vertex[v];

		for (int axis = 0; axis < 3; axis++)
			to->position[v][axis] = (float)c->position[axis];
		to->normal[v] = v3_unit(v3_make(c->normal[0], c->normal[1], c->normal[2]));
		if (to->uv)
			memcpy(to->uv[v], c->uv, sizeof(c->uv));
		if (to->colour)
			memcpy(to->colour[v],
			       (float[]){c->colour[0], c->colour[1], c->colour[2], 1},
			       sizeof(*to->colour));
	}
	free(from->vertex);
	from->vertex = NULL;
	return true;
}

/* Indices are in range: mesh_smooth() may trust them. A vertex that is not finite, which the caller
 * refuses, gives it no trouble but normals that are none. */
int soup_finish(struct soup *soup, double crease_deg)
{
	struct mesh *mesh = soup->textures.mesh;

	mesh->parts = calloc((size_t)soup->part_count + 1, sizeof(*mesh->parts));
	if (!mesh->parts)
		return soup_lack(soup);
	for (int k = 0; k < soup->part_count; k++) {
		struct soup_part *from = &soup->parts[k];
		struct mesh_part *to = &mesh->parts[mesh->part_count];

		if (!from->triangles)
			continue;
		mesh->part_count++;
		free(from->slot);
		from->slot = NULL;
		if (!part_move(from, to) ||
		    (!(from->has & SOUP_NORMALS) && mesh_smooth(to, crease_deg) < 0))
			return soup_lack(soup);
	}
	return 0;
}

int soup_close(struct soup *soup, int err)
{
	if (!err)
		left_out_say(&soup->out, soup->path);
	for (int k = 0; k < soup->part_count; k++) {
		free(soup->parts[k].vertex);
		free(soup->parts[k].slot);
		free(soup->parts[k].triangle);
	}
	free(soup->parts);
	free(soup->at);
	free(soup->cut);
	textures_free(&soup->textures);
	text_end(&soup->lines);
	free(soup->file);
	return err;
}
