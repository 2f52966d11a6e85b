/* SPDX-License-Identifier: MIT */
/* Materials and textures of OBJ, as their writers mean them. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

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

/* Reads a square whose only material has these lines. */
static void read_material(const char *lines, struct mesh *mesh)
{
	small_scene_write("m.mtl", "%s", lines);
	small_scene_write("m.obj",
			  "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
			  "vt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
	read_fine("m.obj", mesh);
}

static const struct material *only_material(const struct mesh *mesh)
{
	assert_int_equal(mesh->material_count, 1);
	return &mesh->materials[0];
}

/* What a material reflects under an even white sky, seen at a cosine of 1: base and coat. */
TEST("reflectance")
{
	static const struct {
		const char *lines;
		float colour, specular, roughness; /* roughness 0: diffuse */
	} cases[] = {
		{"newmtl m\nKd 0.2 0.2 0.2\n", 0.2f, 0, 0},
		{"newmtl m\nkd .2\n", 0.2f, 0, 0},
		{"newmtl m\nKd 2 2 2\n", 1, 0, 0},
		{"newmtl m\nKa 1 1 1\n", 0.8f, 0, 0},
		/* illum says whether highlights count */
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 250\nillum 0\n", 0.2f, 0, 0},
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 250\nillum 1\n", 0.2f, 0, 0},
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 250\nillum 2\n", 0.2f, 0.04f,
		 0.2985f},
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 250\nillum 4\n", 0.2f, 0.04f,
		 0.2985f},
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 250\n", 0.2f, 0.04f, 0.2985f},
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0 0 0\nNs 250\nillum 2\n", 0.2f, 0, 0},
		/* a mirror: base and mirror together reflect Kd + Ks, at most 1 */
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 250\nillum 3\n", 0.4f, 0.5f,
		 0.2985f},
		{"newmtl m\nKd 0.8 0.8 0.8\nKs 1 1 1\nNs 250\nillum 8\n", 1, 0.2f, 0.2985f},
		{"newmtl m\nKd 0.2 0.2 0.2\nKs 1 1 1\nillum 10\n", 0.2f, 0, 0},
		/* as Blender writes */
		{"# Blender 3.4.1 MTL File: 'None'\nnewmtl m\nNs 250.0\nKa 1 1 1\nKd 0.2 0.2 0.2\n"
		 "Ks 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1\nillum 2\n",
		 0.2f, 0.04f, 0.5f},
		{"# Blender 3.4.1 MTL File: 'None'\nnewmtl m\nNs 250.0\nKa 1 1 1\nKd 0.2 0.2 0.2\n"
		 "Ks 0.5 0.5 0.5\nillum 3\n",
		 0, 0.2f, 0.5f},
		/* the physically based extension */
		{"newmtl m\nKd 0.2 0.2 0.2\nPr 0.5\nPm 0\nPs 0\nPc 0\nPcr 0\naniso 0\nanisor 0\n",
		 0.2f, 0.04f, 0.5f},
		{"newmtl m\nKd 0.2 0.2 0.2\nPr 0.25\nPm 1\n", 0, 0.2f, 0.25f},
		{"newmtl m\nKd 0.4 0.4 0.4\nPm .5\nPr 1\n", 0.2f, 0.22f, 1},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		const struct material *m;
		struct mesh mesh;

		read_material(cases[k].lines, &mesh);
		m = only_material(&mesh);
		expect_equal(m->kind, cases[k].roughness > 0 ? MATERIAL_GLOSSY : MATERIAL_DIFFUSE,
			     "k=%zu", k);
		expect_below(fabsf(m->colour.c[0] - cases[k].colour), 1e-5f, "k=%zu", k);
		expect_below(fabsf(m->specular.c[0] - cases[k].specular), 1e-5f, "k=%zu", k);
		expect_below(fabsf(m->roughness - cases[k].roughness), 1e-4f, "k=%zu", k);
		mesh_free(&mesh);
	}
}

