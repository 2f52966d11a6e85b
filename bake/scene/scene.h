/* SPDX-License-Identifier: MIT */
/* A loaded scene: meshes, materials, camera, and the world that rays meet. */
#ifndef INLAY_BAKE_SCENE_SCENE_H
#define INLAY_BAKE_SCENE_SCENE_H

#include "bake/scene/scene_file.h"
#include "bake/sky/fine_list.h"
#include "bake/trace/world.h"
#include "hal/optics/dome.h"
#include "hal/optics/tsai.h"

struct scene {
	char path[INI_PATH_MAX];
	struct scene_file *file;
	struct tsai_camera camera;
	struct v3 eye; /* position of the camera, in world units */
	double ground_albedo[3];
	struct fine_list fine; /* the finer parts of the sky, from the section [dome] */
	int pose;	       /* the meshes are loaded in this pose */
	struct world *world;
	struct mesh meshes[SCENE_MESHES_MAX];
	struct material materials[SCENE_MATERIALS_MAX];
	struct texture *textures[SCENE_MATERIALS_MAX]; /* each material's texture, or NULL */
	uint64_t hash; /* hash of all that was read: scene, meshes, materials, texels, camera */
};

/* Loads a scene in pose 0; the caller closes it. width and height, unless 0, replace the scene's
 * own size, with the same view in more or fewer pixels. Faults name the scene file, the section,
 * and the file that is wrong. */
int scene_open(struct scene **scene, const char *path, int width, int height, struct fault *fault);

/* Loads the meshes of another pose, 0..file->poses.count - 1. The old scene->world is destroyed: a
 * caller must not keep pointers to it. Faults are as above; after one the scene can only be
 * closed. */
int scene_take_pose(struct scene *scene, int pose, struct fault *fault);

/* Loads a pose by its name or number; NULL: the first. -EINVAL: there is no such pose. */
int scene_find_pose(struct scene *scene, const char *pose, struct fault *fault);

void scene_close(struct scene *scene); /* NULL is harmless */

/* Maps a sample, unit in 0..1 each, to its place in the picture, in pixels: in the square of pixel
 * x, y, or beyond it by the camera's edge spread (bake/base/pixel_filter.h). */
void scene_place(const struct scene *scene, int x, int y, const double unit[2], double place[2]);

/* Traces a camera ray through the point x, y of the picture, in pixels. *direction becomes the
 * ray's unit direction. Returns false if it meets nothing. */
bool scene_look(const struct scene *scene, enum presence presence, double x, double y,
		struct surface *surface, struct v3 *direction);

/* Values that replace those of the scene file's section [dome]; -1: the file's value stays. */
struct scene_lights {
	int frequency;
	const char *fine; /* list or file (fine_list.h); NULL: keep; empty: none */
};

/* Creates the dome of the scene's lights. Its errors are those of fine_list_read() and
 * fine_list_dome(). */
int scene_dome(const struct scene *scene, const struct scene_lights *lights, struct dome *dome,
	       struct fault *fault);

/* Writes the camera as INI text, for the basis file. -ENOSPC: text has too little room. */
int scene_camera_text(const struct scene *scene, char *text, size_t room);

#endif
