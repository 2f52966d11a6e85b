/* SPDX-License-Identifier: MIT */
/*
 * Collects the polygons of a file as triangles, sorted by material. Corners that agree in all their
 * values become one vertex.
 */
#ifndef INLAY_BAKE_MESH_FORMATS_SOUP_H
#define INLAY_BAKE_MESH_FORMATS_SOUP_H

#include "bake/mesh/mesh.h"

struct soup_corner {
	float position[3], normal[3], uv[2], colour[4];
};

/* What corners have, as bits. What they have not is ignored. Texture coordinates that are no numbers, as
 * some programs write them of faces without area, become 0; such a normal is none. */
#define SOUP_NORMALS 1u
#define SOUP_UVS 2u
#define SOUP_COLOURS 4u

bool soup_has_normal(const struct soup_corner *corner);

/* A matt surface: grey where the file says nothing of colours, white where it has some elsewhere. */
struct material soup_material(bool coloured);

/* Makes room for one more element of an array that has `used`. False: out of memory. */
bool soup_room(void *array, size_t used, size_t *room, size_t size);

struct soup_part;

struct soup {
	const char *path; /* for messages */
	struct fault *fault;
	struct soup_part *parts;
	int part_count, last;
	int *left, left_room; /* corners of the polygon that is being cut */
};

void soup_begin(struct soup *soup, const char *path, struct fault *fault);

/*
 * Adds a polygon, which may be concave and is cut in its plane, by ears (Meisters 1975). Its corners
 * must have normals all of them, or none. One with fewer than 3 corners is left out. -ENOMEM; -EFBIG:
 * too many triangles. material: index in the mesh's own list.
 */
int soup_add(struct soup *soup, const struct soup_corner *corners, int count, int material,
	     unsigned has);

/* Moves all parts to the mesh, and computes normals where there are none; crease_deg as of
 * mesh_smooth(). -ENOMEM. */
int soup_finish(struct soup *soup, struct mesh *mesh, double crease_deg);

void soup_free(struct soup *soup); /* idempotent */

#endif
