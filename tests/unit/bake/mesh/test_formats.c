/* SPDX-License-Identifier: MIT */
/* The geometry of OBJ, PLY and STL as various programs write them. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/mesh.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/captured_log.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static const struct mesh_placement as_it_is = {.scale = 1, .crease_deg = 60, .own_materials = 1};

static void read_fine(const char *name, struct mesh *mesh)
{
	struct fault fault = {.text = ""};

	if (mesh_read(mesh, small_scene_path(name), &as_it_is, &fault) < 0)
		fail_msg("%s", fault.text);
}

static void refuse(const char *name, int err, const char *words)
{
	struct fault fault = {.text = ""};
	struct mesh mesh;

	expect_equal(mesh_read(&mesh, small_scene_path(name), &as_it_is, &fault), err, "%s: %s",
		     words, fault.text);
	if (!strstr(fault.text, words))
		fail_msg("said \"%s\", expected \"%s\"", fault.text, words);
	mesh_free(&mesh);
}

/* Sums of the areas of triangles, with their signs along Z: no overlap and no hole where both are
 * the polygon's. */
static void expect_area(const struct mesh *mesh, double area)
{
	double all = 0, signs = 0;

	for (int p = 0; p < mesh->part_count; p++)
		for (int t = 0; t < mesh->parts[p].triangles; t++) {
			const struct v3 a = mesh_corner(&mesh->parts[p], t, 0);
			const struct v3 across =
				v3_cross(v3_sub(mesh_corner(&mesh->parts[p], t, 1), a),
					 v3_sub(mesh_corner(&mesh->parts[p], t, 2), a));

			all += 0.5 * (double)v3_length(across);
			signs += 0.5 * (double)across.z;
		}
	expect_below(fabs(all - fabs(area)), 1e-4, "all=%g", all);
	expect_below(fabs(signs - area), 1e-4, "signs=%g", signs);
}

static int triangles_of(const struct mesh *mesh)
{
	int count = 0;

	for (int p = 0; p < mesh->part_count; p++)
		count += mesh->parts[p].triangles;
	return count;
}

/* The material and the colour of the vertices at a corner of a triangle. */
static struct rgb colour_of(const struct mesh *mesh, int part, int triangle, int corner)
{
	const struct mesh_part *from = &mesh->parts[part];
	const uint32_t v = from->index[triangle][corner];
	struct material_point point = {.colour = {{1, 1, 1}}, .alpha = 1};

	if (from->uv)
		memcpy(point.uv[0], from->uv[v], sizeof(point.uv[0]));
	if (from->colour)
		memcpy(point.colour.c, from->colour[v], sizeof(point.colour.c));
	return material_at_point(&mesh->materials[from->material], &point).colour;
}

static void expect_colour(struct rgb got, float r, float g, float b)
{
	expect_below(fabsf(got.c[0] - r), 2e-3f, "red=%g", (double)got.c[0]);
	expect_below(fabsf(got.c[1] - g), 2e-3f, "green=%g", (double)got.c[1]);
	expect_below(fabsf(got.c[2] - b), 2e-3f, "blue=%g", (double)got.c[2]);
}

/* ---- polygons ---- */

TEST("concave polygons")
{
	static const struct {
		const char *corners, *face;
		int triangles;
		double area;
	} cases[] = {
		/* an arrow whose dent is nearer to its tail than to its wings, from each corner */
		{"v 0 0 0\nv 4 -3 0\nv 3 0 0\nv 4 3 0\n", "1 2 3 4", 2, 9},
		{"v 0 0 0\nv 4 -3 0\nv 3 0 0\nv 4 3 0\n", "2 3 4 1", 2, 9},
		{"v 0 0 0\nv 4 -3 0\nv 3 0 0\nv 4 3 0\n", "4 3 2 1", 2, -9},
		/* a comb */
		{"v 0 0 0\nv 5 0 0\nv 5 3 0\nv 4 3 0\nv 4 1 0\nv 3 1 0\nv 3 3 0\nv 2 3 0\nv 2 1 0\n"
		 "v 1 1 0\nv 1 3 0\nv 0 3 0\n",
		 "1 2 3 4 5 6 7 8 9 10 11 12", 10, 11},
		/* a square with a hole and a bridge to it */
		{"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n",
		 "1 2 3 4 1 5 6 7 8 5", 8, 12},
		{"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n", "1 2 3 4", 2, 1},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct mesh mesh;

		small_scene_write("polygon.obj", "%sf %s\n", cases[k].corners, cases[k].face);
		read_fine("polygon.obj", &mesh);
		expect_equal(triangles_of(&mesh), cases[k].triangles, "k=%zu", k);
		expect_area(&mesh, cases[k].area);
		mesh_free(&mesh);
	}
}

