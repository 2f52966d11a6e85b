/* SPDX-License-Identifier: MIT */
/* Scene files: their meaning, and the messages about what is wrong. Meshes of three formats. */
#include <endian.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/scene/scene.h"
#include "tests/support/bake/baked_rows.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define VIEW "[camera]\nposition = 0 -5 2\nlook_at = 0 0 0\nwidth = 16\nheight = 16\n"

static void write_triangle(void)
{
	small_scene_write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
}

/* ---- faults ---- */

static void test_scene_refuse(const char *text, const char *words)
{
	struct fault fault = {.text = ""};
	struct scene *scene = NULL;
	int err;

	small_scene_write("bad.ini", "%s", text);
	err = scene_open(&scene, small_scene_path("bad.ini"), 0, 0, &fault);
	if (!err) {
		scene_close(scene);
		fail_msg("accepted: %s", text);
	}
	if (!strstr(fault.text, words) || !strstr(fault.text, "bad.ini"))
		fail_msg("said \"%s\", expected \"%s\"", fault.text, words);
}

TEST("refused values")
{
	write_triangle();
	test_scene_refuse(VIEW, "no section [object NAME]");
	test_scene_refuse(VIEW "[object a]\n", "file");
	test_scene_refuse(VIEW "[object a]\nfile = tri.obj\nscale = 0\n",
			  "bad.ini:8: [object a] scale");
	test_scene_refuse(VIEW "[object a]\nfile = tri.obj\nscle = 1\n", "scale");
	test_scene_refuse(VIEW "[object a]\nfile = tri.obj\nmaterial = woood\n[material wood]\n",
			  "[material woood], expected perhaps wood");
	test_scene_refuse(VIEW "[dome]\nfrequency = 73\n[object a]\nfile = tri.obj\n", "bad.ini:7");
	test_scene_refuse("[camera]\nwidth = 4\n[object a]\nfile = tri.obj\n", "look_at");
	test_scene_refuse("[camera]\nfile = none.ini\n[object a]\nfile = tri.obj\n", "none.ini");
	test_scene_refuse("[camera]\nposition = 0 -5 -1\n[ground]\n[object a]\nfile = tri.obj\n",
			  "below the ground");
	test_scene_refuse(VIEW "[ground]\nmaterial = m\n[object a]\nfile = tri.obj\n[material m]\n"
			       "kind = glass\n",
			  "expected a diffuse or glossy material");
	test_scene_refuse(VIEW "[ground]\nmaterial = m\n[object a]\nfile = tri.obj\n[material m]\n"
			       "colour = 0 1 1\n",
			  "at least 0.001");
}

TEST("refused files")
{
	test_scene_refuse(VIEW "[object a]\nfile = none.obj\n", "none.obj");
	small_scene_write("empty.obj", "v 0 0 0\nv 1 0 0\n");
	test_scene_refuse(VIEW "[object a]\nfile = empty.obj\n", "empty.obj");
	small_scene_write("noise.obj", "\x01\x02hello");
	test_scene_refuse(VIEW "[object a]\nfile = noise.obj\n", "noise.obj");
	small_scene_write("nan.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
				     "property float y\nproperty float z\nelement face 1\n"
				     "property list uchar int vertex_indices\nend_header\n"
				     "0 0 0\nnan 0 0\n0 0 1\n3 0 1 2\n");
	test_scene_refuse(VIEW "[object a]\nfile = nan.ply\n", "not finite");
	/* without a refusal, later stages would take the NaN for the vertex beside it */
	small_scene_write("nan.obj", "v 0 0 0\nv nan 1 0\nv 1 0 0\nf 1 2 3\n");
	test_scene_refuse(VIEW "[object a]\nfile = nan.obj\n", "not finite");
	small_scene_write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nl 1 2\n");
	test_scene_refuse(VIEW "[object a]\nfile = points.obj\n", "points.obj: no faces");
	small_scene_write("far.obj", "v 400000 0 0\nv 400001 0 0\nv 400000 0 1\nf 1 2 3\n");
	test_scene_refuse(VIEW "[object a]\nfile = far.obj\n", "far.obj: it is 1 across");
	write_triangle();
	test_scene_refuse(
		VIEW "[object a]\nfile = tri.obj\nmaterial = m\n[material m]\ntexture = no.png\n",
		"no.png");
	/* the message names the section with the file, not the one whose mesh it replaces */
	test_scene_refuse(VIEW "[object a]\nfile = tri.obj\n[poses]\ncount = 3\n[keyframe first]\n"
			       "object = a\nfile = none.obj\n",
			  "[keyframe first] file: cannot open");
	test_scene_refuse(VIEW "[object a]\nfile = none.obj\n[poses]\ncount = 3\n[keyframe next]\n"
			       "object = a\npose = 1\nfile = tri.obj\n",
			  "[object a] file: cannot open");
}

