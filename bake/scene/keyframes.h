/* SPDX-License-Identifier: MIT */
/* [poses] and [keyframe NAME] of a scene file: where its meshes stand in each pose. */
#ifndef INLAY_BAKE_SCENE_KEYFRAMES_H
#define INLAY_BAKE_SCENE_KEYFRAMES_H

#include "bake/scene/scene_file.h"

extern const struct ini_key keyframe_poses_keys[]; /* of struct scene_poses_values */
extern const struct ini_key keyframe_keys[];	   /* of struct scene_keyframe_values */

/* What a section fills, its values not given (INI tables' place()). NULL: no room for one more. */
struct scene_keyframe_values *keyframe_place(struct scene_file *file, const char *name);

/* Finds the mesh of each keyframe and puts them in the order of poses. -EINVAL: no such mesh, two
 * keyframes of a mesh at one pose, a pose beyond the last, a name that cannot be a pose's. */
int keyframes_settle(struct scene_file *file, const char *path, struct fault *fault);

/*
 * A mesh as it is in a pose, 0..count-1: the values of its section, in their place those of its
 * keyframes. Between two keyframes position, rotation and scale go along straight lines; before the
 * first and after the last they stay; a mesh's file stays until the next keyframe that names one.
 */
struct scene_mesh_values keyframe_mesh(const struct scene_file *file, int mesh, int pose);

/* The keyframe that a mesh's file is from in a pose; NULL: its own section. */
const struct scene_keyframe_values *keyframe_of_file(const struct scene_file *file, int mesh,
						     int pose);

/* The name of a pose: that of the first keyframe that stands there; "": none has one. */
const char *keyframe_pose_name(const struct scene_file *file, int pose);

/* The pose of that name or number, or -EINVAL. */
int keyframe_find_pose(const struct scene_file *file, const char *text, struct fault *fault);

#endif