/* A star of many points, and a polygon that crosses itself everywhere: with the square of the
 * corners, these take minutes. */
TEST("large polygons")
{
	enum { CORNERS = 40000 };
	static const char *const names[] = {"star.obj", "crossed.obj"};

	for (int k = 0; k < 2; k++) {
		FILE *file = fopen(small_scene_path(names[k]), "w");
		uint64_t random = 1;
		struct mesh mesh;

		assert_non_null(file);
		for (int c = 0; c < CORNERS; c++) {
			const double angle = 2 * M_PI * c / CORNERS, radius = c % 2 ? 1 : 0.5;

			random = random * 6364136223846793005u + 1442695040888963407u;
			if (k == 0)
				fprintf(file, "v %.9f %.9f 0\n", radius * cos(angle),
					radius * sin(angle));
			else
				fprintf(file, "v %u %u 0\n", (unsigned)(random >> 50),
					(unsigned)(random >> 36) & 0x3fff);
		}
		fprintf(file, "f");
		for (int c = 1; c <= CORNERS; c++)
			fprintf(file, " %d", c);
		fclose(file);
		read_fine(names[k], &mesh);
		expect_equal(triangles_of(&mesh), CORNERS - 2, "k=%d", k);
		if (k == 0)
			expect_area(&mesh, CORNERS / 4.0 * sin(2 * M_PI / CORNERS));
		mesh_free(&mesh);
	}
}

/* Each corner at the tip of a cone has the mean of the faces within the crease: a quarter of the
 * circle on both sides, so that the normal is as the face's, but steeper. */
TEST("large fan")
{
	enum { SIDES = 200000 };
	FILE *file = fopen(small_scene_path("cone.obj"), "w");
	/* faces at an angle t around the axis have a cosine of (1 + cos t) / 2 */
	const double reach = acos(2 * cos(60 * M_PI / 180) - 1);
	const double out = sin(reach) / reach, steep = 1 / hypot(1, out);
	struct mesh mesh;

	assert_non_null(file);
	fprintf(file, "v 0 0 1\n");
	for (int k = 0; k < SIDES; k++)
		fprintf(file, "v %.9f %.9f 0\n", cos(2 * M_PI * k / SIDES),
			sin(2 * M_PI * k / SIDES));
	for (int k = 0; k < SIDES; k++)
		fprintf(file, "f 1 %d %d\n", k + 2, (k + 1) % SIDES + 2);
	fclose(file);
	read_fine("cone.obj", &mesh);
	for (int t = 0; t < SIDES; t += 1000) {
		const struct mesh_part *part = &mesh.parts[0];
		const struct v3 normal = part->normal[part->index[t][0]];
		const double angle = 2 * M_PI * (t + 0.5) / SIDES;

		expect_below(fabs((double)normal.z - steep), 5e-3, "t=%d", t);
		expect_below(fabs((double)normal.x - out * steep * cos(angle)), 5e-3, "t=%d", t);
		expect_below(fabs((double)normal.y - out * steep * sin(angle)), 5e-3, "t=%d", t);
	}
	mesh_free(&mesh);
}

/* ---- OBJ ---- */

