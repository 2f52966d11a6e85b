/* SPDX-License-Identifier: MIT */
/*
 * Collects the polygons of a file as triangles, sorted by material. Corners that agree in all their
 * values become one vertex.
 */
#ifndef INLAY_BAKE_MESH_FORMATS_SOUP_H
#define INLAY_BAKE_MESH_FORMATS_SOUP_H

#include "bake/mesh/formats/text.h"
#include "bake/mesh/formats/textures.h"
#include "bake/mesh/left_out.h"

/* Without padding: corners are compared as bytes. */
struct soup_corner {
	double position[3];
	float normal[3], uv[2], colour[3];
};

/* What corners have, as bits. What they have not is ignored. Texture coordinates that are no
 * numbers, as some programs write them of faces without area, become 0; such a normal is none. */
#define SOUP_NORMALS 1u
#define SOUP_UVS 2u
#define SOUP_COLOURS 4u

bool soup_has_normal(const struct soup_corner *corner);

/* A matt surface: grey where the file says nothing of colours, white where it has some
 * elsewhere. */
struct material soup_material(bool coloured);

/*
 * Returns what colours of vertices are divided by, since programs write them as shares of 1, as
 * bytes or as 16-bit values in types that could hold more. most: the largest one of the file.
 */
double soup_full_colour(double most);

/* Turns code values of sRGB, of which `full` is white, into linear light. */
void soup_decode_colours(float *value, size_t count, double full);

/* Makes room for one more element of an array that has `used`. False: out of memory. */
bool soup_room(void *array, size_t used, size_t *room, size_t size);

struct soup_part;

/* A file that is being read, and what has been read of it. */
struct soup {
	const char *path; /* for messages */
	struct fault *fault;
	bool with_materials;
	uint8_t *file; /* whole */
	size_t bytes;
	struct text_lines lines;  /* of the whole file, from the beginning */
	struct textures textures; /* and the mesh */
	struct left_out out;
	struct soup_part *parts;
	int part_count, last;
	bool placed; /* the mesh has its origin */
	/* Corners of a polygon in its plane, and its triangles. */
	double (*at)[2];
	int (*cut)[3], polygon_room;
};

/* Opens a file for a zeroed mesh. soup_close() also after a failure. */
int soup_open(struct soup *soup, struct mesh *mesh, const char *path, bool materials,
	      struct fault *fault);

int soup_lack(const struct soup *soup); /* -ENOMEM */

/*
 * Adds a polygon, which may be concave and is cut in its plane, by ears (Meisters 1975). Its
 * corners must have normals all of them, or none. One with fewer than 3 corners is left out.
 * -ENOMEM; -EFBIG: too many triangles. material: index in the mesh's own list.
 */
int soup_add(struct soup *soup, const struct soup_corner *corners, int count, int material,
	     unsigned has);

/* Moves all parts to the mesh, and computes normals where there are none; crease_deg as of
 * mesh_smooth(). -ENOMEM. */
int soup_finish(struct soup *soup, double crease_deg);

/* Frees all; says what is left out where err is 0. Returns err. */
int soup_close(struct soup *soup, int err);

#endif
