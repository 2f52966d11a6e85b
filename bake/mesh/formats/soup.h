/* SPDX-License-Identifier: MIT */
/*
 * Collects the polygons of a file as triangles, sorted by material. Corners that agree in all their
 * values become one vertex.
 */
#ifndef INLAY_BAKE_MESH_FORMATS_SOUP_H
#define INLAY_BAKE_MESH_FORMATS_SOUP_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "bake/mesh/left_out.h"
#include "bake/mesh/mesh.h"
#include "hal/base/budget.h"

struct text_span {
	const char *at, *end;
};

/* The lines of a text. They end in "\n", "\r\n" or "\r". */
struct text_lines {
	struct text_span rest;
	int line;     /* number of the line that was taken last; of the first one of joined ones */
	int joined;   /* further lines that were joined to it */
	char *buffer; /* joined lines */
	size_t room;
};

/* Begins behind a byte order mark. */
void text_begin(struct text_lines *lines, const char *at, size_t bytes);

/* Takes the next line; false: there is none. */
bool text_next(struct text_lines *lines, struct text_span *line);

/* The same, where a backslash at the end of a line means that the next line continues it. The line
 * lasts until the next call. Lines too long for the memory end early. */
bool text_next_joined(struct text_lines *lines, struct text_span *line);

void text_end(struct text_lines *lines);

/* Takes the next word from a line; it is empty at the line's end. Blanks and tabs part words. */
struct text_span text_word(struct text_span *line);

/* The rest of a line without the blanks around it: a name. */
struct text_span text_name(struct text_span line);

static inline bool text_empty(struct text_span span)
{
	return span.at == span.end;
}

/* Number of characters that a message quotes. */
int text_shown(struct text_span span);

bool text_is(struct text_span word, const char *text);
bool text_begins(struct text_span line, const char *text);
bool text_is_any_case(struct text_span word, const char *text);

/* The place of a word, in any case, in a list of words with a blank between them, from 0; -1: it is
 * none of them. */
int text_place(struct text_span word, const char *list);

/* Copies a span; NULL: out of memory. */
char *text_copy(struct text_span span);

/* Reads a word that is a number, also nan and inf, which old Windows libraries write as
 * 1.#QNAN, -1.#IND00 or 1.#INF. False: it is none. */
bool text_number(struct text_span word, double *value);

/* Reads the whole number at the beginning of a word, with its sign, and moves word past it. False:
 * there is none, or it is beyond +-2^40. */
bool text_whole(struct text_span *word, int64_t *value);

struct textures {
	struct mesh *mesh; /* which owns them */
	const char
		*mesh_path; /* pictures are beside the file that names them, or beside this one */
	struct fault *fault;
	char **key;	      /* [mesh->texture_count]: what each is made of */
	struct budget budget; /* of the mesh's file and of its pictures */
};

/* A name in a file, for messages and to find the picture. */
struct texture_name {
	const char *by; /* the file; NULL: no picture */
	int line;
	const char *name;
};

/* What two pictures become, either of which may be missing. */
enum texture_kind {
	/* the second is coverage: its alpha if it has one, else its grey; without a first it is
	 * white */
	TEXTURE_OF_COLOURS,
	TEXTURE_OF_SURFACES, /* data: their red values are green and blue, as glTF has roughness and
				metalness; 1 where there is no picture */
	TEXTURE_OF_DATA,     /* the first as it is */
};

/* -ENOENT ...: no such picture, or one that cannot be read; the fault names the line. */
int textures_get(struct textures *textures, enum texture_kind kind,
		 const struct texture_name *first, const struct texture_name *second,
		 enum texture_wrap wrap, const struct texture **texture);

/* Whether a texture of data is one of normals, which is blue, or of something else, such as
 * heights. */
bool texture_has_normals(const struct texture *texture);

void textures_free(struct textures *textures); /* idempotent; leaves the mesh's textures */

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

/*
 * Cuts a polygon into triangles, by ears (Meisters 1975). A corner is looked at again only when a
 * neighbour of it has been cut off, and a grid finds the corners that stand in an ear: n corners of
 * a polygon that does not cross itself take about n log n.
 */

/* Corners in the plane, counter-clockwise. */
bool ears_convex(const double (*at)[2], int count);

/* Writes count - 2 triangles of corner numbers, of the polygon's winding. Corners at one place do
 * not stand in each other's ears: bridges to holes have them. A polygon that crosses itself or has
 * no area is cut anywhere where there is no ear. count >= 3. 0 or -ENOMEM. */
int ears_cut(const double (*at)[2], int count, int (*triangle)[3]);

/*
 * Looks for a file by the name that another one gives it, in this order: by that name, seen from
 * the other's folder; in any case of letters; and by its last part alone beside the other, in any
 * case. Backslashes part folders, too. What is not found under its own name is logged, once. Writes
 * the path. False: there is none.
 */
bool beside_find(const char *other, const char *name, char path[PATH_MAX]);

/*
 * Material libraries of OBJ, also with the extension for physically based materials that Blender
 * writes. What a statement means follows its writers:
 *
 *   Kd, map_Kd           the base; a texture without Kd, or with a black one, counts as it is
 *   Ks, Ns               illum 0, 1: nothing. illum 3, 8: a mirror that reflects Ks. Else:
 *                        highlights of plastic, a coat that reflects 0.08 Ks head-on. Ns is
 *                        Phong's exponent, in Blender's libraries 1000 (1 - roughness)^2, and Ka
 *                        there metalness
 *   Pr, Pm, map_Pr/_Pm   roughness and metalness, as in glTF
 *   d, Tr, map_d         coverage; Tr is 1 - d, or d, as the whole library has it
 *   norm                 normals in tangent space; so is bump, if its picture is blue
 */

struct mtl;

struct mtl_library {
	struct mtl *materials;
	int count;
	int line; /* of the statement that names the file which is read next */
};

/* Adds the materials of a file, unless it was the last one, too. -EFBIG: all files together take
 * more than the mesh's budget; -EBADMSG: a statement without its numbers; the fault names file and
 * line. */
int mtl_read(struct mtl_library *library, const char *path, struct budget *budget,
	     struct fault *fault);

/* Returns the number of a material for a line; -1: there is none of this name, in any case of
 * letters. Of several, one that is spelt alike counts before others, then that of the last file
 * named above the line, then the first. */
int mtl_find(const struct mtl_library *library, struct text_span name, int line);

/* Makes a material, reads its textures, and counts what is left out. */
int mtl_make(const struct mtl_library *library, int number, struct textures *textures,
	     struct material *material, struct left_out *out);

void mtl_free(struct mtl_library *library); /* idempotent */

#endif