TEST("refused")
{
	static const char *const lines[] = {"Kd", "Kd red", "Ks 1 1", "Ns", "d x", "Pr nan"};

	for (size_t k = 0; k < sizeof(lines) / sizeof(*lines); k++) {
		struct fault fault = {.text = ""};
		struct mesh mesh;

		small_scene_write("bad.mtl", "newmtl m\n%s\n", lines[k]);
		small_scene_write("bad.obj",
				  "mtllib bad.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
		expect_equal(mesh_read(&mesh, small_scene_path("bad.obj"), &as_it_is, &fault),
			     -EBADMSG, "k=%zu", k);
		assert_non_null(strstr(fault.text, "bad.mtl:2: "));
		mesh_free(&mesh);
	}
}

/* ---- textures ---- */

/* red, green above blue, white; alpha 0, 51, 102, 255 */
static uint8_t texels[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
/* grey of 0, 51 above 102, 255 */
static uint8_t greys[12] = {0, 0, 0, 51, 51, 51, 102, 102, 102, 255, 255, 255};

static void write_picture(const char *name, uint8_t *pixels)
{
	const struct image image = {.width = 2, .height = 2, .u8 = pixels};
	struct fault fault = {.text = ""};

	assert_int_equal(image_write(small_scene_path(name), &image, &fault), 0);
}

static int folder(const char *name)
{
	return mkdir(small_scene_path(name), 0700);
}

static void expect_checker(const char *obj)
{
	struct mesh mesh;

	read_fine(obj, &mesh);
	for (int k = 0; k < 4; k++) {
		const struct bsdf bsdf = material_at(&mesh.materials[mesh.parts[0].material],
						     k % 2 ? 0.75f : 0.25f, k / 2 ? 0.25f : 0.75f);

		for (int c = 0; c < 3; c++)
			expect_below(fabsf(bsdf.colour.c[c] - (float)texels[3 * k + c] / 255),
				     1e-5f, "%s: k=%d, c=%d", obj, k, c);
	}
	mesh_free(&mesh);
}

#define SQUARE                                                                                     \
	"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\n"           \
	"f 1/1 2/2 3/3 4/4\n"

/* A texture without Kd counts as it is; names and folders of other computers are found. */
TEST("texture names")
{
	static const char *const maps[] = {
		"map_Kd Check er.png",
		"map_Kd Check er.png  \t\r",
		"map_kd check ER.PNG",
		"map_Kd \"Check er.png\"",
		"map_Kd C:\\Users\\me\\check er.png",
		"map_Kd ./check er.png",
		"map_Kd .\\Check er.png",
		"map_Kd /no/where/Check er.png",
		"map_Kd -s 1 1 1 -o 0 0 -blendu on -mm 0 1 -bm 1 -clamp off Check er.png",
		"map_Kd -imfchan l Check er.png",
		"Kd 1 1 1\nillum 0\nMAP_KD Check er.png",
	};

	write_picture("Check er.png", texels);
	for (size_t k = 0; k < sizeof(maps) / sizeof(*maps); k++) {
		small_scene_write("t.mtl", "\xef\xbb\xbfnewmtl m\n%s\n", maps[k]);
		small_scene_write("t.obj", "mtllib t.mtl\n" SQUARE);
		expect_checker("t.obj");
	}
}

/* Libraries in folders of their own, several in a line, and one of another name, which is said. */
TEST("libraries")
{
	struct captured_log log;
	char line[512] = "";
	FILE *said;

	assert_int_equal(folder("lib"), 0);
	write_picture("lib/own.png", texels);
	write_picture("mesh.png", texels);
	small_scene_write("lib/Some Things.mtl", "newmtl m\nmap_Kd own.png\n");
	small_scene_write("lib/far.mtl", "newmtl m\nmap_Kd mesh.png\n");
	small_scene_write("other.mtl", "newmtl n\n");
	small_scene_write("l.obj", "\xef\xbb\xbfmtllib lib\\some things.mtl \r\n" SQUARE);
	expect_checker("l.obj");
	small_scene_write("l.obj", "mtllib other.mtl lib/far.mtl\n" SQUARE);
	expect_checker("l.obj");
	/* names of materials in another case, if none is spelt alike */
	small_scene_write("lib/case.mtl", "newmtl M\nmap_Kd own.png\n");
	small_scene_write("l.obj", "mtllib lib/case.mtl\n" SQUARE);
	expect_checker("l.obj");
	small_scene_write("lib/case.mtl", "newmtl M\nnewmtl m\nmap_Kd own.png\n");
	expect_checker("l.obj");
	small_scene_write("named.mtl", "newmtl m\nmap_Kd mesh.png\n");
	small_scene_write("named.obj", "mtllib lost.mtl\n" SQUARE);
	log = captured_log_begin();
	expect_checker("named.obj");
	said = captured_log_end(&log);
	assert_non_null(fgets(line, sizeof(line), said));
	assert_non_null(strstr(line, "named.obj: lost.mtl is taken from named.mtl"));
	fclose(said);
}

/* Files put together name several libraries that have materials of the same name: the nearest one
 * above counts. A texture without coordinates is said. */
TEST("joined files")
{
	struct captured_log log;
	char line[512] = "";
	struct mesh mesh;
	FILE *said;

	write_picture("mesh.png", texels);
	small_scene_write("a.mtl", "newmtl m\nKd 1 0 0\n");
	small_scene_write("b.mtl", "newmtl m\nKd 0 0 1\nmap_Kd mesh.png\n");
	small_scene_write("ab.obj",
			  "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nmtllib a.mtl\nusemtl m\nf 1 2 3\n"
			  "mtllib b.mtl\nusemtl m\nf 1 3 4\n");
	log = captured_log_begin();
	read_fine("ab.obj", &mesh);
	said = captured_log_end(&log);
	assert_int_equal(mesh.material_count, 2);
	for (int k = 0; k < 2; k++)
		expect_that(mesh.materials[mesh.parts[k].material].colour.c[0] == 1 - (float)k,
			    "k=%d", k);
	assert_non_null(fgets(line, sizeof(line), said));
	assert_non_null(strstr(line, "ab.obj: left out: textures without coordinates of 1 mesh\n"));
	fclose(said);
	mesh_free(&mesh);
}

TEST("missing texture")
{
	struct fault fault = {.text = ""};
	struct mesh mesh;

	small_scene_write("gone.mtl",
			  "newmtl unused\nmap_Kd none.png\nnewmtl m\nmap_Kd gone.png\n");
	small_scene_write("gone.obj", "mtllib gone.mtl\n" SQUARE);
	assert_int_equal(mesh_read(&mesh, small_scene_path("gone.obj"), &as_it_is, &fault),
			 -ENOENT);
	assert_non_null(strstr(fault.text, "gone.mtl:4: there is no picture gone.png"));
	mesh_free(&mesh);
}

TEST("texture places")
{
	struct mesh mesh;
	struct bsdf bsdf;

	write_picture("check.png", texels);
	read_material("newmtl m\nmap_Kd -s 2 1 -o 0.5 0 check.png\n", &mesh);
	/* (0.125, 0.75) is looked up at (0.75, 0.75) */
	bsdf = material_at(only_material(&mesh), 0.125f, 0.75f);
	expect_below(fabsf(bsdf.colour.c[1] - 1), 1e-5f, "%d", 0);
	expect_below(bsdf.colour.c[0], 1e-5f, "%d", 0);
	mesh_free(&mesh);
	/* Maya's black is overlooked */
	read_material("newmtl m\nKd 0 0 0\nmap_Kd -clamp on check.png\n", &mesh);
	bsdf = material_at(only_material(&mesh), -5, 0.75f);
	expect_below(fabsf(bsdf.colour.c[0] - 1), 1e-5f, "%d", 1);
	mesh_free(&mesh);
}

TEST("coverage")
{
	static const struct {
		const char *lines;
		float expected[2]; /* at the upper right and the lower right */
	} cases[] = {
		{"newmtl m\nd 0.5\n", {0.5f, 0.5f}},
		{"newmtl m\nTr 0.25\n", {0.75f, 0.75f}},
		{"newmtl m\nd 1\nTr 1\n", {1, 1}},
		/* Tr that is d: alone, beside materials that tell, by the comment */
		{"newmtl m\nKd 1 1 1\nTr 1.000000\n", {1, 1}},
		{"newmtl m\nTr 0.25\nnewmtl n\nTr 1\n", {0.25f, 0.25f}},
		{"newmtl m\nTr 0.25\nnewmtl n\nd 0.3\nTr 0.3\n", {0.25f, 0.25f}},
		{"# Converted by Meshlab Group\nnewmtl m\nTr 0.25\n", {0.25f, 0.25f}},
		{"# Converted by Meshlab Group\nnewmtl m\nTr 0\n", {1, 1}},
		{"newmtl m\nTr 0.25\nnewmtl n\nTr 0\nnewmtl o\nTr 1\n", {0.75f, 0.75f}},
		{"newmtl m\nTr 1\nnewmtl n\nd 1\nTr 0\n", {0, 0}},
		{"newmtl m\nd -halo 0.5\nmap_d grey.png\n", {0.1f, 0.5f}},
		{"newmtl m\nmap_d grey.png\nmap_Kd check.png\n", {0.2f, 1}},
		{"newmtl m\nmap_Kd check.png\n", {1, 1}},
	};

	write_picture("check.png", texels);
	write_picture("grey.png", greys);
	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct mesh mesh;

		read_material(cases[k].lines, &mesh);
		for (int low = 0; low < 2; low++) {
			const struct material_point point = {
				{{0.75f, low ? 0.25f : 0.75f}, {0, 0}}, {{1, 1, 1}}, 1};

			expect_below(fabsf(material_coverage(only_material(&mesh), &point) -
					   cases[k].expected[low]),
				     1e-5f, "k=%zu, low=%d", k, low);
		}
		mesh_free(&mesh);
	}
}

TEST("surface maps")
{
	struct mesh mesh;
	struct bsdf bsdf;

	write_picture("grey.png", greys);
	read_material("newmtl m\nKd 0.5 0.5 0.5\nmap_Pr grey.png\nmap_Pm grey.png\n", &mesh);
	bsdf = material_at(only_material(&mesh), 0.75f, 0.75f);
	expect_below(fabsf(bsdf.alpha - 0.04f), 1e-5f, "%d", 0);
	expect_below(fabsf(bsdf.specular.c[0] - (0.8f * 0.04f + 0.2f * 0.5f)), 1e-5f, "%d", 0);
	expect_below(fabsf(bsdf.colour.c[0] - 0.4f), 1e-5f, "%d", 0);
	mesh_free(&mesh);
	read_material("newmtl m\nKd 0.5 0.5 0.5\nPm 0\nmap_Pr grey.png\n", &mesh);
	bsdf = material_at(only_material(&mesh), 0.75f, 0.25f);
	expect_below(fabsf(bsdf.alpha - 1), 1e-5f, "%d", 1);
	expect_below(fabsf(bsdf.specular.c[0] - 0.04f), 1e-5f, "%d", 1);
	mesh_free(&mesh);
}

/* A map of normals is read under each of its names; heights, which are grey, are left out. */
TEST("bumps")
{
	static uint8_t normals[12] = {128, 128, 255, 204, 128, 230, 128, 204, 230, 128, 128, 255};
	static const struct {
		const char *line;
		float strength; /* 0: left out */
	} cases[] = {
		{"norm blue.png", 1},
		{"map_Bump -bm 0.5 blue.png", 0.5f},
		{"bump blue.png", 1},
		{"bump grey.png", 0},
		{"map_bump none.png", 0},
		{"bump grey.png\nnorm blue.png", 1},
		{"norm -bm 2 blue.png\nbump -bm 3 blue.png", 2},
	};

	write_picture("blue.png", normals);
	write_picture("grey.png", greys);
	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		char lines[128];
		struct mesh mesh;

		snprintf(lines, sizeof(lines), "newmtl m\n%s\n", cases[k].line);
		read_material(lines, &mesh);
		expect_equal(only_material(&mesh)->bumps.texture != NULL, cases[k].strength > 0,
			     "k=%zu", k);
		expect_that(only_material(&mesh)->bump_scale == cases[k].strength, "k=%zu", k);
		mesh_free(&mesh);
	}
}

/* What is left out is said in one line, and only of materials that are used. */
TEST("left out")
{
	struct captured_log log;
	char line[512] = "";
	struct mesh mesh;
	FILE *said;

	small_scene_write(
		"out.mtl",
		"newmtl a\nmap_Bump -bm 1 none.png\nKe 1 1 1\nnewmtl b\n"
		"bump none.png\nKe 0 0 0\nPc 0.5\nd 0.5\nillum 7\nnewmtl c\ndecal none.png\n");
	small_scene_write("out.obj",
			  "mtllib out.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n"
			  "usemtl b\nf 1 2 3\nl 1 2\n");
	log = captured_log_begin();
	read_fine("out.obj", &mesh);
	said = captured_log_end(&log);
	assert_non_null(fgets(line, sizeof(line), said));
	assert_non_null(strstr(
		line,
		"out.obj: left out: bump maps of 2 materials, emission of 1, clear coats of 1, refraction of 1, lines of 1 mesh\n"));
	assert_null(fgets(line, sizeof(line), said));
	fclose(said);
	mesh_free(&mesh);
}

TEST_GROUP(small_scene_begin, small_scene_end);