TEST("obj corners")
{
	struct mesh mesh;

	/* a byte order mark, faces before their vertices, comments, some corners without normals */
	small_scene_write("corners.obj",
			  "\xef\xbb\xbf"
			  "f 1/1/1 2/2/1 3/3/1 # first\nv 0 0 0\nv 1 0 0\nv 0 1 0 # c\n"
			  "vt .25 .5\nvt 0 0 0\nvt 1 nan\nvn 0 0 2\nv 1 1 0\n"
			  "f -3//-1 -1// -2\np 1\n");
	read_fine("corners.obj", &mesh);
	expect_area(&mesh, 1);
	assert_int_equal(mesh.part_count, 2);
	assert_int_equal(mesh.parts[0].vertices, 3);
	expect_below(fabsf(mesh.parts[0].uv[0][0] - 0.25f), 1e-6f, "%d", 0);
	expect_below(fabsf(mesh.parts[0].normal[0].z - 1), 1e-6f, "%d", 0);
	expect_below(fabsf(mesh.parts[1].normal[0].z - 1), 1e-6f, "%d", 1);
	assert_null(mesh.parts[1].uv);
	mesh_free(&mesh);
}

TEST("obj refused")
{
	static const struct {
		const char *lines, *words;
		int err;
	} cases[] = {
		{"f 1 2 4", "bad.obj:4: face names vertex 4, but there are 3", -EBADMSG},
		{"f 1 2 0", "bad.obj:4: face names vertex 0, expected 1 or more", -EBADMSG},
		{"f -1 -2 -4", "bad.obj:4: face names vertex -4", -EBADMSG},
		{"f 1/1 2/1 3/1", "bad.obj:4: face names texture coordinate 1", -EBADMSG},
		{"f 1//1 2//1 3//1", "bad.obj:4: face names normal 1", -EBADMSG},
		{"f 1 2 three", "bad.obj:4: f has \"three\"", -EBADMSG},
		{"f 1 2 3x", "bad.obj:4: f has \"3x\"", -EBADMSG},
		{"f 1 2 99999999999999999999", "bad.obj:4: f has", -EBADMSG},
		{"f", "bad.obj:4: f has no vertices", -EBADMSG},
		{"v 1 2 x", "bad.obj:4: vertex has \"x\", expected a number", -EBADMSG},
		{"v 1 2", "bad.obj:4: vertex has \"\", expected a number", -EBADMSG},
		{"v 1 2 inf", "bad.obj:4: vertex 4 is not finite", -EDOM},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		small_scene_write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n%s\nf 1 2 3\n",
				  cases[k].lines);
		refuse("bad.obj", cases[k].err, cases[k].words);
	}
	/* joined lines count as many */
	small_scene_write("bad.obj", "v 0 0 \\\n0\nv 1 0 0\nv 0 1 x\n");
	refuse("bad.obj", -EBADMSG, "bad.obj:4: vertex has \"x\"");
	/* an archive that holds an OBJ as it is */
	small_scene_write("bad.obj", "PK%c\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", '\0');
	refuse("bad.obj", -EBADMSG, "bad.obj: holds a zero byte, expected the text of an OBJ");
}

/* Digits of a coordinate are read as strtod() does. */
TEST("obj numbers")
{
	static const char *const numbers[] = {
		"0.1",		 "123456.789",	  "-1e-3", "3.14159265358979323846",
		"1.17549435e-3", ".000123456789", "+2.5",  "1000000000000000e-15"};

	for (size_t k = 0; k < sizeof(numbers) / sizeof(*numbers); k++) {
		const float expected = strtof(numbers[k], NULL);
		struct mesh mesh;
		float last;

		small_scene_write("number.obj", "v 0 0 0\nv 1 0 0\nv 0 %s 1\nf 1 2 3\n",
				  numbers[k]);
		read_fine("number.obj", &mesh);
		last = mesh_corner(&mesh.parts[0], 0, 2).y;
		assert_memory_equal(&last, &expected, sizeof(last));
		mesh_free(&mesh);
	}
}

