/* SPDX-License-Identifier: MIT */
/* Finds how much the camera sees of each mesh of a scene, before anything is baked. */
#ifndef INLAY_BAKE_SCENE_SURVEY_H
#define INLAY_BAKE_SCENE_SURVEY_H

#include <stdio.h>

#include "bake/scene/scene.h"

struct survey_mesh {
	double size[3]; /* extent along X, Y and Z, in world units */
	double share;	/* share of the picture that it fills, 0..1; above 0 if any of it is seen */
	double sunk;	/* share of its height that is below the ground, 0..1 */
	bool inside;	/* the camera is inside of it */
};

/* Surveys the scene in its pose, along at most some 65,000 rays. A mesh that they miss is searched
 * by rays to its triangles. Glass does not hide what is behind it. */
void survey_scene(const struct scene *scene, struct survey_mesh mesh[SCENE_MESHES_MAX]);

/* Writes a line for each object to a stream, unless that is NULL. Warns of objects that are not
 * seen, or half below the ground, and of a camera inside of one. Returns 0, or -ENODATA if there
 * are objects and none is seen. */
int survey_say(const struct scene *scene, FILE *to, struct fault *fault);

#endif
