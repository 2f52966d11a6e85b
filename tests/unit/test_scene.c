/* Scene files: what they mean, and the words for what is wrong. Meshes of three formats. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>

#include "tests/unit/baking.h"

#define VIEW "[camera]\nposition = 0 -5 2\nlook_at = 0 0 0\nwidth = 16\nheight = 16\n"

static void write_triangle(void)
{
	baking_write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
}

/* ---- faults ---- */

static void refuse(const char *text, const char *words)
{
	struct fault fault = {.text = ""};
	struct scene *scene = NULL;
	int err;

	baking_write("bad.ini", "%s", text);
	err = scene_open(&scene, baking_path("bad.ini"), 0, 0, &fault);
	if (!err) {
		scene_close(scene);
		fail_msg("accepted: %s", text);
	}
	if (!strstr(fault.text, words) || !strstr(fault.text, "bad.ini"))
		fail_msg("said \"%s\", expected \"%s\"", fault.text, words);
}

static void test_refused_values(void **state)
{
	(void)state;
	write_triangle();
	refuse(VIEW, "no section [object NAME]");
	refuse(VIEW "[object a]\n", "file");
	refuse(VIEW "[object a]\nfile = tri.obj\nscale = 0\n", "bad.ini:8: [object a] scale");
	refuse(VIEW "[object a]\nfile = tri.obj\nscle = 1\n", "scale");
	refuse(VIEW "[object a]\nfile = tri.obj\nmaterial = woood\n[material wood]\n",
	       "[material woood], expected perhaps wood");
	refuse(VIEW "[dome]\nfrequency = 65\n[object a]\nfile = tri.obj\n", "bad.ini:7");
	refuse("[camera]\nwidth = 4\n[object a]\nfile = tri.obj\n", "look_at");
	refuse("[camera]\nfile = none.ini\n[object a]\nfile = tri.obj\n", "none.ini");
	refuse("[camera]\nposition = 0 -5 -1\n[ground]\n[object a]\nfile = tri.obj\n",
	       "below the ground");
	refuse(VIEW "[ground]\nmaterial = m\n[object a]\nfile = tri.obj\n[material m]\n"
		    "kind = glass\n",
	       "expected a diffuse material");
	refuse(VIEW "[ground]\nmaterial = m\n[object a]\nfile = tri.obj\n[material m]\n"
		    "colour = 0 1 1\n",
	       "at least 0.001");
}

static void test_refused_files(void **state)
{
	(void)state;
	refuse(VIEW "[object a]\nfile = none.obj\n", "none.obj");
	baking_write("empty.obj", "v 0 0 0\nv 1 0 0\n");
	refuse(VIEW "[object a]\nfile = empty.obj\n", "empty.obj");
	baking_write("noise.obj", "\x01\x02hello");
	refuse(VIEW "[object a]\nfile = noise.obj\n", "noise.obj");
	baking_write("nan.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
				"property float y\nproperty float z\nelement face 1\n"
				"property list uchar int vertex_indices\nend_header\n"
				"0 0 0\nnan 0 0\n0 0 1\n3 0 1 2\n");
	refuse(VIEW "[object a]\nfile = nan.ply\n", "not finite");
	write_triangle();
	refuse(VIEW "[object a]\nfile = tri.obj\nmaterial = m\n[material m]\ntexture = no.png\n",
	       "no.png");
}

/* ---- meshes ---- */