/* Writes a glTF file: a triangle, whose node is scaled. */
static void write_scaled(const char *name, const char *scale)
{
	const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
	FILE *stream = fopen(small_scene_path("scaled.bin"), "wb");

	assert_non_null(stream);
	fwrite(corners, sizeof(corners), 1, stream);
	fclose(stream);
	small_scene_write(
		name,
		"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		"\"nodes\":[{\"mesh\":0,\"scale\":[%s,%s,%s]}],\"meshes\":[{\"primitives\":"
		"[{\"attributes\":{\"POSITION\":0}}]}],\"buffers\":[{\"uri\":\"scaled.bin\","
		"\"byteLength\":36}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,0,1]}]}",
		scale, scale, scale);
}

/* Meshes without area, and places too far away. */
TEST("refused shapes")
{
	small_scene_write("line.obj",
			  "v 0 0 0\nv 0.1 0.1 0.1\nv 0.3 0.3 0.3\nv 1 1 1\nf 1 2 3\nf 2 3 4\n"
			  "f 1 1 4\n");
	test_scene_refuse(VIEW "[object a]\nfile = line.obj\n",
			  "line.obj: its faces all have no area");
	write_scaled("point.gltf", "0");
	test_scene_refuse(VIEW "[object a]\nfile = point.gltf\n",
			  "point.gltf: its faces all have no area");
	write_scaled("vast.gltf", "1e38");
	test_scene_refuse(VIEW "[object a]\nfile = vast.gltf\n",
			  "vast.gltf: it reaches 1e+38 world units");
	small_scene_write("away.obj", "v 1e30 0 0\nv 0 1e30 0\nv 0 0 1e30\nf 1 2 3\n");
	test_scene_refuse(VIEW "[object a]\nfile = away.obj\n",
			  "away.obj: it reaches 1e+30 world units");
	/* one face with an area is enough, and so is a scale that brings the mesh back */
	small_scene_write("part.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 1 2\nf 1 2 3\n");
	small_scene_write("part.ini", VIEW "[object a]\nfile = part.obj\n");
	scene_close(small_scene_open("part.ini"));
	small_scene_write("wide.obj", "v 0 0 0\nv 1e10 0 0\nv 0 0 1e10\nf 1 2 3\n");
	test_scene_refuse(VIEW "[object a]\nfile = wide.obj\n",
			  "wide.obj: it reaches 1e+10 world units");
	small_scene_write("wide.ini", VIEW "[object a]\nfile = wide.obj\nscale = 1e-3\n");
	scene_close(small_scene_open("wide.ini"));
}

TEST("refused indices")
{
	static const char head[] = "ply\nformat binary_little_endian 1.0\nelement vertex 3\n"
				   "property float x\nproperty float y\nproperty float z\n"
				   "element face 2\nproperty list uchar int vertex_indices\n"
				   "end_header\n";
	const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
	const uint8_t faces[26] = {3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0,
				   3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0};

	small_scene_write("strange.ply",
			  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
			  "property float y\nproperty float z\nelement face 1\n"
			  "property list uchar int vertex_indices\nend_header\n"
			  "0 0 0\n1 0 0\n0 0 1\n3 0 1 70000\n");
	test_scene_refuse(VIEW "[object a]\nfile = strange.ply\n", "face 1 names vertex 70000");
	for (size_t bytes = 14; bytes < sizeof(faces); bytes++) {
		FILE *stream = fopen(small_scene_path("cut.ply"), "wb");

		assert_non_null(stream);
		fputs(head, stream);
		fwrite(corners, sizeof(corners), 1, stream);
		fwrite(faces, bytes, 1, stream);
		fclose(stream);
		test_scene_refuse(VIEW "[object a]\nfile = cut.ply\n", "cut.ply");
	}
}

#define PLY_VERTICES "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACES(n) "element face " #n "\nproperty list uchar int vertex_indices\n"
#define PLY(n) "ply\nformat ascii 1.0\n" PLY_VERTICES PLY_FACES(n) "end_header\n"
#define PLY_CORNERS "0 0 0\n1 0 0\n0 0 1\n"

static void refuse_ply(const char *text, const char *words)
{
	small_scene_write("bad.ply", "%s", text);
	test_scene_refuse(VIEW "[object a]\nfile = bad.ply\n", words);
}