TEST("obj colours")
{
	struct mesh mesh;

	small_scene_write("scan.obj", "v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 0 1 0 1 0.5 0\n"
				      "v 1 1 0\nf 1 2 3\nf 2 3 4\n");
	read_fine("scan.obj", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 0), 1, 0.2140f, 0);
	expect_colour(colour_of(&mesh, 0, 1, 2), 1, 1, 1);
	mesh_free(&mesh);
	small_scene_write("scan.obj", "v 0 0 0 255 51 0\nv 1 0 0 255 51 0\nv 0 1 0 255 51 0\n"
				      "f 1 2 3\n");
	read_fine("scan.obj", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 0), 1, 0.0331f, 0);
	mesh_free(&mesh);
}

/* Colours of ZBrush, in comments behind a mask. */
TEST("obj painted")
{
	struct mesh mesh;

	small_scene_write("z.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff8000ff00ff00\n"
				   "#MRGB 00000033\nf 1 2 3\n");
	read_fine("z.obj", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 0), 1, 0.2158f, 0);
	expect_colour(colour_of(&mesh, 0, 0, 1), 0, 1, 0);
	expect_colour(colour_of(&mesh, 0, 0, 2), 0, 0, 0.0331f);
	mesh_free(&mesh);
}

/* Coordinates of a country, in which a float has steps of half a metre: millimetres reach the world
 * where the placement brings the mesh near, and a word is said where they cannot. */
TEST("far positions")
{
	static const char *const names[] = {"far.obj", "far.ply", "far.stl"};
	struct mesh_placement near = as_it_is;
	struct captured_log log;
	struct mesh mesh;
	char line[512] = "";
	FILE *said;

	near.position[0] = -500000;
	near.position[1] = -5400100;
	near.stand = 1;
	small_scene_write("far.obj", "v -1e9 0 7\nv 500000.125 5400123.001 100\n"
				     "v 500001.125 5400123.002 101\nv 500000.125 5400124.003 101\n"
				     "f 2 3 4\n");
	small_scene_write("far.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
				     "property double y\nproperty double z\nelement face 1\n"
				     "property list uchar int vertex_indices\nend_header\n"
				     "500000.125 5400123.001 100\n500001.125 5400123.002 101\n"
				     "500000.125 5400124.003 101\n3 0 1 2\n");
	small_scene_write("far.stl", "solid s\nfacet normal 0 0 1\nouter loop\n"
				     "vertex 500000.125 5400123.001 100\n"
				     "vertex 500001.125 5400123.002 101\n"
				     "vertex 500000.125 5400124.003 101\nendloop\nendfacet\n");
	for (int k = 0; k < 3; k++) {
		struct fault fault = {.text = ""};
		const struct v3 *p;

		if (mesh_read(&mesh, small_scene_path(names[k]), &near, &fault) < 0)
			fail_msg("%s", fault.text);
		p = (struct v3[]){mesh_corner(&mesh.parts[0], 0, 0),
				  mesh_corner(&mesh.parts[0], 0, 2)};
		expect_below(fabsf(p[0].x - 0.125f), 1e-5f, "k=%d", k);
		expect_below(fabsf(p[0].y - 23.001f), 1e-5f, "k=%d", k);
		expect_below(fabsf(p[0].z), 1e-6f, "k=%d", k);
		expect_below(fabsf(p[1].y - 24.003f), 1e-5f, "k=%d", k);
		expect_below(fabsf(p[1].z - 1), 1e-6f, "k=%d", k);
		assert_int_equal(mesh.parts[0].vertices, 3);
		mesh_free(&mesh);
	}
	small_scene_write("far.obj", "v 500000.125 5400123.001 0\nv 500050.1 5400123.002 0\n"
				     "v 500000.125 5400173 0\nf 1 2 3\n");
	log = captured_log_begin();
	read_fine("far.obj", &mesh);
	said = captured_log_end(&log);
	assert_true(fread(line, 1, sizeof(line) - 1, said) > 0);
	fclose(said);
	if (!strstr(line, "move it to the origin by position = -500025"))
		fail_msg("%s", line);
	mesh_free(&mesh);
}

