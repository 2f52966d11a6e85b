/* SPDX-License-Identifier: MIT */
#include "bake/scene/keyframes.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_format.h"

#define TURNS_DEG 36000

_Static_assert(SCENE_POSES_MAX <= BASIS_POSES_MAX, "every pose has room in a basis file");

#define POSES(f) offsetof(struct scene_poses_values, f)
const struct ini_key keyframe_poses_keys[] = {
	{"count", INI_INT, POSES(count), .min = 1, .max = SCENE_POSES_MAX, .fallback = "1",
	 .help = "how many poses the basis file is to hold; [keyframe] says what they differ in"},
	INI_KEYS_END,
};

#define FRAME(f) offsetof(struct scene_keyframe_values, f)
const struct ini_key keyframe_keys[] = {
	{"object", INI_TEXT, FRAME(object),
	 .help = "name of the [object] or [standin] that it is about"},
	{"pose", INI_REAL, FRAME(pose), .max = SCENE_POSES_MAX, .fallback = "0",
	 .help = "when: the number of a pose, from 0, or between two; up to count, where the first one comes again"},
	{"file", INI_PATH, FRAME(file), .fallback = "",
	 .help = "another mesh from here on, until a keyframe names the next; empty: the same"},
	{"scale", INI_REAL, FRAME(scale), .min = 1e-6, .max = 1e6, .fallback = "1",
	 .help = "as of the object; left out: not a keyframe of its scale"},
	{"rotate", INI_REALS, FRAME(rotate_deg), 3, .min = -TURNS_DEG, .max = TURNS_DEG,
	 .fallback = "0 0 0", .unit = "deg",
	 .help = "as of the object, more than one turn too; left out: not a keyframe of its rotation"},
	{"position", INI_REALS, FRAME(position), 3, .min = -SCENE_MESH_FAR, .max = SCENE_MESH_FAR,
	 .fallback = "0 0 0", .unit = "world units",
	 .help = "as of the object; left out: not a keyframe of its position"},
	INI_KEYS_END,
};

struct scene_keyframe_values *keyframe_place(struct scene_file *file, const char *name)
{
	struct scene_keyframe_values *frame;

	for (int k = 0; k < file->keyframe_count; k++)
		if (!strcmp(file->keyframe[k].name, name))
			return &file->keyframe[k];
	if (file->keyframe_count == SCENE_KEYFRAMES_MAX || strlen(name) >= BASIS_POSE_NAME_MAX)
		return NULL;
	frame = &file->keyframe[file->keyframe_count++];
	strcpy(frame->name, name);
	ini_defaults(keyframe_keys, frame);
	frame->scale = NAN;
	for (int axis = 0; axis < 3; axis++)
		frame->rotate_deg[axis] = frame->position[axis] = NAN;
	return frame;
}

/* ---- checks ---- */

static int find_mesh(const struct scene_file *file, const char *name)
{
	for (int k = 0; k < file->mesh_count; k++)
		if (!strcmp(file->mesh[k].name, name))
			return k;
	return -1;
}

static int say_mesh(const struct scene_file *file, const char *path,
		    const struct scene_keyframe_values *frame, struct fault *fault)
{
	const char *names[SCENE_MESHES_MAX], *nearest;

	for (int k = 0; k < file->mesh_count; k++)
		names[k] = file->mesh[k].name;
	nearest = ini_nearest(frame->object, names, (size_t)file->mesh_count);
	return fault_say(
		fault, -EINVAL,
		"%s: [keyframe %s] object: there is no section [object %.64s], expected %s%s", path,
		frame->name, frame->object, nearest ? "perhaps " : "the name of one",
		nearest ? nearest : "");
}

static int by_pose(const void *a, const void *b)
{
	const struct scene_keyframe_values *x = a, *y = b;

	if (x->pose != y->pose)
		return x->pose < y->pose ? -1 : 1;
	return x->order - y->order;
}

static int check_keyframe(const struct scene_file *file, const char *path, int index,
			  struct fault *fault)
{
	const struct scene_keyframe_values *frame = &file->keyframe[index];