TEST("refused ply faces")
{
	static const struct {
		const char *line, *words;
	} cases[] = {
		{"", "bad.ply: it ends in face 2, expected 2 of them"},
		{"\n\n", "bad.ply: it ends in face 2"},
		{" \n", "bad.ply:14: face 2 ends here, expected how many"},
		{"0\n", "bad.ply:14: face 2 has \"0\", expected how many"},
		{"-1 0 1 2\n", "bad.ply:14: face 2 has \"-1\", expected how many"},
		{"x\n", "bad.ply:14: face 2 has \"x\", expected how many"},
		{"3 0 1\n", "bad.ply:14: face 2 ends here, expected a number"},
		{"3 0 1", "bad.ply:14: face 2 ends here, expected a number"},
		{"200 0 1 2\n", "bad.ply:14: face 2 ends here, expected a number"},
		{"2 0 1 2\n", "bad.ply:14: face 2 has \"2\" after its vertices"},
		{"3 0 1 x\n", "bad.ply:14: face 2 has \"x\", expected a number"},
		{"3 0 1 1e9\n", "bad.ply:14: face 2 names vertex 1000000000, expected less than 3"},
		{"3 0 1 3\n", "bad.ply:14: face 2 names vertex 3, expected less than 3"},
		{"3 0 1 -1\n", "bad.ply:14: face 2 names vertex -1, expected less than 3"},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		char text[512];

		snprintf(text, sizeof(text), PLY(2) PLY_CORNERS "3 0 1 2\n%s", cases[k].line);
		refuse_ply(text, cases[k].words);
	}
	refuse_ply(PLY(1) "0 0 0\n1 0\n0 0 1\n3 0 1 2\n", "bad.ply:11: vertex 2 ends here");
	refuse_ply(PLY(1) "0 0 0\n1 zero 0\n0 0 1\n3 0 1 2\n", "vertex 2 has \"zero\"");
}

TEST("refused ply headers")
{
	static const char whole[] = PLY(1) PLY_CORNERS "3 0 1 2\n";
	const size_t header = sizeof(PLY(1)) - 1;
	char text[512];

	for (size_t bytes = 4; bytes < header - 1; bytes++) {
		snprintf(text, sizeof(text), "%.*s", (int)bytes, whole);
		refuse_ply(text, bytes < strlen("ply\nformat ascii") ? "expected format ascii"
								     : "no line end_header");
	}
	refuse_ply("ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n",
		   "no line end_header");
	refuse_ply(PLY(2000000000) PLY_CORNERS "3 0 1 2\n",
		   "bad.ply: it ends in face 2, expected 2000000000 of them");
	refuse_ply("ply\nformat binary_big_endian 1.0\nelement vertex 2000000000\n"
		   "property float x\n" PLY_FACES(1) "end_header\n",
		   "bad.ply: its vertices have no x, y and z");
	refuse_ply(PLY(3000000000), "bad.ply:7: element face \"3000000000\", expected a number");
	refuse_ply(PLY(-1), "bad.ply:7: element face \"-1\", expected a number");
	refuse_ply("ply\nformat ascii 1.0\nproperty float x\n" PLY_VERTICES "end_header\n",
		   "bad.ply:3: a property by itself");
	refuse_ply("ply\nformat ascii 1.0\nelement vertex 3\nproperty flaot x\nend_header\n",
		   "bad.ply:4: property of type \"flaot\"");
	refuse_ply("ply\nformat ascii 1.0\nelement vertex 3\nend_header\n",
		   "bad.ply:3: element vertex has no property");
	refuse_ply("ply\nformat ascii 1.0\n" PLY_VERTICES
		   "element face 1\nproperty list float int vertex_indices\nend_header\n",
		   "bad.ply:8: a list counted in float");
	/* bytes of 0, as a power cut leaves them */
	small_scene_write("zeros.ply", "%.*s%c%c", (int)header, whole, 0, 0);
	test_scene_refuse(VIEW "[object a]\nfile = zeros.ply\n", "zeros.ply:10: vertex 1 has");
}