/* ---- PLY ---- */

#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define SQUARE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

TEST("ply kinds")
{
	static const char *const texts[] = {
		/* faces first, comments anywhere, another element between */
		"ply\ncomment by hand\nformat ascii 1.0\nobj_info 1 2\nelement face 1\n"
		"property uchar flags\nproperty list uchar int vertex_index\nelement thing 2\n"
		"property list int8 double what\nproperty short k\nelement vertex 4\n" XYZ
		"comment end\nend_header\n7 4 0 1 2 3\n2 .5 .5 1\n0 2\n" SQUARE,
		/* strips, with restarts; each second triangle is turned */
		"ply\nformat ascii 1.0\nelement vertex 4\n" XYZ "element tristrips 1\n"
		"property list int int vertex_indices\nend_header\n" SQUARE "4 0 1 3 2\n",
		"ply\nformat ascii 1.0\nelement vertex 4\n" XYZ "element tristrips 1\n"
		"property list int int vertex_indices\nend_header\n" SQUARE "7 0 1 3 -1 3 1 2\n",
		"ply\rformat ascii 1.0\relement vertex 4\rproperty double x\rproperty double y\r"
		"property double z\relement face 1\rproperty list uint ushort vertex_indices\rend_header\r0 0 0\r1 0 0\r1 1 0\r0 1 0\r4 0 1 2 3\r",
	};

	for (size_t k = 0; k < sizeof(texts) / sizeof(*texts); k++) {
		struct mesh mesh;

		small_scene_write("kind.ply", "%s", texts[k]);
		read_fine("kind.ply", &mesh);
		assert_int_equal(triangles_of(&mesh), 2);
		expect_area(&mesh, 1);
		mesh_free(&mesh);
	}
}

/* Data that begin with the byte of a line's end, after a header whose lines end in "\r". */
TEST("ply binary line end")
{
	static const uint8_t corners[] = {10, 0, 0, 1, 0, 0, 0, 1, 10, 3, 0, 1, 2};
	struct mesh mesh;
	FILE *stream = fopen(small_scene_path("end.ply"), "wb");

	assert_non_null(stream);
	fputs("ply\rformat binary_big_endian 1.0\relement vertex 3\rproperty char x\r"
	      "property uchar y\rproperty int8 z\relement face 1\rproperty list uchar uchar vertex_indices\rend_header\r",
	      stream);
	fwrite(corners, sizeof(corners), 1, stream);
	fclose(stream);
	read_fine("end.ply", &mesh);
	expect_below(fabsf(mesh_corner(&mesh.parts[0], 0, 0).x - 10), 1e-6f, "%d", 0);
	expect_below(fabsf(mesh_corner(&mesh.parts[0], 0, 2).z - 10), 1e-6f, "%d", 2);
	mesh_free(&mesh);
}

