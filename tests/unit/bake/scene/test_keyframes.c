/* SPDX-License-Identifier: MIT */
/* [poses] and [keyframe NAME] of a scene file. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/scene/keyframes.h"
#include "tests/support/test.h"

#define SCENE                                                                                      \
	"[camera]\nposition = 1 2 3\n[object cow]\nfile = a.obj\nscale = 2\nrotate = 0 0 9\n"      \
	"[standin wall]\nfile = w.obj\n"

static struct scene_file *file;

static int test_keyframes_begin(void **state)
{
	(void)state;
	file = malloc(sizeof(*file));
	return file ? 0 : -1;
}

static int test_keyframes_end(void **state)
{
	(void)state;
	free(file);
	return 0;
}

static void read_scene(const char *text)
{
	struct fault fault = {.text = ""};

	if (scene_file_read_memory(file, text, strlen(text), "s.scene", &fault))
		fail_msg("%s", fault.text);
}

static void test_keyframes_refuse(const char *text, const char *words)
{
	struct fault fault = {.text = ""};

	assert_int_equal(scene_file_read_memory(file, text, strlen(text), "s.scene", &fault),
			 -EINVAL);
	if (!strstr(fault.text, words) || strncmp(fault.text, "s.scene", 7) != 0)
		fail_msg("\"%s\", expected \"s.scene... %s\"", fault.text, words);
}

static void test_keyframes_check(int pose, double scale, double rotate, double x, const char *mesh)
{
	const struct scene_mesh_values v = keyframe_mesh(file, 0, pose);

	if (fabs(v.scale - scale) > 1e-12 || fabs(v.rotate_deg[2] - rotate) > 1e-12 ||
	    fabs(v.position[0] - x) > 1e-12 || !strstr(v.file, mesh))
		fail_msg("pose %d: scale %g, rotate %g, x %g, %s; expected %g, %g, %g, %s", pose,
			 v.scale, v.rotate_deg[2], v.position[0], v.file, scale, rotate, x, mesh);
}

TEST("one pose without keyframes")
{
	read_scene(SCENE);
	assert_int_equal(file->poses.count, 1);
	test_keyframes_check(0, 2, 9, 0, "a.obj");
	assert_string_equal(keyframe_pose_name(file, 0), "");
}

TEST("a turn")
{
	read_scene(SCENE "[poses]\ncount = 36\n[keyframe end]\nobject = cow\npose = 36\n"
			 "rotate = 0 0 348\n[keyframe front]\nobject = cow\nrotate = 0 0 -12\n");
	for (int p = 0; p < 36; p++)
		test_keyframes_check(p, 2, -12 + 10.0 * p, 0, "a.obj");
	assert_string_equal(keyframe_pose_name(file, 0), "front");
	assert_string_equal(keyframe_pose_name(file, 35), "");
	/* the other mesh does not move */
	assert_true(keyframe_mesh(file, 1, 20).rotate_deg[2] == 0);
}

/* Each attribute has keyframes of its own; a file stays until the next keyframe that names one. */
TEST("each attribute by itself")
{
	read_scene(SCENE
		   "[poses]\ncount = 8\n[keyframe a]\nobject = cow\npose = 1\nposition = 1 0 0\n"
		   "[keyframe b]\nobject = cow\npose = 3\nfile = b.obj\nscale = 4\n"
		   "[keyframe c]\nobject = cow\npose = 5\nposition = 3 0 0\nrotate = 0 0 90\n"
		   "[keyframe d]\nobject = cow\npose = 5.5\nscale = 1\nfile = c.obj\n");
	test_keyframes_check(0, 4, 90, 1, "a.obj");
	test_keyframes_check(1, 4, 90, 1, "a.obj");
	test_keyframes_check(3, 4, 90, 2, "b.obj");
	test_keyframes_check(4, 4 - 3 / 2.5, 90, 2.5, "b.obj");
	test_keyframes_check(5, 4 - 6 / 2.5, 90, 3, "b.obj");
	test_keyframes_check(6, 1, 90, 3, "c.obj");
	test_keyframes_check(7, 1, 90, 3, "c.obj");
}

TEST("poses are found")
{
	struct fault fault = {.text = ""};

	read_scene(SCENE "[poses]\ncount = 3\n[keyframe side-2]\nobject = cow\npose = 2\n");
	assert_int_equal(keyframe_find_pose(file, "1", &fault), 1);
	assert_int_equal(keyframe_find_pose(file, "side-2", &fault), 2);
	assert_int_equal(keyframe_find_pose(file, "3", &fault), -EINVAL);
	assert_int_equal(keyframe_find_pose(file, "", &fault), -EINVAL);
	assert_int_equal(keyframe_find_pose(file, "-1", &fault), -EINVAL);
	assert_int_equal(keyframe_find_pose(file, "side", &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "\"side\", expected a number 0..2"));
}

TEST("faults are named")
{
	test_keyframes_refuse(SCENE "[poses]\ncount = 0\n", "s.scene:10: [poses] count");
	test_keyframes_refuse(SCENE "[poses]\ncount = 4097\n", "count");
	test_keyframes_refuse(SCENE "[keyframe a]\npose = 0\n", "s.scene:9: [keyframe a] object");
	test_keyframes_refuse(SCENE "[keyframe a]\nobject = cow\nrotate = 1 2\n",
			      "s.scene:11: [keyframe a] rotate");
	test_keyframes_refuse(SCENE "[keyframe a]\nobject = caw\n", "perhaps cow");
	test_keyframes_refuse(SCENE "[poses]\ncount = 4\n[keyframe a]\nobject = cow\npose = 4.5\n",
			      "[keyframe a] pose: 4.5, expected at most 4");
	test_keyframes_refuse(SCENE "[keyframe a]\nobject = cow\n[keyframe b]\nobject = cow\n",
			      "[keyframe b] pose: 0, as [keyframe a]");
	test_keyframes_refuse(SCENE "[keyframe 12]\nobject = cow\n", "[keyframe 12]: a number");
	test_keyframes_refuse(SCENE "[keyframe a23456789012345678901234567890123]\nobject = cow\n",
			      "keyframe");
}

TEST_GROUP(test_keyframes_begin, test_keyframes_end);