TEST("refused mtl")
{
	small_scene_write("dyes.mtl", "newmtl red\nKd 1 0 0\nnewmtl light blue \r\nKd 0 0 1\n");
	small_scene_write("lost.obj",
			  "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl red\nf 1 2 3\n");
	test_scene_refuse(VIEW "[object a]\nfile = lost.obj\n",
			  "lost.obj:1: mtllib gone.mtl: cannot");
	small_scene_write("rad.obj", "# a\nmtllib dyes.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl rad\n"
				     "f 1 2 3\n");
	test_scene_refuse(VIEW "[object a]\nfile = rad.obj\n",
			  "rad.obj:6: usemtl rad: its libraries");
	/* a library that is replaced need not exist */
	small_scene_write("own.ini",
			  VIEW "[object a]\nfile = lost.obj\nmaterial = m\n[material m]\n");
	scene_close(small_scene_open("own.ini"));
	small_scene_write("blue.obj", "mtllib dyes.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\n"
				      "usemtl light blue\nf 1 2 3\n");
	small_scene_write("blue.ini", VIEW "[object a]\nfile = blue.obj\n");
	scene_close(small_scene_open("blue.ini"));
	/* nor one for meshes without faces */
	small_scene_write("bare.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
	small_scene_write("bare.ini", VIEW "[object a]\nfile = bare.obj\n");
	scene_close(small_scene_open("bare.ini"));
	/* a mesh that names no library has none */
	small_scene_write("none.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nusemtl red\nf 1 2 3\n");
	small_scene_write("none.ini", VIEW "[object a]\nfile = none.obj\n");
	scene_close(small_scene_open("none.ini"));
}

/* ---- meshes ---- */

static void expect_triangle(const char *file)
{
	const struct mesh_placement placement = {.scale = 1, .crease_deg = 60};
	static const float corner[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
	struct fault fault = {.text = ""};
	struct mesh mesh;

	if (mesh_read(&mesh, small_scene_path(file), &placement, &fault) < 0)
		fail_msg("%s", fault.text);
	assert_int_equal(mesh.part_count, 1);
	assert_int_equal(mesh.parts[0].triangles, 1);
	for (int k = 0; k < 3; k++) {
		const float *p = mesh.parts[0].position[mesh.parts[0].index[0][k]];

		for (int axis = 0; axis < 3; axis++)
			expect_below(fabsf(p[axis] - corner[k][axis]), 1e-6f, "k=%d, axis=%d", k,
				     axis);
	}
	mesh_free(&mesh);
}

TEST("formats")
{
	const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
	const uint16_t index[4] = {0, 1, 2, 0};
	FILE *stream;

	write_triangle();
	expect_triangle("tri.obj");
	small_scene_write("tri.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
				     "property float y\nproperty float z\nelement face 1\n"
				     "property list uchar int vertex_indices\nend_header\n"
				     "0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n");
	expect_triangle("tri.ply");
	stream = fopen(small_scene_path("tri.bin"), "wb");
	assert_non_null(stream);
	fwrite(corners, sizeof(corners), 1, stream);
	fwrite(index, sizeof(index), 1, stream);
	fclose(stream);
	small_scene_write(
		"tri.gltf",
		"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		"\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
		"{\"POSITION\":0},\"indices\":1}]}],\"buffers\":[{\"uri\":\"tri.bin\","
		"\"byteLength\":44}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,"
		"\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":"
		"\"VEC3\",\"min\":[0,0,0],\"max\":[1,0,1]},{\"bufferView\":1,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}]}");
	expect_triangle("tri.gltf");
}

/* OBJ files of other programs: no digit before the point, all kinds of blanks and line ends,
 * comments, and points that are no vertices. */
TEST("obj variants")
{
	static const char *const texts[] = {
		"v .0 .0 .0\nv 1. .0 .0\nv .0 0. 1.\nf 1 2 3\n",
		"# .5 .5\r\n\r\nv\t.0\t.0 .0\r\n  v 1 .0 .0e0\r\nv -.0 +.0 1\r\nf 1 2 3\r\n",
		"g .5 .v\nv 0 0 0 .1 .2 .3\nv 1 0 0 .1 .2 .3\nv 0 0 1 .1 .2 .3\nf -3 -2 -1",
		"v 0 0 0\nv 1 0 0\nv 0 0 1\nvt .5 .5\nvn .0 -1 .0\nf -3/1/1 -2/1/1 -1/1/1",
		"v .0\\\n .0 .0\nv 1 .0\\\r\n 0\nv 0 0 1\nf 1 2\\\n 3\n",
		".v .1\nv 0 0 .0\nv 1 0 0\nv 0 0 1\nusemtl .1\nf 1 2 3\n",
	};

	for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++) {
		small_scene_write("variant.obj", "%s", texts[k]);
		expect_triangle("variant.obj");
	}
}

/* PLY files of other programs: other types, elements, line ends and byte orders. */
TEST("ply variants")
{
	static const char *const texts[] = {
		"ply\r\nformat ascii 1.0\r\ncomment by hand\r\nobj_info a 1\r\n"
		"element vertex 3\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
		"element face 1\r\nproperty list uchar int vertex_indices\r\nend_header\r\n"
		"0 0 0\r\n1 0 0\r\n0 0 1\r\n3 0 1 2\r\n",
		"ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty float64 y\n"
		"property float32 z\nproperty uchar red\ncomment of vertices\nelement face 1\n"
		"property list int32 uint32 vertex_index\nproperty int8 flag\nelement edge 1\n"
		"property int vertex1\nproperty int vertex2\nend_header\n"
		"0 0 0 9\n1 0 0 9\n0 0 1e0 9\n3 0 1 2 -5\n0 1\n",
		PLY(1) "0  0\t0 \n 1 0 0\n\n0 0 1\n\n3 0 1 2\n\n   \n",
		PLY(1) PLY_CORNERS "3 0 1 2",
	};
	const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
	const uint8_t colour = 7;

	for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++) {
		small_scene_write("other.ply", "%s", texts[k]);
		expect_triangle("other.ply");
	}
	for (int big = 0; big < 2; big++) {
		FILE *stream = fopen(small_scene_path("other.ply"), "wb");

		assert_non_null(stream);
		fprintf(stream,
			"ply\nformat binary_%s_endian 1.0\n" PLY_VERTICES
			"property uchar red\nelement face 1\n"
			"property list ushort uint vertex_indices\nend_header\n",
			big ? "big" : "little");
		for (int v = 0; v < 3; v++) {
			for (int axis = 0; axis < 3; axis++) {
				uint32_t word;

				memcpy(&word, &corners[3 * v + axis], sizeof(word));
				word = big ? htobe32(word) : htole32(word);
				fwrite(&word, sizeof(word), 1, stream);
			}
			fwrite(&colour, sizeof(colour), 1, stream);
		}
		fwrite(big ? "\0\3" : "\3\0", 2, 1, stream);
		for (uint32_t v = 0; v < 3; v++) {
			const uint32_t word = big ? htobe32(v) : htole32(v);

			fwrite(&word, sizeof(word), 1, stream);
		}
		fclose(stream);
		expect_triangle("other.ply");
	}
}

