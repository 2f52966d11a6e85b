/* SPDX-License-Identifier: MIT */
/* The line that says what of a mesh file the bake leaves out. */
#include <stdio.h>
#include <string.h>

#include "bake/mesh/left_out.h"
#include "tests/support/captured_log.h"
#include "tests/support/test.h"

TEST("line")
{
	struct left_out out = {.count = 0};
	char text[256];

	assert_string_equal(left_out_text(&out, "a.glb", text, sizeof(text)), "");
	left_out_add(&out, "normal maps", "material");
	left_out_add(&out, "emission", "material");
	left_out_add(&out, "lines", "mesh");
	left_out_add(&out, "normal maps", "material");
	assert_string_equal(
		left_out_text(&out, "a.glb", text, sizeof(text)),
		"a.glb: left out: normal maps of 2 materials, emission of 1, lines of 1 mesh");
	left_out_add(&out, "lines", "mesh");
	assert_non_null(strstr(left_out_text(&out, "a.glb", text, sizeof(text)), "of 2 meshes"));
	assert_string_equal(left_out_text(&out, "a.glb", text, 12), "a.glb: left");
}

TEST("many kinds")
{
	struct left_out out = {.count = 0};
	char text[4096], what[LEFT_OUT_WORD];

	for (int k = 0; k < 100; k++) {
		snprintf(what, sizeof(what), "kind %d", k);
		left_out_add(&out, what, "material");
	}
	left_out_text(&out, "a.glb", text, sizeof(text));
	assert_non_null(strstr(text, ", kind 30 of 1, other things of 69 parts"));
}

TEST("said once")
{
	struct left_out out = {.count = 0};
	struct captured_log log;
	char line[256] = "";
	FILE *said;

	log = captured_log_begin();
	left_out_say(&out, "b.glb");
	left_out_add(&out, "emission", "material");
	left_out_say(&out, "b.glb");
	left_out_say(&out, "b.glb");
	said = captured_log_end(&log);
	assert_non_null(fgets(line, sizeof(line), said));
	assert_non_null(strstr(line, "b.glb: left out: emission of 1 material\n"));
	assert_null(fgets(line, sizeof(line), said));
	fclose(said);
}
