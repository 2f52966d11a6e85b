/* SPDX-License-Identifier: MIT */
/* The sections [poses] and [keyframe NAME] of a scene file: position, rotation, scale and file of
 * its meshes in each pose. */
#ifndef INLAY_BAKE_SCENE_KEYFRAMES_H
#define INLAY_BAKE_SCENE_KEYFRAMES_H

#include "bake/scene/scene_file.h"

extern const struct ini_key keyframe_poses_keys[]; /* keys of struct scene_poses_values */
extern const struct ini_key keyframe_keys[];	   /* keys of struct scene_keyframe_values */

/* Returns the keyframe of this name, a new one with no value given if there is none: place() of an
 * INI table. NULL: no room. */
struct scene_keyframe_values *keyframe_place(struct scene_file *file, const char *name);

/* Finds the mesh of each keyframe and sorts keyframes by pose. -EINVAL: no such mesh, two keyframes
 * of a mesh at one pose, a pose beyond the last, or a name that is a number. */
int keyframes_settle(struct scene_file *file, const char *path, struct fault *fault);

/*
 * Returns the values of a mesh in a pose, 0..count-1: those of its section, replaced by those that
 * its keyframes give. Position, rotation and scale are interpolated linearly between two keyframes
 * and constant before the first and after the last. The file stays until the next keyframe that
 * names one.
 */
struct scene_mesh_values keyframe_mesh(const struct scene_file *file, int mesh, int pose);

/* Returns the keyframe that names the mesh's file in a pose, or NULL if the mesh's section does. */
const struct scene_keyframe_values *keyframe_of_file(const struct scene_file *file, int mesh,
						     int pose);

/* Returns the name of the first keyframe at a pose, or "" if there is none. */
const char *keyframe_pose_name(const struct scene_file *file, int pose);

/* Returns the pose of this name or number, or -EINVAL. */
int keyframe_find_pose(const struct scene_file *file, const char *text, struct fault *fault);

#endif