/* Two squares that meet at an angle, with shared vertices or with vertices of their own. */
static void expect_fold(const char *file, double crease_deg, bool smooth)
{
	const struct mesh_placement placement = {.scale = 1, .crease_deg = crease_deg};
	const float half = sqrtf(0.5f);
	struct fault fault = {.text = ""};
	struct mesh mesh;
	int met = 0;

	if (mesh_read(&mesh, small_scene_path(file), &placement, &fault) < 0)
		fail_msg("%s", fault.text);
	for (int t = 0; t < mesh.parts[0].triangles; t++)
		for (int k = 0; k < 3; k++) {
			const uint32_t v = mesh.parts[0].index[t][k];
			const float *p = mesh.parts[0].position[v];
			const struct v3 n = mesh.parts[0].normal[v];
			/* one square lies in z = 0, the other in y = 0 */
			const bool fold = p[1] == 0 && p[2] == 0, lying = t < 2;
			const float y = fold && smooth ? half : lying ? 0 : 1;
			const float z = fold && smooth ? half : lying ? 1 : 0;

			expect_that(fabsf(n.x) < 1e-5f && fabsf(n.y - y) < 1e-5f &&
					    fabsf(n.z - z) < 1e-5f,
				    "t=%d, k=%d", t, k);
			met += fold;
		}
	assert_int_equal(met, 6);
	mesh_free(&mesh);
}

/* Without normals in the file, crease_deg means the same in every format. */
TEST("creases")
{
	small_scene_write("fold.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n"
				      "f 1 2 3\nf 1 3 4\nf 1 5 2\nf 2 5 6\n");
	small_scene_write("fold.ply", "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\n"
				      "property float y\nproperty float z\nelement face 4\n"
				      "property list uchar int vertex_indices\nend_header\n"
				      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n"
				      "3 0 1 2\n3 0 2 3\n3 0 4 1\n3 1 4 5\n");
	expect_fold("fold.obj", 60, false);
	expect_fold("fold.ply", 60, false);
	expect_fold("fold.ply", 89.9, false);
	expect_fold("fold.obj", 0, false);
	expect_fold("fold.obj", 120, true);
	expect_fold("fold.ply", 120, true);
}

/* The normals of a smooth ball without normals are the ball's, whether vertices are shared or not.
 */
