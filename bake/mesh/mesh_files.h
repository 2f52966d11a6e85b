/* SPDX-License-Identifier: MIT */
/*
 * The files of a mesh, as assimp is given them. The text of an OBJ is corrected where assimp
 * misreads it: blanks at the beginning of lines are dropped, and .5 becomes 0.5, which assimp takes
 * for the end of the line. Any other file stays as it is.
 */
#ifndef INLAY_BAKE_MESH_MESH_FILES_H
#define INLAY_BAKE_MESH_MESH_FILES_H

#include <assimp/cfileio.h>

/* Callbacks for aiImportFileEx(). A file that assimp opens by them it must close by them. */
struct aiFileIO mesh_files(void);

#endif
