/* SPDX-License-Identifier: MIT */
/*
 * Small scenes in a temporary folder, and their bakes. small_scene_begin() is the setup of a group
 * of tests, small_scene_end() its teardown; it removes the folder with all that is in it. Names are
 * of files in the folder. Each function fails the test where something goes wrong.
 */
#ifndef INLAY_TESTS_SUPPORT_BAKE_SMALL_SCENE_H
#define INLAY_TESTS_SUPPORT_BAKE_SMALL_SCENE_H

#include "bake/tiles/render.h"
#include "hal/basis/basis.h"

int small_scene_begin(void **state);
int small_scene_end(void **state);

/* Path of a file. The text stays valid for three more calls. */
const char *small_scene_path(const char *name);

/* Writes a text file. */
__attribute__((format(printf, 2, 3))) void small_scene_write(const char *name, const char *format,
							     ...);

/* Writes an OBJ file: a sphere around the origin, Z up, with exact normals that point outward;
 * `rings` rows of faces, twice as many around. */
void small_scene_write_sphere(const char *name, double radius, int rings);

/* The caller closes the scene with scene_close(). */
struct scene *small_scene_open(const char *name);

/* Bakes an open scene into a basis file, with an exact layer. */
struct render_report small_scene_render(struct scene *scene, const char *out, int threads);

/* Bakes a scene into out.inlay and opens that, exact layer only. The caller closes the basis. */
struct basis small_scene_bake(const char *name);

#endif