TEST("ply colours")
{
	static const struct {
		const char *type, *row;
	} wide[] = {{"int", "255 51 0"},
		    {"uint", "65535 13107 0"},
		    {"uint", "4294967295 858993459 0"},
		    {"ushort", "255 51 0"},
		    {"ushort", "65535 13107 0"},
		    {"short", "32767 6553 0"},
		    {"float", "255.0 51.0 0"},
		    {"double", "1.0 0.2 0"},
		    {"float", "65535 13107 0"}};
	struct mesh mesh;

	small_scene_write("c.ply", "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
				   "property uchar red\nproperty uchar green\nproperty uchar blue\n"
				   "element face 1\nproperty list uchar int vertex_indices\n"
				   "end_header\n0 0 0 255 51 0\n1 0 0 0 0 0\n1 1 0 0 0 0\n"
				   "0 1 0 0 0 0\n4 0 1 2 3\n");
	read_fine("c.ply", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 0), 1, 0.0331f, 0);
	expect_colour(colour_of(&mesh, 0, 0, 1), 0, 0, 0);
	mesh_free(&mesh);
	/* types that could hold more than bytes */
	for (size_t k = 0; k < sizeof(wide) / sizeof(*wide); k++) {
		small_scene_write("c.ply",
				  "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
				  "property %s red\nproperty %s green\nproperty %s blue\n"
				  "element face 1\nproperty list uchar int vertex_indices\n"
				  "end_header\n0 0 0 %s\n1 0 0 0 0 0\n1 1 0 0 0 0\n"
				  "0 1 0 0 0 0\n4 0 1 2 3\n",
				  wide[k].type, wide[k].type, wide[k].type, wide[k].row);
		read_fine("c.ply", &mesh);
		expect_colour(colour_of(&mesh, 0, 0, 0), 1, 0.0331f, 0);
		mesh_free(&mesh);
	}
	/* alpha of another type, which is full */
	small_scene_write("c.ply",
			  "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ
			  "property uchar red\nproperty uchar green\nproperty uchar blue\n"
			  "property float alpha\nelement face 1\n"
			  "property list uchar int vertex_indices\nend_header\n0 0 0 1 1 1 1\n"
			  "1 0 0 0 0 0 1\n1 1 0 0 0 0 1\n0 1 0 0 0 0 1\n4 0 1 2 3\n");
	read_fine("c.ply", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 0), 0.0003f, 0.0003f, 0.0003f);
	mesh_free(&mesh);
	/* of faces, and as shares of 1 */
	small_scene_write("c.ply",
			  "ply\nformat ascii 1.0\nelement vertex 4\n" XYZ "element face 2\n"
			  "property list uchar int vertex_indices\nproperty float red\n"
			  "property float green\nproperty float blue\nend_header\n" SQUARE
			  "3 0 1 2 1 0 0\n3 0 2 3 0 .5 1\n");
	read_fine("c.ply", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 2), 1, 0, 0);
	expect_colour(colour_of(&mesh, 0, 1, 0), 0, 0.2140f, 1);
	mesh_free(&mesh);
}

static void write_halves(const char *name)
{
	/* left red, right green */
	static uint8_t texels[6] = {255, 0, 0, 0, 255, 0};
	const struct image image = {.width = 2, .height = 1, .u8 = texels};
	struct fault fault = {.text = ""};

	assert_int_equal(image_write(small_scene_path(name), &image, &fault), 0);
}

/* Texture coordinates of faces, of vertices, and several textures. */
TEST("ply textures")
{
	struct mesh mesh;

	write_halves("halves.png");
	small_scene_write("w.ply",
			  "ply\nformat ascii 1.0\ncomment TextureFile C:\\scan\\Halves.PNG\n"
			  "element vertex 4\n" XYZ "element face 2\n"
			  "property list uchar int vertex_indices\n"
			  "property list uchar float texcoord\nproperty int texnumber\n"
			  "end_header\n" SQUARE "3 0 1 2 6 .25 0 .25 0 .25 0 0\n"
			  "3 0 2 3 6 .75 0 .75 0 .75 0 0\n");
	read_fine("w.ply", &mesh);
	for (int k = 0; k < 3; k++) {
		expect_colour(colour_of(&mesh, 0, 0, k), 1, 0, 0);
		expect_colour(colour_of(&mesh, 0, 1, k), 0, 1, 0);
	}
	mesh_free(&mesh);
	small_scene_write("s.ply",
			  "ply\nformat ascii 1.0\ncomment TextureFile halves.png\n"
			  "element vertex 4\n" XYZ "property float s\nproperty float t\n"
			  "property uchar red\nproperty uchar green\nproperty uchar blue\n"
			  "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
			  "0 0 0 .25 0 9 9 9\n1 0 0 .75 0 9 9 9\n1 1 0 .75 0 9 9 9\n"
			  "0 1 0 .25 0 9 9 9\n4 0 1 2 3\n");
	read_fine("s.ply", &mesh);
	expect_colour(colour_of(&mesh, 0, 0, 0), 1, 0, 0);
	expect_colour(colour_of(&mesh, 0, 0, 1), 0, 1, 0);
	mesh_free(&mesh);
	small_scene_write("w.ply", "ply\nformat ascii 1.0\ncomment TextureFile gone.png\n"
				   "element vertex 3\n" XYZ "property float s\nproperty float t\n"
				   "element face 1\nproperty list uchar int vertex_indices\n"
				   "end_header\n0 0 0 0 0\n1 0 0 0 0\n1 1 0 0 0\n3 0 1 2\n");
	refuse("w.ply", -ENOENT, "w.ply:3: there is no picture gone.png");
}