TEST("smooth ball")
{
	const struct mesh_placement placement = {.scale = 1e-4, .crease_deg = 60};
	const int rings = 12;
	struct fault fault = {.text = ""};
	struct mesh mesh;
	FILE *stream;

	stream = fopen(small_scene_path("ball.ply"), "w");
	assert_non_null(stream);
	fprintf(stream,
		"ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
		"property float z\nelement face %d\nproperty list uchar int vertex_indices\n"
		"end_header\n",
		(rings + 1) * 2 * rings, rings * 2 * rings);
	for (int i = 0; i <= rings; i++)
		for (int j = 0; j < 2 * rings; j++) {
			const double theta = M_PI * i / rings, phi = M_PI * j / rings;

			fprintf(stream, "%.6f %.6f %.6f\n", sin(theta) * cos(phi),
				sin(theta) * sin(phi), cos(theta));
		}
	for (int i = 0; i < rings; i++)
		for (int j = 0; j < 2 * rings; j++) {
			const int a = i * 2 * rings + j, b = i * 2 * rings + (j + 1) % (2 * rings);

			fprintf(stream, "4 %d %d %d %d\n", a, a + 2 * rings, b + 2 * rings, b);
		}
	fclose(stream);
	if (mesh_read(&mesh, small_scene_path("ball.ply"), &placement, &fault) < 0)
		fail_msg("%s", fault.text);
	for (int t = 0; t < mesh.parts[0].triangles; t++)
		for (int k = 0; k < 3; k++) {
			const uint32_t v = mesh.parts[0].index[t][k];
			const float *p = mesh.parts[0].position[v];
			const struct v3 n = mesh.parts[0].normal[v];

			/* faces without area, at the poles, have none */
			expect_that(v3_dot(n, n) == 0 ||
					    v3_dot(n, v3_unit(v3_make(p[0], p[1], p[2]))) > 0.999f,
				    "t=%d, k=%d", t, k);
		}
	mesh_free(&mesh);
}

/* Without materials in the file, every format has the same grey. */
TEST("plain grey")
{
	static const char *const files[] = {"tri.obj", "tri.ply", "tri.stl"};
	const struct mesh_placement placement = {
		.scale = 1, .crease_deg = 60, .own_materials = true};

	write_triangle();
	small_scene_write("tri.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
				     "property float y\nproperty float z\nelement face 1\n"
				     "property list uchar int vertex_indices\nend_header\n"
				     "0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n");
	small_scene_write("tri.stl", "solid a\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\n"
				     "vertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\nendsolid a\n");
	for (size_t k = 0; k < sizeof(files) / sizeof(*files); k++) {
		struct fault fault = {.text = ""};
		struct mesh mesh;
		const struct material *m;

		assert_int_equal(mesh_read(&mesh, small_scene_path(files[k]), &placement, &fault),
				 0);
		m = &mesh.materials[mesh.parts[0].material];
		expect_equal(m->kind, MATERIAL_DIFFUSE, "k=%zu", k);
		for (int c = 0; c < 3; c++)
			expect_below(fabsf(m->colour.c[c] - 0.8f), 1e-6f, "k=%zu, c=%d", k, c);
		mesh_free(&mesh);
	}
}

/* One vertex followed by hand: y up to z up, turned, scaled, moved, stood on the ground. */
TEST("placement")
{
	const struct mesh_placement placement = {
		.scale = 2,
		.rotate_deg = {0, 0, 90},
		.position = {10, 20, 30},
		.crease_deg = 60,
		.y_up = true,
		.stand = true,
	};
	struct fault fault = {.text = ""};
	struct mesh mesh;
	const float *p;

	small_scene_write("p.obj", "v 1 5 3\nv 1 6 3\nv 2 5 3\nf 1 2 3\n");
	assert_int_equal(mesh_read(&mesh, small_scene_path("p.obj"), &placement, &fault), 0);
	p = mesh.parts[0].position[mesh.parts[0].index[0][1]];
	/* (1, 6, 3) y up is (1, -3, 6) z up; a quarter turn makes (3, 1, 6); twice as large and
	 * moved (16, 22, 42); the lowest, from y = 5, was at 40 and comes to 0 */
	assert_true(fabsf(p[0] - 16) < 1e-4f);
	assert_true(fabsf(p[1] - 22) < 1e-4f);
	assert_true(fabsf(p[2] - 2) < 1e-4f);
	mesh_free(&mesh);
}

/* A scene moves a mesh in coordinates of a country to its origin. */
TEST("far mesh")
{
	struct fault fault = {.text = ""};
	struct scene *scene = NULL;
	const float *p;

	small_scene_write("far.obj",
			  "v 500000.25 5400123.001 3\nv 500001 5400123 3\nv 500000 5400124 3\n"
			  "f 1 2 3\n");
	small_scene_write("far.ini", "%s",
			  VIEW
			  "[object a]\nfile = far.obj\nup = z\nposition = -500000 -5400123 0\n");
	if (scene_open(&scene, small_scene_path("far.ini"), 0, 0, &fault))
		fail_msg("%s", fault.text);
	p = scene->meshes[0].parts[0].position[0];
	assert_true(fabsf(p[0] - 0.25f) < 1e-6f && fabsf(p[1] - 0.001f) < 1e-6f && p[2] == 3);
	scene_close(scene);
}