static void expect_triangle(const char *file)
{
	const struct mesh_placement placement = {.scale = 1, .crease_deg = 60};
	static const float corner[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
	struct fault fault = {.text = ""};
	struct mesh mesh;

	if (mesh_read(&mesh, baking_path(file), &placement, &fault) < 0)
		fail_msg("%s", fault.text);
	assert_int_equal(mesh.part_count, 1);
	assert_int_equal(mesh.parts[0].triangles, 1);
	for (int k = 0; k < 3; k++) {
		const float *p = mesh.parts[0].position[mesh.parts[0].index[0][k]];

		for (int axis = 0; axis < 3; axis++)
			assert_true(fabsf(p[axis] - corner[k][axis]) < 1e-6f);
	}
	mesh_free(&mesh);
}

static void test_formats(void **state)
{
	const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
	const uint16_t index[4] = {0, 1, 2, 0};
	FILE *stream;

	(void)state;
	write_triangle();
	expect_triangle("tri.obj");
	baking_write("tri.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
				"property float y\nproperty float z\nelement face 1\n"
				"property list uchar int vertex_indices\nend_header\n"
				"0 0 0\n1 0 0\n0 0 1\n3 0 1 2\n");
	expect_triangle("tri.ply");
	stream = fopen(baking_path("tri.bin"), "wb");
	assert_non_null(stream);
	fwrite(corners, sizeof(corners), 1, stream);
	fwrite(index, sizeof(index), 1, stream);
	fclose(stream);
	baking_write("tri.gltf",
		     "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],"
		     "\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
		     "{\"POSITION\":0},\"indices\":1}]}],\"buffers\":[{\"uri\":\"tri.bin\","
		     "\"byteLength\":44}],\"bufferViews\":[{\"buffer\":0,\"byteOffset\":0,"
		     "\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":6}],"
		     "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":"
		     "\"VEC3\",\"min\":[0,0,0],\"max\":[1,0,1]},{\"bufferView\":1,"
		     "\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}]}");
	expect_triangle("tri.gltf");
}

/* y up to z up, turned, moved, stood on the ground: one vertex followed by hand. */
static void test_placement(void **state)
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

	(void)state;
	baking_write("p.obj", "v 1 5 3\nv 1 6 3\nv 2 5 3\nf 1 2 3\n");
	assert_int_equal(mesh_read(&mesh, baking_path("p.obj"), &placement, &fault), 0);
	p = mesh.parts[0].position[mesh.parts[0].index[0][1]];
	/* (1, 6, 3) y up is (1, -3, 6) z up; a quarter turn makes (3, 1, 6); twice as large and
	 * moved (16, 22, 42); the lowest, from y = 5, was at 40 and comes to 0 */
	assert_true(fabsf(p[0] - 16) < 1e-4f);
	assert_true(fabsf(p[1] - 22) < 1e-4f);
	assert_true(fabsf(p[2] - 2) < 1e-4f);
	mesh_free(&mesh);
}