/* ---- STL ---- */

static void write_stl(const char *name, const char *header, uint32_t count, uint32_t written,
		      const char *tail)
{
	FILE *stream = fopen(small_scene_path(name), "wb");
	char head[80] = "";

	assert_non_null(stream);
	snprintf(head, sizeof(head), "%s", header);
	fwrite(head, sizeof(head), 1, stream);
	fwrite(&count, sizeof(count), 1, stream);
	for (uint32_t k = 0; k < written; k++) {
		const float x = (float)k;
		const float values[12] = {0, 0, 1, x, 0, 0, x + 1, 0, 0, x, 1, 0};
		const uint16_t colour = 0x8000;

		fwrite(values, sizeof(values), 1, stream);
		fwrite(&colour, sizeof(colour), 1, stream);
	}
	fputs(tail, stream);
	fclose(stream);
}

TEST("stl")
{
	static const struct {
		const char *header, *tail;
	} cases[] = {{"COLOR=abcd", ""}, {"solid part facet", ""}, {"", "trailing facet bytes"}};
	struct captured_log log;
	char line[256] = "";
	struct mesh mesh;
	FILE *said;

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		write_stl("two.stl", cases[k].header, 2, 2, cases[k].tail);
		log = captured_log_begin();
		read_fine("two.stl", &mesh);
		said = captured_log_end(&log);
		assert_true(k > 0 || (fgets(line, sizeof(line), said) &&
				      strstr(line, "left out: colours of triangles of 1 mesh")));
		fclose(said);
		assert_int_equal(triangles_of(&mesh), 2);
		expect_area(&mesh, 1);
		mesh_free(&mesh);
	}
	write_stl("cut.stl", "x", 3, 2, "");
	refuse("cut.stl", -EBADMSG, "cut.stl: it ends in triangle 3, expected 3 of them");
	small_scene_write("t.stl", "SOLID a b\r\n FACET NORMAL 0 0 1\r\n  outer loop\r\n"
				   "\tvertex 0 0 0\r\n vertex 1 0 0\r\n vertex 0 1e0 0\r\n"
				   "  endloop\r\n endfacet\r\nendsolid\r\n");
	read_fine("t.stl", &mesh);
	expect_area(&mesh, 0.5);
	mesh_free(&mesh);
	small_scene_write("t.stl", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 x\n");
	refuse("t.stl", -EBADMSG, "t.stl:5: vertex has \"x\"");
	small_scene_write("t.stl", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 1\n");
	refuse("t.stl", -EBADMSG, "t.stl:5: it ends within a face");
	small_scene_write("t.stl", "nothing of the kind\n");
	refuse("t.stl", -EBADMSG, "no line solid and no binary STL");
}

/* ---- other kinds ---- */

TEST("other kinds")
{
	static const char *const names[] = {"a.fbx", "a.dae", "a.3ds", "a.blend",
					    "a.3mf", "a.x3d", "a.usd", "a"};

	for (size_t k = 0; k < sizeof(names) / sizeof(*names); k++) {
		small_scene_write(names[k], "something");
		refuse(names[k], -ENOTSUP, "expected glTF (.gltf, .glb), OBJ, PLY or STL: Blender");
	}
}

TEST_GROUP(small_scene_begin, small_scene_end);