static void write_checker(const char *name)
{
	/* red, green above blue, white */
	static const uint8_t texels[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
	struct fault fault = {.text = ""};
	struct image image;

	assert_int_equal(image_create_u8(&image, 2, 2), 0);
	memcpy(image.u8, texels, sizeof(texels));
	assert_int_equal(image_write(small_scene_path(name), &image, &fault), 0);
	image_free(&image);
}

/* A square seen from the front, with v upwards as in OBJ: red is at the upper left. Material from
 * MTL. */
TEST("texture upright")
{
	static const int expect[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
	struct basis basis;

	write_checker("checker.png");
	small_scene_write("sign.mtl", "newmtl sign\nKd 1 1 1\nmap_Kd checker.png\n");
	small_scene_write("sign.obj", "mtllib sign.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n"
				      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl sign\n"
				      "f 1/1 2/2 3/3 4/4\n");
	small_scene_write("sign.ini",
			  "[camera]\nposition = 0 -10 0\nlook_at = 0 0 0\nfield_deg = 11.42\n"
			  "width = 32\nheight = 32\n[dome]\nfrequency = 1\n[render]\n"
			  "samples = 16\n[object sign]\nfile = sign.obj\nup = z\n");
	basis = small_scene_bake("sign.ini");
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++) {
			const double value = baked_object(&basis, k % 2 ? 24 : 8, k / 2 ? 24 : 8, c,
							  NULL);

			/* upright under half a sky: half the light */
			expect_below(fabs(value - 0.5 * expect[k][c]), 0.06, "k=%d, c=%d", k, c);
		}
	basis_close(&basis);
}

/* The texture of a metal is its reflectance; metalness and roughness come from their own texture.
 */
TEST("gltf materials")
{
	static const char gltf[] =
		"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		"\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
		"{\"POSITION\":0},\"material\":0}]}],\"buffers\":[{\"uri\":\"corners.bin\","
		"\"byteLength\":36}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":"
		"\"VEC3\",\"min\":[0,0,0],\"max\":[1,0,1]}],\"images\":[{\"uri\":\"checker.png\"}],"
		"\"textures\":[{\"source\":0}],\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0}%s}}]}";
	const struct mesh_placement placement = {
		.scale = 1, .crease_deg = 60, .own_materials = true};
	const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
	FILE *stream = fopen(small_scene_path("corners.bin"), "wb");

	assert_non_null(stream);
	fwrite(corners, sizeof(corners), 1, stream);
	fclose(stream);
	write_checker("checker.png");
	for (int mapped = 0; mapped < 2; mapped++) {
		struct fault fault = {.text = ""};
		struct mesh mesh;
		struct bsdf red;

		small_scene_write("metal.gltf", gltf,
				  mapped ? ",\"metallicRoughnessTexture\":{\"index\":0}" : "");
		if (mesh_read(&mesh, small_scene_path("metal.gltf"), &placement, &fault) < 0)
			fail_msg("%s", fault.text);
		/* the texel has red alone: no metal, and as smooth as can be */
		red = material_at(&mesh.materials[mesh.parts[0].material], 0.25f, 0.75f);
		expect_below(fabsf(red.alpha - (mapped ? 0.001f : 1)), 1e-5f, "mapped=%d", mapped);
		expect_below(fabsf(red.colour.c[0] - (mapped ? 1 : 0)), 1e-5f, "mapped=%d", mapped);
		expect_below(fabsf(red.specular.c[0] - (mapped ? 0.04f : 1)), 1e-5f, "mapped=%d",
			     mapped);
		expect_below(fabsf(red.specular.c[1] - (mapped ? 0.04f : 0)), 1e-5f, "mapped=%d",
			     mapped);
		mesh_free(&mesh);
	}
}

TEST("mtl materials")
{
	const struct mesh_placement placement = {
		.scale = 1, .crease_deg = 60, .own_materials = true};
	struct fault fault = {.text = ""};
	struct mesh mesh;
	int matt = 0, shiny = 0;

	small_scene_write("m.mtl", "newmtl matt\nKd 0.1 0.2 0.3\nnewmtl shiny\nKd 0.5 0.4 0.3\n"
				   "Ks 0.2 0.2 0.2\nNs 100\nillum 2\n");
	small_scene_write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nusemtl matt\n"
				   "f 1 2 3\nusemtl shiny\nf 2 4 3\n");
	assert_int_equal(mesh_read(&mesh, small_scene_path("m.obj"), &placement, &fault), 0);
	for (int k = 0; k < mesh.part_count; k++) {
		const struct material *m = &mesh.materials[mesh.parts[k].material];

		if (m->kind == MATERIAL_DIFFUSE && fabsf(m->colour.c[2] - 0.3f) < 1e-6f &&
		    fabsf(m->colour.c[0] - 0.1f) < 1e-6f)
			matt++;
		if (m->kind == MATERIAL_GLOSSY && fabsf(m->specular.c[0] - 0.016f) < 1e-6f &&
		    m->roughness > 0.1f && m->roughness < 0.6f)
			shiny++;
	}
	assert_int_equal(matt, 1);
	assert_int_equal(shiny, 1);
	mesh_free(&mesh);
}