static void write_checker(const char *name)
{
	/* red green over blue white */
	static const uint8_t texels[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
	struct fault fault = {.text = ""};
	struct image image;

	assert_int_equal(image_create_u8(&image, 2, 2), 0);
	memcpy(image.u8, texels, sizeof(texels));
	assert_int_equal(image_write(baking_path(name), &image, &fault), 0);
	image_free(&image);
}

/* A square seen from the front, v upwards as OBJ has it: red is at the upper left. From MTL. */
static void test_texture_upright(void **state)
{
	static const int expect[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
	struct basis basis;

	(void)state;
	write_checker("checker.png");
	baking_write("sign.mtl", "newmtl sign\nKd 1 1 1\nmap_Kd checker.png\n");
	baking_write("sign.obj", "mtllib sign.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\n"
				 "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl sign\n"
				 "f 1/1 2/2 3/3 4/4\n");
	baking_write("sign.ini",
		     "[camera]\nposition = 0 -10 0\nlook_at = 0 0 0\nfield_deg = 11.42\n"
		     "width = 32\nheight = 32\n[dome]\nfrequency = 1\n[render]\n"
		     "samples = 16\n[object sign]\nfile = sign.obj\nup = z\n");
	basis = baking_bake("sign.ini");
	for (int k = 0; k < 4; k++)
		for (int c = 0; c < 3; c++) {
			const double value = baking_object(&basis, k % 2 ? 24 : 8, k / 2 ? 24 : 8,
							   c, NULL);

			/* upright in half a sky: one half */
			assert_true(fabs(value - 0.5 * expect[k][c]) < 0.06);
		}
	basis_close(&basis);
}

static void test_mtl_materials(void **state)
{
	const struct mesh_placement placement = {
		.scale = 1, .crease_deg = 60, .own_materials = true};
	struct fault fault = {.text = ""};
	struct mesh mesh;
	int matt = 0, shiny = 0;

	(void)state;
	baking_write("m.mtl", "newmtl matt\nKd 0.1 0.2 0.3\nnewmtl shiny\nKd 0.5 0.4 0.3\n"
			      "Ks 0.2 0.2 0.2\nNs 100\nillum 2\n");
	baking_write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nusemtl matt\n"
			      "f 1 2 3\nusemtl shiny\nf 2 4 3\n");
	assert_int_equal(mesh_read(&mesh, baking_path("m.obj"), &placement, &fault), 0);
	for (int k = 0; k < mesh.part_count; k++) {
		const struct material *m = &mesh.materials[mesh.parts[k].material];

		if (m->kind == MATERIAL_DIFFUSE && fabsf(m->colour.c[2] - 0.3f) < 1e-6f &&
		    fabsf(m->colour.c[0] - 0.1f) < 1e-6f)
			matt++;
		if (m->kind == MATERIAL_GLOSSY && fabsf(m->specular.c[0] - 0.2f) < 1e-6f &&
		    m->roughness > 0.1f && m->roughness < 0.6f)
			shiny++;
	}
	assert_int_equal(matt, 1);
	assert_int_equal(shiny, 1);
	mesh_free(&mesh);
}

/* ---- what the scene says ---- */

/* Making a rotation exact may move its last digit. */
static void expect_camera(const struct tsai_camera *a, const struct tsai_camera *b)
{
	assert_int_equal(a->width, b->width);
	assert_int_equal(a->height, b->height);
	for (int k = 0; k < 9; k++)
		assert_true(fabs(a->rotation[k] - b->rotation[k]) < 1e-15);
	assert_memory_equal(a->translation, b->translation,
			    sizeof(*a) - offsetof(struct tsai_camera, translation));
}

static void test_camera_kinds(void **state)
{
	struct scene *look, *tsai, *file;
	char text[4096];

	(void)state;
	write_triangle();
	baking_write("look.ini", VIEW "[object a]\nfile = tri.obj\n");
	look = baking_scene("look.ini");
	assert_int_equal(scene_camera_text(look, text, sizeof(text)), 0);
	/* what goes into the basis file reads back as the same camera, by either way */
	baking_write("cam.ini", "%s", text);
	baking_write("file.ini", "[camera]\nfile = cam.ini\n[object a]\nfile = tri.obj\n");
	baking_write("tsai.ini", "[tsai]\n%s[object a]\nfile = tri.obj\n", strchr(text, '\n') + 1);
	file = baking_scene("file.ini");
	tsai = baking_scene("tsai.ini");
	expect_camera(&look->camera, &file->camera);
	expect_camera(&look->camera, &tsai->camera);
	assert_true(fabsf(look->eye.y + 5) < 1e-5f && fabsf(look->eye.z - 2) < 1e-5f);
	scene_close(look);
	scene_close(file);
	scene_close(tsai);
}

/* The hash follows what is in the scene, not where it lies. */
static void test_hash(void **state)
{
	struct scene *a, *b, *c;

	(void)state;
	write_triangle();
	baking_write("a.ini", VIEW "[object a]\nfile = tri.obj\n");
	baking_write("b.ini", "; a comment\n" VIEW "[object a]\nfile = ./tri.obj\n");
	a = baking_scene("a.ini");
	b = baking_scene("b.ini");
	baking_write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1.25\nf 1 2 3\n");
	c = baking_scene("a.ini");
	assert_true(a->hash == b->hash);
	assert_true(a->hash != c->hash);
	scene_close(a);
	scene_close(b);
	scene_close(c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_refused_values),	cmocka_unit_test(test_refused_files),
		cmocka_unit_test(test_formats),		cmocka_unit_test(test_placement),
		cmocka_unit_test(test_texture_upright), cmocka_unit_test(test_mtl_materials),
		cmocka_unit_test(test_camera_kinds),	cmocka_unit_test(test_hash),
	};

	return cmocka_run_group_tests(tests, baking_begin, baking_end);
}
