/* SPDX-License-Identifier: MIT */
/* Finds the files that a mesh file names: libraries and pictures. They often came from another
 * computer, where folders and cases of letters were others. */
#ifndef INLAY_BAKE_MESH_FORMATS_BESIDE_H
#define INLAY_BAKE_MESH_FORMATS_BESIDE_H

#include <limits.h>
#include <stdbool.h>

/*
 * Looks for a file by the name that another one gives it, in this order: by that name, seen from
 * the other's folder; in any case of letters; and by its last part alone beside the other, in any
 * case. Backslashes part folders, too. What is not found under its own name is logged, once. Writes
 * the path. False: there is none.
 */
bool beside_find(const char *other, const char *name, char path[PATH_MAX]);

#endif