/* ---- what the scene says ---- */

/* Orthonormalising a rotation may change its last digit. */
static void expect_camera(const struct tsai_camera *a, const struct tsai_camera *b)
{
	assert_int_equal(a->width, b->width);
	assert_int_equal(a->height, b->height);
	for (int k = 0; k < 9; k++)
		expect_below(fabs(a->rotation[k] - b->rotation[k]), 1e-15, "k=%d", k);
	assert_memory_equal(a->translation, b->translation,
			    sizeof(*a) - offsetof(struct tsai_camera, translation));
}

TEST("camera kinds")
{
	struct scene *look, *tsai, *file;
	char text[4096];

	write_triangle();
	small_scene_write("look.ini", VIEW "[object a]\nfile = tri.obj\n");
	look = small_scene_open("look.ini");
	assert_int_equal(scene_camera_text(look, text, sizeof(text)), 0);
	/* the text in the basis file reads back as the same camera, both ways */
	small_scene_write("cam.ini", "%s", text);
	small_scene_write("file.ini", "[camera]\nfile = cam.ini\n[object a]\nfile = tri.obj\n");
	small_scene_write("tsai.ini", "[tsai]\n%s[object a]\nfile = tri.obj\n",
			  strchr(text, '\n') + 1);
	file = small_scene_open("file.ini");
	tsai = small_scene_open("tsai.ini");
	expect_camera(&look->camera, &file->camera);
	expect_camera(&look->camera, &tsai->camera);
	assert_true(fabsf(look->eye.y + 5) < 1e-5f && fabsf(look->eye.z - 2) < 1e-5f);
	scene_close(look);
	scene_close(file);
	scene_close(tsai);
}

/* The hash depends on what the scene contains, not on where its files lie. */
TEST("hash")
{
	struct scene *a, *b, *c;

	write_triangle();
	small_scene_write("a.ini", VIEW "[object a]\nfile = tri.obj\n");
	small_scene_write("b.ini", "; a comment\n" VIEW "[object a]\nfile = ./tri.obj\n");
	a = small_scene_open("a.ini");
	b = small_scene_open("b.ini");
	small_scene_write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1.25\nf 1 2 3\n");
	c = small_scene_open("a.ini");
	assert_true(a->hash == b->hash);
	assert_true(a->hash != c->hash);
	scene_close(a);
	scene_close(b);
	scene_close(c);
}

/* A camera of one kappa is written and hashed as before there were more terms; more terms are part
 * of both, and come back. */
TEST("terms")
{
	static const char *const more[] = {"", "kappa2 = 0\ntangential = 0 0\n", "kappa2 = 1e-6\n",
					   "kappa3 = 1e-9\n", "tangential = 0 1e-6\n"};
	enum { COUNT = sizeof(more) / sizeof(*more) };
	struct scene *scene[COUNT];
	char plain[4096], text[4096];

	write_triangle();
	small_scene_write("look.ini", VIEW "[object a]\nfile = tri.obj\n");
	scene[0] = small_scene_open("look.ini");
	assert_int_equal(scene_camera_text(scene[0], plain, sizeof(plain)), 0);
	scene_close(scene[0]);
	assert_null(strstr(plain, "kappa2"));
	assert_null(strstr(plain, "tangential"));
	small_scene_write("terms.ini", "[camera]\nfile = cam.ini\n[object a]\nfile = tri.obj\n");
	for (int k = 0; k < COUNT; k++) {
		small_scene_write("cam.ini", "%s%s", plain, more[k]);
		scene[k] = small_scene_open("terms.ini");
		assert_int_equal(scene_camera_text(scene[k], text, sizeof(text)), 0);
		/* all that is not 0 */
		expect_equal(!strstr(text, "kappa2 = "), k != 2, "k=%d", k);
		expect_equal(!strstr(text, "kappa3 = "), k != 3, "k=%d", k);
		expect_equal(!strstr(text, "tangential = "), k != 4, "k=%d", k);
		for (int other = 0; other < k; other++)
			expect_equal(scene[k]->hash == scene[other]->hash, k == 1, "k=%d, %d", k,
				     other);
	}
	for (int k = 0; k < COUNT; k++)
		scene_close(scene[k]);
	small_scene_write("cam.ini", "%skappa2 = -1e-4\n", plain);
	test_scene_refuse("[camera]\nfile = cam.ini\n[object a]\nfile = tri.obj\n",
			  "cam.ini: camera: kappa1, kappa2, kappa3 and tangential fold");
}

TEST_GROUP(small_scene_begin, small_scene_end);
