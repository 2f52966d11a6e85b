/* SPDX-License-Identifier: MIT */
/* The files of a mesh as assimp is given them: an OBJ's lines begin without blanks, which assimp
 * does not know, and its numbers have a digit before their point, as it takes .5 for the end of its
 * line. Any other file is as it is. */
#ifndef INLAY_BAKE_MESH_MESH_FILES_H
#define INLAY_BAKE_MESH_MESH_FILES_H

#include <assimp/cfileio.h>

/* For aiImportFileEx(). Whoever opens a file here closes it here. */
struct aiFileIO mesh_files(void);

#endif
