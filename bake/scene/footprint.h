/* SPDX-License-Identifier: MIT */
/* What the objects of a scene cover of the ground, seen from above (struct basis_footprint). */
#ifndef INLAY_BAKE_SCENE_FOOTPRINT_H
#define INLAY_BAKE_SCENE_FOOTPRINT_H

#include "bake/mesh/mesh.h"
#include "bake/scene/scene.h"
#include "hal/basis/basis_format.h"

/* Measures meshes. height: the camera's, above which nothing counts, unless nothing is between it and the
 * ground. */
void footprint_measure(const struct mesh *const *meshes, int count, double height,
		       struct basis_footprint *foot);

/* Measures the scene's objects in its pose; stand-ins and the ground are none. */
void footprint_of_scene(const struct scene *scene, struct basis_footprint *foot);

#endif
