/* SPDX-License-Identifier: MIT */
/* A scene, loaded: meshes, materials, camera and the world that rays meet. */
#ifndef INLAY_BAKE_SCENE_SCENE_H
#define INLAY_BAKE_SCENE_SCENE_H

#include "bake/scene/scene_file.h"
#include "bake/trace/world.h"
#include "hal/optics/dome.h"
#include "hal/optics/tsai.h"

struct scene {
	char path[INI_PATH_MAX];
	struct scene_file *file;
	struct tsai_camera camera;
	struct v3 eye; /* where the camera is */
	double ground_albedo[3];
	int pose; /* that the meshes are in */
	struct world *world;
	struct mesh meshes[SCENE_MESHES_MAX];
	struct material materials[SCENE_MATERIALS_MAX];
	struct texture *textures[SCENE_MATERIALS_MAX]; /* of the materials; NULL for none */
	uint64_t hash; /* of everything read: scene, meshes, materials, texels, camera */
};

/* width and height replace the scene's own size (the same view in more or fewer pixels) unless 0.
 * Faults name scene file and section, and the file that is wrong. */
int scene_open(struct scene **scene, const char *path, int width, int height, struct fault *fault);

/* The scene is in pose 0 when it is opened; here in another of its file->poses.count. Whoever holds
 * its world must forget that. Faults as above; after one it can only be closed. */
int scene_take_pose(struct scene *scene, int pose, struct fault *fault);

/* The same by name or number; NULL: the first. -EINVAL: it has no such pose. */
int scene_find_pose(struct scene *scene, const char *pose, struct fault *fault);

void scene_close(struct scene *scene); /* NULL is harmless */

/* What a camera ray through a point of the picture meets; direction is the ray's. False: nothing.
 */
bool scene_look(const struct scene *scene, enum presence presence, double x, double y,
		struct surface *surface, struct v3 *direction);

/* Which lights: of this frequency, division and shape; -1: as the scene file says. */
struct scene_lights {
	int frequency, division, shape;
};

/* As dome_create_shaped(). */
int scene_dome(const struct scene *scene, const struct scene_lights *lights, struct dome *dome,
	       struct fault *fault);

/* The camera as INI text, for the basis file. */
int scene_camera_text(const struct scene *scene, char *text, size_t room);

#endif
