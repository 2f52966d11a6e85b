/* SPDX-License-Identifier: MIT */
/* What the camera will see of each mesh of a scene, before anything is baked. */
#ifndef INLAY_BAKE_SCENE_SURVEY_H
#define INLAY_BAKE_SCENE_SURVEY_H

#include <stdio.h>

#include "bake/scene/scene.h"

struct survey_mesh {
	double size[3]; /* in world units */
	double share;	/* of the picture, 0..1; above 0 if anything of it is seen */
	double sunk;	/* the share of its height that is below the ground, 0..1 */
	bool inside;	/* the camera is inside of it */
};

/* Looks at the scene in its pose, along at most some 65,000 rays; a mesh that they miss is looked for
 * by rays to its triangles. Glass does not hide what is behind it. */
void survey_scene(const struct scene *scene, struct survey_mesh mesh[SCENE_MESHES_MAX]);

/* Writes a line for each object to a stream, unless that is NULL, and warns of objects that are not
 * seen, of those half of which are below the ground, and of a camera inside of one. 0; -ENODATA: there
 * are objects, and nothing of any is seen. */
int survey_say(const struct scene *scene, FILE *to, struct fault *fault);

#endif
