/* SPDX-License-Identifier: MIT */
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
#ifndef INLAY_BAKE_MESH_FORMATS_MTL_H
#define INLAY_BAKE_MESH_FORMATS_MTL_H

#include "bake/mesh/formats/text.h"
#include "bake/mesh/formats/textures.h"
#include "bake/mesh/left_out.h"

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
