/* SPDX-License-Identifier: MIT */
/* The part of the ground that a scene's objects cover, seen from above (struct basis_footprint). */
#ifndef INLAY_BAKE_SCENE_FOOTPRINT_H
#define INLAY_BAKE_SCENE_FOOTPRINT_H

#include "bake/mesh/mesh.h"
#include "bake/scene/scene.h"
#include "hal/basis/basis_format.h"

/* Measures meshes up to `height`, the camera's. If nothing is between it and the ground, all of
 * them count. */
void footprint_measure(const struct mesh *const *meshes, int count, double height,
		       struct basis_footprint *foot);

/* Measures the scene's objects, without stand-ins and the ground, in the scene's pose. */
void footprint_of_scene(const struct scene *scene, struct basis_footprint *foot);

#endif
