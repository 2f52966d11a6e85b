/* SPDX-License-Identifier: MIT */
/* Textures of a mesh that is being read. Those that are asked for again are shared. */
#ifndef INLAY_BAKE_MESH_FORMATS_TEXTURES_H
#define INLAY_BAKE_MESH_FORMATS_TEXTURES_H

#include "bake/mesh/mesh.h"
#include "hal/base/budget.h"

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

#endif
