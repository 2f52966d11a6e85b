/* SPDX-License-Identifier: MIT */
/*
 * Material libraries of OBJ, also with the extension for physically based materials that Blender
 * writes. What a statement means follows its writers:
 *
 *   Kd, map_Kd           the base; a texture without Kd counts as it is
 *   Ks, Ns               illum 0, 1: nothing. illum 3, 8: a mirror that reflects Ks. Else: highlights
 *                        of plastic, a coat that reflects 0.08 Ks head-on. Ns is Phong's exponent, in
 *                        Blender's libraries 1000 (1 - roughness)^2, and Ka there metalness
 *   Pr, Pm, map_Pr/_Pm   roughness and metalness, as in glTF
 *   d, Tr, map_d         coverage
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
};

/* Adds the materials of a file, unless it was the last one, too. -EFBIG: all files together take more than
 * the mesh's budget; -EBADMSG: a statement without its numbers; the fault names file and line. */
int mtl_read(struct mtl_library *library, const char *path, struct budget *budget,
	     struct fault *fault);

/* Returns the number of a material; -1: there is none of this name, in any case of letters. The first
 * one counts, and one that is spelt alike before others. */
int mtl_find(const struct mtl_library *library, struct text_span name);

/* Makes a material, reads its textures, and counts what is left out. */
int mtl_make(const struct mtl_library *library, int number, struct textures *textures,
	     struct material *material, struct left_out *out);

void mtl_free(struct mtl_library *library); /* idempotent */

#endif