	if (frame->pose > file->poses.count)
		return fault_say(
			fault, -EINVAL,
			"%s: [keyframe %s] pose: %g, expected at most %d, the count of [poses]",
			path, frame->name, frame->pose, file->poses.count);
	if (strspn(frame->name, "0123456789") == strlen(frame->name))
		return fault_say(
			fault, -EINVAL,
			"%s: [keyframe %s]: a number, expected a name that no pose's number can be taken for",
			path, frame->name);
	for (int k = 0; k < index; k++)
		if (file->keyframe[k].mesh == frame->mesh && file->keyframe[k].pose == frame->pose)
			return fault_say(
				fault, -EINVAL,
				"%s: [keyframe %s] pose: %g, as [keyframe %s] of the same object; expected another",
				path, frame->name, frame->pose, file->keyframe[k].name);
	return 0;
}

int keyframes_settle(struct scene_file *file, const char *path, struct fault *fault)
{
	int err = 0;

	for (int k = 0; k < file->keyframe_count; k++) {
		struct scene_keyframe_values *frame = &file->keyframe[k];

		frame->order = k;
		frame->mesh = find_mesh(file, frame->object);
		if (frame->mesh < 0)
			return say_mesh(file, path, frame, fault);
	}
	qsort(file->keyframe, (size_t)file->keyframe_count, sizeof(*file->keyframe), by_pose);
	for (int k = 0; k < file->keyframe_count && !err; k++)
		err = check_keyframe(file, path, k, fault);
	return err;
}

/* ---- a pose ---- */

/* Offsets of an attribute's values in a keyframe and in a mesh. */
struct attribute {
	size_t in_frame, in_mesh;
	int count;
};

static const struct attribute attributes[] = {
	{FRAME(scale), offsetof(struct scene_mesh_values, scale), 1},
	{FRAME(rotate_deg), offsetof(struct scene_mesh_values, rotate_deg), 3},
	{FRAME(position), offsetof(struct scene_mesh_values, position), 3},
};

static const double *values_of(const struct scene_keyframe_values *frame,
			       const struct attribute *attribute)
{
	return (const double *)(const void *)((const char *)frame + attribute->in_frame);
}

static void set_attribute(const struct scene_file *file, int mesh, int pose,
			  const struct attribute *attribute, struct scene_mesh_values *out)
{
	const struct scene_keyframe_values *before = NULL, *after = NULL;
	double *to = (double *)(void *)((char *)out + attribute->in_mesh);
	double share = 0;

	for (int k = 0; k < file->keyframe_count && !after; k++) {
		const struct scene_keyframe_values *frame = &file->keyframe[k];

		if (frame->mesh != mesh || isnan(*values_of(frame, attribute)))
			continue;
		if (frame->pose <= pose)
			before = frame;
		else
			after = frame;
	}
	if (before && after)
		share = (pose - before->pose) / (after->pose - before->pose);
	if (!before)
		before = after;
	for (int i = 0; before && i < attribute->count; i++) {
		const double from = values_of(before, attribute)[i];

		to[i] = share > 0 ? from + share * (values_of(after, attribute)[i] - from) : from;
	}
}

const struct scene_keyframe_values *keyframe_of_file(const struct scene_file *file, int mesh,
						     int pose)
{
	const struct scene_keyframe_values *last = NULL;

	for (int k = 0; k < file->keyframe_count && file->keyframe[k].pose <= pose; k++)
		if (file->keyframe[k].mesh == mesh && file->keyframe[k].file[0])
			last = &file->keyframe[k];
	return last;
}

struct scene_mesh_values keyframe_mesh(const struct scene_file *file, int mesh, int pose)
{
	const struct scene_keyframe_values *named = keyframe_of_file(file, mesh, pose);
	struct scene_mesh_values values = file->mesh[mesh];

	for (size_t a = 0; a < sizeof(attributes) / sizeof(*attributes); a++)
		set_attribute(file, mesh, pose, &attributes[a], &values);
	if (named)
		strcpy(values.file, named->file);
	return values;
}

const char *keyframe_pose_name(const struct scene_file *file, int pose)
{
	for (int k = 0; k < file->keyframe_count; k++)
		if (file->keyframe[k].pose == pose)
			return file->keyframe[k].name;
	return "";
}

int keyframe_find_pose(const struct scene_file *file, const char *text, struct fault *fault)
{
	const int count = file->poses.count;
	const bool digits = *text && strspn(text, "0123456789") == strlen(text);
	const long number = digits && strlen(text) < 7 ? atol(text) : count;

	for (int pose = 0; pose < count; pose++)
		if (digits ? pose == number
			   : *text && !strcmp(text, keyframe_pose_name(file, pose)))
			return pose;
	return fault_say(
		fault, -EINVAL,
		"the scene has no pose \"%.64s\", expected a number 0..%d, or the name of a keyframe that stands at one",
		text, count - 1);
}
