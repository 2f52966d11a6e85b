/* SPDX-License-Identifier: MIT */
/* Meshes that are closed or not, wound outwards or inwards. */
#include <string.h>

#include "bake/mesh/mesh_winding.h"
#include "bake/scene/scene.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/captured_log.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define CORNERS "v -1 -1 4\nv 1 -1 4\nv 1 1 4\nv -1 1 4\nv -1 -1 6\nv 1 -1 6\nv 1 1 6\nv -1 1 6\n"
#define OUTWARDS "f 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"
#define INWARDS "f 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n"
#define FLOOR_OUTWARDS "f 4 3 2 1\n"
#define FLOOR_INWARDS "f 1 2 3 4\n"

/* Reads a box. Returns how many of its triangles face outwards, of 12 (10 without its floor). */
static int facing_outwards(const char *faces, bool *closed)
{
	const struct mesh_placement placement = {.scale = 1};
	const struct v3 middle = {0, 0, 5};
	struct fault fault = {.text = ""};
	struct mesh mesh;
	int outwards = 0;

	small_scene_write("box.obj", CORNERS "%s", faces);
	expect_success(mesh_read(&mesh, small_scene_path("box.obj"), &placement, &fault), &fault);
	*closed = mesh_is_closed(mesh.parts, mesh.part_count);
	for (int t = 0; t < mesh.parts[0].triangles; t++) {
		const struct v3 a = mesh_corner(&mesh.parts[0], t, 0);
		const struct v3 b = mesh_corner(&mesh.parts[0], t, 1);
		const struct v3 c = mesh_corner(&mesh.parts[0], t, 2);

		outwards += v3_dot(v3_cross(v3_sub(b, a), v3_sub(c, a)), v3_sub(a, middle)) > 0;
	}
	mesh_free(&mesh);
	return outwards;
}

TEST("a closed mesh faces outwards")
{
	bool closed;

	assert_int_equal(facing_outwards(OUTWARDS FLOOR_OUTWARDS, &closed), 12);
	assert_true(closed);
	assert_int_equal(facing_outwards(INWARDS FLOOR_INWARDS, &closed), 12);
	assert_true(closed);
}

/* An open mesh, or one whose faces disagree, has no outer side: it stays. */
TEST("an open mesh stays")
{
	bool closed;

	assert_int_equal(facing_outwards(INWARDS, &closed), 0);
	assert_false(closed);
	assert_int_equal(facing_outwards(OUTWARDS FLOOR_INWARDS, &closed), 10);
	assert_false(closed);
}

/* Opens a scene of a box of glass. Returns whether that is said to be open. */
static bool is_named(const char *file, const char *faces, const char *material)
{
	struct captured_log log;
	char text[512] = "";
	FILE *stream;
	size_t length;

	small_scene_write(file, CORNERS "%s", faces);
	small_scene_write("glass.ini",
			  "[camera]\nposition = 0 -9 2\nlook_at = 0 0 1\n[ground]\n"
			  "[object box]\nfile = %s\nmaterial = m\n[material m]\n%s\n",
			  file, material);
	log = captured_log_begin();
	scene_close(small_scene_open("glass.ini"));
	stream = captured_log_end(&log);
	length = fread(text, 1, sizeof(text) - 1, stream);
	fclose(stream);
	expect_equal(length > 0, strstr(text, file) && strstr(text, "glass that is not closed"),
		     "%s", text);
	return length > 0;
}

TEST("open glass is named")
{
	assert_true(is_named("a.obj", OUTWARDS, "kind = glass"));
	assert_false(is_named("b.obj", OUTWARDS, "kind = glass\nthin = yes"));
	assert_false(is_named("c.obj", OUTWARDS, "kind = glass\nior = 1"));
	assert_false(is_named("d.obj", OUTWARDS, "kind = diffuse"));
	assert_false(is_named("e.obj", OUTWARDS FLOOR_OUTWARDS, "kind = glass"));
}

TEST_GROUP(small_scene_begin, small_scene_end);
