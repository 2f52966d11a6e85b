/* SPDX-License-Identifier: MIT */
/* A small glTF in many forms: each kind of number, of primitive, of node, of material, and what is
 * wrong with damaged ones. */
#include <errno.h>
#include <math.h>
#include <meshoptimizer.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/mesh/gltf/gltf.h"
#include "hal/image/image.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/captured_log.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* All bytes that the accessors below name: a unit square, and what may happen to it. */
static const struct bytes {
	float position[4][3], normal[4][3], uv[4][2], moved[4][3], bind[2][16], instance[2][3];
	uint16_t uv16[4][2];
	int16_t position16[4][4];
	int8_t position8[4][4];
	uint8_t uv8[4][4], colour[4][4], joint[4][4], weight[4][4];
	uint32_t index32[6];
	uint16_t index16[6];
	uint8_t strip[4], sparse_at[4];
	float sparse_to[3], tangent[4][4], turned[4][3];
} bytes = {
	.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
	.normal = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
	.uv = {{0, 0.2f}, {1, 0.2f}, {1, 1}, {0, 1}},
	.moved = {{0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}},
	.bind = {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
		 {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1}},
	.instance = {{3, 0, 0}, {0, 0, -4}},
	.uv16 = {{0, 13107}, {65535, 13107}, {65535, 65535}, {0, 65535}},
	.position16 = {{0, 0, 0}, {1000, 0, 0}, {1000, 1000, 0}, {0, 1000, 0}},
	.position8 = {{0, 0, 0}, {127, 0, 0}, {127, 127, 0}, {-128, 127, 0}},
	.uv8 = {{0, 51}, {255, 51}, {255, 255}, {0, 255}},
	.colour = {{255, 0, 51, 102}, {255, 0, 51, 102}, {255, 0, 51, 102}, {255, 0, 51, 102}},
	.joint = {{0, 1}, {0, 1}, {0, 1}, {0, 1}},
	.weight = {{255, 0}, {255, 0}, {51, 204}, {0, 255}},
	.index32 = {0, 1, 2, 0, 2, 3},
	.index16 = {0, 1, 2, 0, 2, 3},
	.strip = {0, 1, 3, 2},
	.sparse_at = {2},
	.sparse_to = {5, 6, 7},
	.tangent = {{0, 0, 1, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}, {0, 0, 1, -1}},
	.turned = {{2, 0, 0}, {2, 0, 0}, {2, 0, 0}, {2, 0, 0}},
};

#define VIEW(field, stride)                                                                        \
	{                                                                                          \
		offsetof(struct bytes, field), sizeof(bytes.field), stride                         \
	}

static const struct {
	size_t offset, length, stride;
} views[] = {
	VIEW(index16, 0),   VIEW(position, 0), VIEW(normal, 0),	    VIEW(uv, 0),
	VIEW(uv16, 0),	    VIEW(uv8, 4),      VIEW(position16, 8), VIEW(position8, 4),
	VIEW(colour, 0),    VIEW(moved, 0),    VIEW(joint, 0),	    VIEW(weight, 0),
	VIEW(bind, 0),	    VIEW(instance, 0), VIEW(strip, 0),	    VIEW(sparse_at, 0),
	VIEW(sparse_to, 0), VIEW(index32, 0),  VIEW(tangent, 0),    VIEW(turned, 0),
};

static const char accessors[] =
	"{'bufferView':0,'componentType':5123,'count':6,'type':'SCALAR'},"
	"{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3'},"
	"{'bufferView':2,'componentType':5126,'count':4,'type':'VEC3'},"
	"{'bufferView':3,'componentType':5126,'count':4,'type':'VEC2'},"
	"{'bufferView':4,'componentType':5123,'count':4,'type':'VEC2','normalized':true},"
	"{'bufferView':5,'componentType':5121,'count':4,'type':'VEC2','normalized':true},"
	"{'bufferView':6,'componentType':5122,'count':4,'type':'VEC3'},"
	"{'bufferView':7,'componentType':5120,'count':4,'type':'VEC3','normalized':true},"
	"{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3','sparse':{'count':1,"
	"'indices':{'bufferView':15,'byteOffset':0,'componentType':5121},"
	"'values':{'bufferView':16}}},"
	"{'bufferView':8,'componentType':5121,'count':4,'type':'VEC4','normalized':true},"
	"{'bufferView':9,'componentType':5126,'count':4,'type':'VEC3'},"
	"{'bufferView':10,'componentType':5121,'count':4,'type':'VEC4'},"
	"{'bufferView':11,'componentType':5121,'count':4,'type':'VEC4','normalized':true},"
	"{'bufferView':12,'componentType':5126,'count':2,'type':'MAT4'},"
	"{'bufferView':13,'componentType':5126,'count':2,'type':'VEC3'},"
	"{'bufferView':14,'componentType':5121,'count':4,'type':'SCALAR'},"
	"{'bufferView':17,'componentType':5125,'count':6,'type':'SCALAR'},"
	"{'bufferView':18,'componentType':5126,'count':4,'type':'VEC4'},{'bufferView':19,'componentType':5126,'count':4,'type':'VEC3'}";

/* What a test changes of the file; NULL: as it is. */
struct form {
	const char *attributes, *primitive, *mesh, *nodes, *root, *buffer;
	const char *file; /* its name: what is left out of a file is said once */
};

/* Writes JSON with ' in place of ". */
static void put(char **to, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(char **to, const char *format, ...)
{
	va_list list;
	char *from = *to;

	va_start(list, format);
	*to += vsprintf(from, format, list);
	va_end(list);
	for (; from < *to; from++)
		if (*from == '\'')
			*from = '"';
}

static const char * or (const char *text, const char *otherwise)
{
	return text ? text : otherwise;
}

static void put_gltf(char *text, const struct form *form)
{
	put(&text, "{'asset':{'version':'2.0'},'buffers':[");
	if (form->buffer)
		put(&text, "%s", form->buffer);
	else
		put(&text, "{'byteLength':%zu,'uri':'the%%20square.bin'}", sizeof(bytes));
	put(&text, "],'bufferViews':[");
	for (size_t k = 0; k < sizeof(views) / sizeof(*views); k++) {
		put(&text, "%s{'buffer':0,'byteOffset':%zu,'byteLength':%zu", k ? "," : "",
		    views[k].offset, views[k].length);
		if (views[k].stride)
			put(&text, ",'byteStride':%zu", views[k].stride);
		put(&text, "}");
	}
	put(&text, "],'accessors':[%s],'meshes':[{'primitives':[{'attributes':{%s}%s}]%s}],",
	    accessors, or (form->attributes, "'POSITION':1"), or (form->primitive, ",'indices':0"),
	    or (form->mesh, ""));
	put(&text, "'nodes':[%s]%s}", or (form->nodes, "{'mesh':0}"), or (form->root, ""));
}

static void write_bytes(const char *name, const void *from, size_t length)
{
	FILE *stream = fopen(small_scene_path(name), "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(from, 1, length, stream), length);
	fclose(stream);
}

static int read_form(struct mesh *mesh, const struct form *form, struct fault *fault)
{
	char text[16384];

	*mesh = (struct mesh){.part_count = 0};
	*fault = (struct fault){.text = ""};
	put_gltf(text, form);
	write_bytes("the square.bin", &bytes, sizeof(bytes));
	write_bytes(or (form->file, "square.gltf"), text, strlen(text));
	return gltf_read(mesh, small_scene_path(or (form->file, "square.gltf")), 60, true, fault);
}

static struct mesh read_fine(const struct form *form)
{
	struct fault fault;
	struct mesh mesh;

	expect_success(read_form(&mesh, form, &fault), &fault);
	return mesh;
}

/* The corner of a part that is at x, y, but for its own rounding; fails if there is none. */
static int corner_at(const struct mesh_part *part, float x, float y, float z)
{
	for (int v = 0; v < part->vertices; v++)
		if (fabsf(part->position[v][0] - x) < 1e-4f &&
		    fabsf(part->position[v][1] - y) < 1e-4f &&
		    fabsf(part->position[v][2] - z) < 1e-4f)
			return v;
	fail_msg("no vertex at %g %g %g", (double)x, (double)y, (double)z);
	return -1;
}

/* ---- geometry ---- */

TEST("kinds of numbers")
{
	static const struct form forms[] = {
		{.attributes = "'POSITION':1,'TEXCOORD_0':3"},
		{.attributes = "'POSITION':1,'TEXCOORD_0':4"},
		{.attributes = "'POSITION':1,'TEXCOORD_0':5"},
		{.attributes = "'POSITION':1,'TEXCOORD_0':3", .primitive = ",'indices':16"},
		{.attributes = "'POSITION':6,'TEXCOORD_0':4",
		 .nodes = "{'mesh':0,'scale':[0.001,0.001,1]}",
		 .root = ",'extensionsRequired':['KHR_mesh_quantization']"},
		{.attributes = "'POSITION':7,'TEXCOORD_0':5"},
		{.attributes = "'POSITION':1,'TEXCOORD_0':3",
		 .primitive = ",'indices':15,'mode':5"},
		{.attributes = "'POSITION':1,'TEXCOORD_0':3", .primitive = ",'mode':6"},
	};

	for (size_t k = 0; k < sizeof(forms) / sizeof(*forms); k++) {
		struct mesh mesh = read_fine(&forms[k]);
		const struct mesh_part *part = &mesh.parts[0];
		const int v = corner_at(part, 1, 0, 0);

		expect_equal(mesh.part_count, 1, "k=%zu", k);
		expect_equal(part->triangles, 2, "k=%zu", k);
		expect_below(fabsf(part->uv[v][0] - 1), 1e-6f, "k=%zu", k);
		expect_below(fabsf(part->uv[v][1] - 0.8f), 1e-6f, "k=%zu", k);
		corner_at(part, k == 5 ? -1 : 0, 1, 0); /* -128 is -1, too */
		for (int t = 0; t < 2; t++) {
			const struct v3 a = mesh_corner(part, t, 0), b = mesh_corner(part, t, 1),
					c = mesh_corner(part, t, 2);

			expect_that(v3_cross(v3_sub(b, a), v3_sub(c, a)).z > 0.9f, "k=%zu t=%d", k,
				    t);
		}
		mesh_free(&mesh);
	}
}

TEST("sparse")
{
	struct mesh mesh = read_fine(&(struct form){.attributes = "'POSITION':8"});

	corner_at(&mesh.parts[0], 5, 6, 7);
	corner_at(&mesh.parts[0], 1, 0, 0);
	mesh_free(&mesh);
}

/* A node within another; mirrored, so that winding and normals must be turned. */
TEST("nodes")
{
	static const struct form forms[] = {
		{.nodes =
			 "{'mesh':0},{'children':[2],'translation':[10,0,0]},{'mesh':0,'rotation':[0,0,0.70710678,0.70710678],'scale':[-2,1,1]}",
		 .root = ",'scene':1,'scenes':[{'nodes':[0]},{'nodes':[1]}]"},
		{.nodes =
			 "{'children':[1],'matrix':[0,1,0,0,-1,0,0,0,0,0,1,0,10,0,0,1]},{'mesh':0,'scale':[-2,1,1]}",
		 .attributes = "'POSITION':1,'NORMAL':2"},
	};

	for (size_t k = 0; k < 2; k++) {
		struct mesh mesh = read_fine(&forms[k]);
		const struct mesh_part *part = &mesh.parts[0];
		const int v = corner_at(part, 9, -2, 0); /* (1, 1) is (-2, 1), turned (-1, -2) */
		const struct v3 a = mesh_corner(part, 0, 0), b = mesh_corner(part, 0, 1),
				c = mesh_corner(part, 0, 2);

		expect_equal(mesh.part_count, 1, "k=%zu", k);
		expect_that(v3_cross(v3_sub(b, a), v3_sub(c, a)).z > 0, "k=%zu", k);
		expect_below(fabsf(part->normal[v].z - 1), 1e-6f, "k=%zu", k);
		mesh_free(&mesh);
	}
}

TEST("morph")
{
	static const struct form forms[] = {
		{.primitive = ",'indices':0,'targets':[{'POSITION':10}]", .mesh = ",'weights':[1]"},
		{.primitive = ",'indices':0,'targets':[{'POSITION':10}]",
		 .mesh = ",'weights':[0.25]",
		 .nodes = "{'mesh':0,'weights':[0.5]}"},
	};

	for (int k = 0; k < 2; k++) {
		struct mesh mesh = read_fine(&forms[k]);

		corner_at(&mesh.parts[0], 1, 0, k ? 1 : 2);
		mesh_free(&mesh);
	}
}

/* Joint 0 scales by 2, joint 1 moves up by 10 from its bind pose at x = 1. The node of the skin
 * itself does not count, for the lengths of a volume neither. */
TEST("skin")
{
	struct mesh mesh = read_fine(&(struct form){
		.attributes = "'POSITION':1,'NORMAL':2,'JOINTS_0':11,'WEIGHTS_0':12",
		.primitive = ",'indices':0,'material':0",
		.nodes =
			"{'mesh':0,'skin':0,'translation':[100,0,0]},{'scale':[2,2,2]},{'translation':[1,0,10]}",
		.root = ",'skins':[{'joints':[1,2],'inverseBindMatrices':13}],'materials':[{"
			"'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},"
			"'KHR_materials_volume':{'thicknessFactor':1,'attenuationDistance':1,"
			"'attenuationColor':[0.5,0.5,0.5]}},'pbrMetallicRoughness':{'metallicFactor':0,'roughnessFactor':0}}]",
	});
	const struct mesh_part *part = &mesh.parts[0];

	corner_at(part, 2, 0, 0);
	corner_at(part, 0, 1, 10);
	/* a fifth of (2, 2, 0) and four fifths of (1, 1, 10) */
	corner_at(part, 1.2f, 1.2f, 8);
	expect_below(fabsf(part->normal[2].z - 1), 1e-6f, "normal");
	assert_int_equal(mesh.material_count, 1);
	expect_below(fabsf(mesh.materials[0].colour.c[1] - 0.5f), 2e-3f, "volume");
	mesh_free(&mesh);
}

/* They move as what lies in the surface: not with the node's place, scaled as it is, mirrored by a
 * change of sign; a morph target moves three of their numbers. Without normals they do not
 * count. */
TEST("tangents")
{
	struct mesh mesh = read_fine(&(struct form){
		.attributes = "'POSITION':1,'NORMAL':2,'TANGENT':17",
		.primitive = ",'indices':0,'targets':[{'TANGENT':18}]",
		.mesh = ",'weights':[0.5]",
		.nodes = "{'mesh':0,'scale':[-1,1,4],'translation':[0,7,0]}",
	});
	const float *first = mesh.parts[0].tangent[0], *last = mesh.parts[0].tangent[3];

	for (int k = 0; k < 4; k++) {
		static const float expected[4] = {-1, 0, 4, -1};

		expect_below(fabsf(first[k] - expected[k]), 1e-5f, "k=%d", k);
	}
	assert_true(last[3] == 1);
	mesh_free(&mesh);
	mesh = read_fine(&(struct form){.attributes = "'POSITION':1,'TANGENT':17"});
	assert_null(mesh.parts[0].tangent);
	mesh_free(&mesh);
}

TEST("instances")
{
	struct mesh mesh = read_fine(&(struct form){
		.nodes =
			"{'mesh':0,'scale':[2,2,2],'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'TRANSLATION':14}}}}",
		.root = ",'extensionsRequired':['EXT_mesh_gpu_instancing']",
	});

	assert_int_equal(mesh.part_count, 2);
	corner_at(&mesh.parts[0], 8, 2, 0);
	corner_at(&mesh.parts[1], 2, 2, -8);
	mesh_free(&mesh);
}

/* Far translations are not rounded before the origin is known. */
TEST("far node")
{
	struct mesh mesh = read_fine(
		&(struct form){.nodes = "{'mesh':0,'translation':[500000.125,7,-5400000.375]}"});
	const double expected[3] = {500001.125, 8, -5400000.375};

	for (int axis = 0; axis < 3; axis++)
		expect_below(fabs(mesh.origin[axis] + (double)mesh.parts[0].position[2][axis] -
				  expected[axis]),
			     1e-6, "axis=%d", axis);
	mesh_free(&mesh);
}

/* A vertex that no triangle has is not what stands on the ground. */
TEST("unused vertex")
{
	const struct mesh_placement stand = {.scale = 1, .crease_deg = 60, .stand = 1};
	struct fault fault = {.text = ""};
	struct mesh mesh = read_fine(&(struct form){
		.buffer =
			"{'byteLength':54,'uri':'data:application/octet-stream;base64,AAAAAAAAAAAAAIA/AACAPwAAAAAAAIA/AACgQAAAoEAAAEDAAAAAAAAAgD8AAABAAAABAAMA'}",
		.attributes = "'POSITION':0",
		.primitive = ",'indices':1",
		.root = ",'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,"
			"'byteLength':6}],'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':3,'type':'SCALAR'}]",
	});

	mesh_free(&mesh);
	expect_success(mesh_read(&mesh, small_scene_path("square.gltf"), &stand, &fault), &fault);
	assert_int_equal(mesh.parts[0].vertices, 3);
	corner_at(&mesh.parts[0], 0, 0, 0);
	corner_at(&mesh.parts[0], 0, 1, 1);
	mesh_free(&mesh);
}

/* ---- containers ---- */

static size_t put_chunk(uint8_t *to, const char *type, const void *from, uint32_t length)
{
	memcpy(to, &length, 4);
	memcpy(to + 4, type, 4);
	memcpy(to + 8, from, length);
	return 8 + length;
}

/* Writes a GLB of a form and bytes. */
static void write_glb(const char *name, const struct form *form, const void *binary,
		      uint32_t length)
{
	static uint8_t file[32768];
	char text[16384];
	uint32_t head[3] = {0x46546c67, 2, 0};
	size_t at = sizeof(head);

	put_gltf(text, form);
	at += put_chunk(file + at, "JSON", text, (uint32_t)strlen(text));
	at += put_chunk(file + at, "BIN", binary, length);
	head[2] = (uint32_t)at;
	memcpy(file, head, sizeof(head));
	write_bytes(name, file, at);
}

static void expect_square(const char *name)
{
	struct fault fault = {.text = ""};
	struct mesh mesh = {.part_count = 0};

	expect_success(gltf_read(&mesh, small_scene_path(name), 60, true, &fault), &fault);
	assert_int_equal(mesh.part_count, 1);
	assert_int_equal(mesh.parts[0].triangles, 2);
	corner_at(&mesh.parts[0], 1, 1, 0);
	mesh_free(&mesh);
}

TEST("glb")
{
	char buffer[64];

	snprintf(buffer, sizeof(buffer), "{'byteLength':%zu}", sizeof(bytes));
	write_glb("square.glb", &(struct form){.buffer = buffer}, &bytes, sizeof(bytes));
	expect_square("square.glb");
}

/* Positions and triangles compressed by meshoptimizer. What is not compressed would be in a second
 * buffer, which has no bytes. */
TEST("meshopt")
{
	uint8_t packed[512];
	char root[1024], buffer[256];
	const size_t vertices = meshopt_encodeVertexBuffer(packed, sizeof(packed), bytes.position,
							   4, 12);
	const size_t triangles = meshopt_encodeIndexBuffer(
		packed + vertices, sizeof(packed) - vertices, bytes.index32, 6);

	assert_true(vertices && triangles);
	snprintf(
		buffer, sizeof(buffer),
		"{'byteLength':%zu},{'byteLength':100000,'extensions':{'EXT_meshopt_compression':{'fallback':true}}}",
		vertices + triangles);
	/* of two members of the same name, the last counts */
	snprintf(
		root, sizeof(root),
		",'extensionsRequired':['EXT_meshopt_compression'],'bufferViews':[{'buffer':1,"
		"'byteLength':48,'extensions':{'EXT_meshopt_compression':{'buffer':0,'byteLength':"
		"%zu,'byteStride':12,'count':4,'mode':'ATTRIBUTES'}}},{'buffer':1,'byteLength':24,"
		"'extensions':{'EXT_meshopt_compression':{'buffer':0,'byteOffset':%zu,"
		"'byteLength':%zu,'byteStride':4,'count':6,'mode':'TRIANGLES'}}}],'accessors':["
		"{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},{'bufferView':1,'componentType':5125,'count':6,'type':'SCALAR'}]",
		vertices, vertices, triangles);
	write_glb("packed.glb",
		  &(struct form){.attributes = "'POSITION':0",
				 .primitive = ",'indices':1",
				 .buffer = buffer,
				 .root = root},
		  packed, (uint32_t)(vertices + triangles));
	expect_square("packed.glb");
}

/* Made by Draco; the accessors have no bytes. */
TEST("draco")
{
	struct fault fault = {.text = ""};
	struct mesh mesh = {.part_count = 0};

	expect_success(gltf_read(&mesh, "tests/fuzz/corpus/gltf/draco.glb", 60, true, &fault),
		       &fault);
	assert_int_equal(mesh.parts[0].triangles, 2);
	for (int k = 0; k < 4; k++)
		corner_at(&mesh.parts[0], (float)(k & 1), (float)(k >> 1), 0);
	mesh_free(&mesh);
}

/* Made by Draco, whose encoder did not say that the colours are normalized; the accessor does. */
TEST("draco colours")
{
	struct mesh mesh = read_fine(&(struct form){
		.buffer =
			"{'byteLength':115,'uri':'data:application/octet-stream;base64,"
			"RFJBQ08CAgEBAAAABAIBAgAAAR//ARH/AREC/wAAAAAAAQAJAwAAAgECAgMAAQEBAQEAAwMBMAEQAwAogpgAAAAAAP8AAAAAAAAAAAAAAAAAAAAAAIA/CAEBAQEBZ1k1VQX/j1UFBLvIjYAAAAAA/wAAAA=='}",
		.attributes = "'POSITION':0,'COLOR_0':1",
		.primitive =
			",'indices':2,'extensions':{'KHR_draco_mesh_compression':{'bufferView':0,'attributes':{'POSITION':0,'COLOR_0':1}}}",
		.root = ",'bufferViews':[{'buffer':0,'byteLength':115}],'accessors':["
			"{'componentType':5126,'count':4,'type':'VEC3'},"
			"{'componentType':5121,'count':4,'type':'VEC3','normalized':true},{'componentType':5123,'count':6,'type':'SCALAR'}]",
	});

	for (int v = 0; v < 4; v++)
		for (int c = 0; c < 3; c++)
			expect_below(
				fabsf(mesh.parts[0].colour[v][c] - 0.2f * (float)(c ? c == 1 : 5)),
				1e-5f, "v=%d, c=%d", v, c);
	mesh_free(&mesh);
}

TEST("data uri")
{
	/* three corners: (0, 0, 0), (1, 0, 0), (1, 1, 0) */
	struct mesh mesh = read_fine(&(struct form){
		.buffer =
			"{'byteLength':36,'uri':'data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAA'}",
		.primitive = "",
		.root = ",'bufferViews':[{'buffer':0,'byteLength':36}],'accessors':[{},{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'}]",
	});

	assert_int_equal(mesh.parts[0].triangles, 1);
	corner_at(&mesh.parts[0], 1, 1, 0);
	mesh_free(&mesh);
}

/* ---- materials ---- */

static void write_texture(void)
{
	/* red, green above blue, white */
	static const uint8_t texels[12] = {255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
	struct fault fault = {.text = ""};
	struct image image;

	assert_int_equal(image_create_u8(&image, 2, 2), 0);
	memcpy(image.u8, texels, sizeof(texels));
	expect_success(image_write(small_scene_path("checker.png"), &image, &fault), &fault);
	image_free(&image);
}

#define TEXTURED ",'images':[{'uri':'checker.png'}],'textures':[{'source':0,'sampler':0}],"
#define MATERIAL ",'indices':0,'material':0"

/* Reads a form and looks its material up in the middle of the texel that (u, v) of the file, with
 * v downwards, is in. */
static struct bsdf look_up(const struct form *form, float u, float v)
{
	struct mesh mesh = read_fine(form);
	const struct material_point point = {
		.uv = {{u, 1 - v}, {u, 1 - v}}, .colour = {{1, 1, 1}}, .alpha = 1};
	struct bsdf bsdf;

	assert_int_equal(mesh.material_count, 1);
	bsdf = material_at_point(&mesh.materials[mesh.parts[0].material], &point);
	mesh_free(&mesh);
	return bsdf;
}

static void expect_rgb(struct rgb is, float r, float g, float b, const char *name)
{
	const float expected[3] = {r, g, b};

	for (int c = 0; c < 3; c++)
		expect_below(fabsf(is.c[c] - expected[c]), 1e-4f, "%s c=%d", name, c);
}

/* Scale, then rotation anticlockwise as seen with v downwards, then offset. */
TEST("texture transform")
{
	static const struct {
		const char *transform, *sampler;
		float u, v, r, g, b;
	} cases[] = {
		{"'offset':[0.5,0]", "", 0.25f, 0.25f, 0, 1, 0},
		{"'offset':[0,0.5]", "", 0.25f, 0.25f, 0, 0, 1},
		/* (0.125, 0.75) is (0.25, 0.75) */
		{"'scale':[2,1]", "", 0.125f, 0.75f, 0, 0, 1},
		/* (u, v) is (v, -u): (0.25, -0.75) is (0.25, 0.25) */
		{"'rotation':1.5707963268", "", 0.75f, 0.25f, 1, 0, 0},
		/* (0.75, 0.75) is (0.75, 0.75 - 1.5): (0.75, -0.75) */
		{"'rotation':1.5707963268,'scale':[2,1],'offset':[0,0]", "", 0.375f, 0.75f, 0, 1,
		 0},
		{"'offset':[1,0]", "'wrapS':33071", 0.25f, 0.25f, 0, 1, 0},
		{"'offset':[1,0]", "'wrapS':33648", 0.25f, 0.25f, 0, 1, 0},
		{"'offset':[0,1]", "'wrapT':33071", 0.25f, 0.25f, 0, 0, 1},
		{"'offset':[0.2,0.2]", "'magFilter':9728", 0.25f, 0.25f, 1, 0, 0},
	};

	write_texture();
	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		char root[1024], name[32];
		struct bsdf bsdf;

		snprintf(
			root, sizeof(root),
			TEXTURED
			"'samplers':[{%s}],'materials':[{'pbrMetallicRoughness':{"
			"'metallicFactor':0,'baseColorTexture':{'index':0,'texCoord':1,'extensions':{'KHR_texture_transform':{%s}}}}}]",
			cases[k].sampler, cases[k].transform);
		snprintf(name, sizeof(name), "k=%zu", k);
		bsdf = look_up(&(struct form){.attributes = "'POSITION':1,'TEXCOORD_1':3",
					      .primitive = MATERIAL,
					      .root = root},
			       cases[k].u, cases[k].v);
		expect_rgb(bsdf.colour, cases[k].r, cases[k].g, cases[k].b, name);
	}
}

/* A picture of one grey texel of 16 bits, 300: 8 bits would make it 257. */
TEST("deep texture")
{
	static const char root[] =
		",'images':[{'uri':'data:image/png;base64,"
		"iVBORw0KGgoAAAANSUhEUgAAAAEAAAABEAAAAABq7kcWAAAAC0lEQVR42mNg1AEAADEALrhR+TUAAAAA"
		"SUVORK5CYII='}],'textures':[{'source':0}],'materials':[{'pbrMetallicRoughness':{'metallicFactor':0,'baseColorTexture':{'index':0,'texCoord':1}}}]";
	const float grey = 300 / 65535.0f / 12.92f;

	expect_below(fabsf(look_up(&(struct form){.primitive = MATERIAL, .root = root}, 0.5f, 0.5f)
				   .colour.c[0] -
			   grey),
		     1e-7f, "%g", (double)grey);
}

/* The set that a material names becomes the part's first. */
TEST("texture sets")
{
	struct mesh mesh = read_fine(&(struct form){
		.attributes = "'POSITION':1,'TEXCOORD_2':3,'TEXCOORD_5':4,'COLOR_0':9",
		.primitive = MATERIAL,
		.root = TEXTURED
		"'samplers':[{}],'materials':[{'normalTexture':{'index':0,'texCoord':5},"
		"'pbrMetallicRoughness':{'baseColorTexture':{'index':0,'texCoord':2},'metallicRoughnessTexture':{'index':0,'texCoord':2}}}]",
	});
	const struct mesh_part *part = &mesh.parts[0];

	assert_non_null(mesh.materials[0].bumps.texture);
	assert_int_equal(mesh.materials[0].bumps.set, 1);
	assert_int_equal(mesh.materials[0].map.use.set, 0);
	assert_int_equal(mesh.texture_count, 2); /* as colours and as data */
	expect_below(fabsf(part->uv[1][1] - 0.8f), 1e-6f, "first");
	expect_below(fabsf(part->uv2[1][1] - 0.8f), 1e-5f, "second");
	expect_below(fabsf(part->colour[0][2] - 0.2f), 1e-6f, "colour");
	expect_below(fabsf(part->colour[0][3] - 0.4f), 1e-6f, "alpha");
	mesh_free(&mesh);
}

#if WITH_WEBP
/* A picture of one texel, (0, 255, 0), within the JSON, named by the extension for WebP alone. */
TEST("data picture")
{
	const struct bsdf bsdf = look_up(
		&(struct form){
			.attributes = "'POSITION':1,'TEXCOORD_0':3",
			.primitive = MATERIAL,
			.root = ",'images':[{},{'uri':'data:image/png;base64,"
				"iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNg+"
				"M8AAAICAQB7CYF4AAAAAElFTkSuQmCC'}],'textures':"
				"[{'extensions':{'EXT_texture_webp':{'source':1}}}],'materials':[{'pbrMetallicRoughness':{'metallicFactor':0,'baseColorTexture':{'index':0}}}]",
		},
		0.5f, 0.5f);

	expect_rgb(bsdf.colour, 0, 1, 0, "green");
}
#endif

#define WITH_MATERIAL(text)                                                                        \
	{                                                                                          \
		.primitive = MATERIAL, .root = ",'materials':[{" text "}]"                         \
	}

TEST("kinds of materials")
{
	static const struct {
		struct form form;
		enum material_kind kind;
		float colour, specular, alpha;
	} cases[] = {
		/* without any: a rough white metal */
		{{.root = ""}, MATERIAL_GLOSSY, 0, 1, 1},
		{WITH_MATERIAL(
			 "'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1],'metallicFactor':0.25,'roughnessFactor':0.5}"),
		 MATERIAL_GLOSSY, 0.375f, 0.155f, 0.25f},
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_unlit':{}},'pbrMetallicRoughness':{'baseColorFactor':[0.5,0.5,0.5,1],'metallicFactor':0}"),
		 MATERIAL_DIFFUSE, 0.5f, 0.04f, 1},
		/* (2 - 1)^2 / (2 + 1)^2 */
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_ior':{'ior':2},'KHR_materials_specular':{'specularFactor':0.9}},'pbrMetallicRoughness':{'metallicFactor':0}"),
		 MATERIAL_GLOSSY, 1, 0.1f, 1},
		/* no coat at all, at grazing angles neither; a black coat still has one there */
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_specular':{'specularFactor':0}},'pbrMetallicRoughness':{'metallicFactor':0}"),
		 MATERIAL_DIFFUSE, 1, 0, 1},
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_specular':{'specularColorFactor':[0,0,0]}},'pbrMetallicRoughness':{'metallicFactor':0}"),
		 MATERIAL_GLOSSY, 1, 0, 1},
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_pbrSpecularGlossiness':{'diffuseFactor':[0.5,0.5,0.5,1],'specularFactor':[0.2,0.2,0.2],'glossinessFactor':0.5}}"),
		 MATERIAL_GLOSSY, 0.4f, 0.2f, 0.25f},
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_clearcoat':{'clearcoatFactor':1,'clearcoatRoughnessFactor':0.1}},'pbrMetallicRoughness':{'metallicFactor':0}"),
		 MATERIAL_GLOSSY, 1, 0.04f, 0.01f},
		/* the volume takes 0.25, its two surfaces half of that each */
		{WITH_MATERIAL(
			 "'extensions':{'KHR_materials_transmission':{'transmissionFactor':1},"
			 "'KHR_materials_volume':{'thicknessFactor':2,'attenuationDistance':1,"
			 "'attenuationColor':[0.5,0.5,0.5]}},'pbrMetallicRoughness':{'metallicFactor':0,'roughnessFactor':0}"),
		 MATERIAL_GLASS, 0.5f, 0.04f, 0.001f},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		const struct bsdf bsdf = look_up(&cases[k].form, 0, 0);

		expect_equal(bsdf.kind, cases[k].kind, "k=%zu", k);
		expect_below(fabsf(bsdf.colour.c[0] - cases[k].colour), 1e-5f, "k=%zu", k);
		expect_below(fabsf(bsdf.specular.c[1] - cases[k].specular), 1e-5f, "k=%zu", k);
		expect_below(fabsf(bsdf.alpha - cases[k].alpha), 1e-5f, "k=%zu", k);
		expect_that(!bsdf.thin, "k=%zu", k);
	}
}

/* Lengths of a volume are those of its mesh, which nodes scale; a texture of it counts by its mean,
 * 0.5. One of roughness leaves the tint. */
TEST("volume scale")
{
	static const char *const maps[] = {"'thicknessFactor':1", "'thicknessFactor':1",
					   "'thicknessFactor':2,'thicknessTexture':{'index':0}"};

	write_texture();
	for (int k = 0; k < 3; k++) {
		char root[1024];
		struct mesh mesh;

		snprintf(
			root, sizeof(root),
			TEXTURED
			"'samplers':[{}],'materials':[{'extensions':{"
			"'KHR_materials_transmission':{'transmissionFactor':1},"
			"'KHR_materials_volume':{%s,'attenuationDistance':1,'attenuationColor':[0.5,0.5,0.5]}},'pbrMetallicRoughness':{'metallicFactor':0,'roughnessFactor':0%s}}]",
			maps[k], k == 1 ? ",'metallicRoughnessTexture':{'index':0}" : "");
		mesh = read_fine(&(struct form){
			.attributes = "'POSITION':1,'TEXCOORD_0':3",
			.primitive = MATERIAL,
			.nodes =
				"{'mesh':0,'scale':[2,2,2]},{'mesh':0,'scale':[4,4,4]},{'mesh':0,'scale':[2,2,-2]}",
			.root = root});
		expect_equal(mesh.material_count, 2, "k=%d", k);
		for (int part = 0; part < 3; part++) {
			const struct material *m = &mesh.materials[mesh.parts[part].material];
			const struct bsdf bsdf = material_at(m, 0.25f, 0.25f);

			expect_below(fabsf(bsdf.colour.c[1] - (part == 1 ? 0.25f : 0.5f)), 2e-3f,
				     "k=%d, part=%d", k, part);
		}
		mesh_free(&mesh);
	}
}

/* Glass is where its texture lets light pass, by triangle: red is 1 at the right, 0 at the left
 * below. */
TEST("transmission texture")
{
	struct mesh mesh;

	write_texture();
	mesh = read_fine(&(struct form){
		.attributes = "'POSITION':1,'TEXCOORD_0':3",
		.primitive = MATERIAL,
		.root = TEXTURED
		"'samplers':[{}],'materials':[{'extensions':{'KHR_materials_transmission':"
		"{'transmissionFactor':1,'transmissionTexture':{'index':0,'extensions':"
		"{'KHR_texture_transform':{'offset':[0,0.2]}}}}},'pbrMetallicRoughness':{'metallicFactor':0,'roughnessFactor':0}}]"});
	assert_int_equal(mesh.part_count, 2);
	for (int part = 0; part < 2; part++) {
		expect_equal(mesh.parts[part].triangles, 1, "part=%d", part);
		expect_equal(mesh.materials[mesh.parts[part].material].kind,
			     part ? MATERIAL_GLOSSY : MATERIAL_GLASS, "part=%d", part);
	}
	assert_int_equal(mesh.parts[0].index[0][1], 1);
	mesh_free(&mesh);
}

/* Faces that look inwards are not hidden from outside, which is said, unless both of their sides
 * show. */
TEST("one sided")
{
	static const char *const materials[] = {"{}", "{'doubleSided':true}"};

	for (int k = 0; k < 2; k++) {
		const struct captured_log log = captured_log_begin();
		char root[512], line[512] = "";
		struct mesh mesh;
		FILE *said;

		snprintf(
			root, sizeof(root),
			",'materials':[%s],'bufferViews':[{'buffer':0,'byteLength':144}],'accessors':[{'bufferView':0,'componentType':5126,'count':12,'type':'VEC3'}]",
			materials[k]);
		mesh = read_fine(&(struct form){
			.buffer =
				"{'byteLength':144,'uri':'data:application/octet-stream;base64,"
				"AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAAAA"
				"AAAAAAAAAAAAAIA/AACAPwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AACAPwAAAAAAAAAAAAAAAAAAAAAAAIA/AAAAAAAAgD8AAAAA'}",
			.attributes = "'POSITION':0",
			.primitive = ",'material':0",
			.root = root,
			.file = "sides.gltf"});
		said = captured_log_end(&log);
		expect_equal(fgets(line, sizeof(line), said) != NULL, k == 0, "k=%d", k);
		expect_equal(
			strstr(line, "left out: hiding single-sided faces from behind of 1 mesh") !=
				NULL,
			k == 0, "k=%d", k);
		fclose(said);
		mesh_free(&mesh);
	}
}

TEST("alpha")
{
	struct mesh mesh = read_fine(&(struct form)WITH_MATERIAL(
		"'alphaMode':'MASK','alphaCutoff':0.7,'pbrMetallicRoughness':{'baseColorFactor':[1,1,1,0.6]}"));
	const struct material_point point = {.alpha = 1};

	assert_true(material_coverage(&mesh.materials[0], &point) == 0);
	mesh.materials[0].alpha_cut = 0.5f;
	assert_true(material_coverage(&mesh.materials[0], &point) == 1);
	mesh_free(&mesh);
}

/* Blending where nothing is transparent costs nothing. */
TEST("settled alpha")
{
	static const char *const attributes[] = {"'POSITION':1", "'POSITION':1,'COLOR_0':9"};

	for (int k = 0; k < 2; k++) {
		struct mesh mesh = read_fine(&(struct form){
			.attributes = attributes[k],
			.primitive = MATERIAL,
			.root = ",'materials':[{'alphaMode':'BLEND'}]",
		});

		expect_equal(mesh.materials[0].alpha_mode, k ? ALPHA_BLEND : ALPHA_OPAQUE, "k=%d",
			     k);
		mesh_free(&mesh);
	}
}

TEST("left out")
{
	const struct captured_log log = captured_log_begin();
	struct mesh mesh = read_fine(&(struct form)WITH_MATERIAL(
		"'emissiveFactor':[0,1,0],'extensions':{'KHR_materials_sheen':{},'KHR_materials_unlit':{}}"));
	char line[512] = "";
	FILE *said = captured_log_end(&log);

	assert_non_null(fgets(line, sizeof(line), said));
	assert_non_null(strstr(
		line,
		"square.gltf: left out: emission of 1 material, brightness without light of 1, KHR_materials_sheen of 1\n"));
	fclose(said);
	mesh_free(&mesh);
}

/* Lines are left out, and said. */
TEST("lines")
{
	struct captured_log log;
	struct mesh mesh;
	char line[512] = "";
	FILE *said;

	write_texture();
	log = captured_log_begin();
	mesh = read_fine(&(struct form){
		.nodes = "{'mesh':0},{'mesh':1},{'extensions':{'KHR_lights_punctual':{'light':0}}}",
		.mesh = "},{'primitives':[{'attributes':{'POSITION':1},'indices':0,'material':0},{'attributes':{'POSITION':1},'mode':1}]",
		.primitive = ",'mode':0",
		.root = TEXTURED
		"'samplers':[{}],'materials':[{'normalTexture':{'index':0}}],'animations':[{},{}]",
	});
	said = captured_log_end(&log);
	assert_int_equal(mesh.part_count, 1);
	assert_non_null(fgets(line, sizeof(line), said));
	assert_non_null(strstr(
		line,
		"square.gltf: left out: points of 1 mesh, textures without coordinates of 1, lines of 1, light of 1 lamp, movement of 2 animations\n"));
	fclose(said);
	mesh_free(&mesh);
}

/* ---- what is wrong ---- */

TEST("refusals")
{
	static const struct {
		struct form form;
		const char *words;
	} cases[] = {
		{{.root = ",'extensionsRequired':['KHR_future']"},
		 "it requires the extension \"KHR_future\""},
		{{.attributes = "'POSITION':99"}, "/meshes/0/primitives/0/attributes/POSITION: 99"},
		{{.attributes = "'NORMAL':1"}, "there is no \"POSITION\""},
		{{.attributes = "'POSITION':1.5"}, "1.5, expected a whole number"},
		{{.attributes = "'POSITION':-1"}, "-1, expected a whole number"},
		{{.attributes = "'POSITION':'x'"}, "\"x\", expected a number"},
		{{.attributes = "'POSITION':3"}, "POSITION: expected type \"VEC3\""},
		{{.attributes = "'POSITION':1,'NORMAL':2,'TANGENT':2"},
		 "TANGENT: 3 numbers an element"},
		{{.attributes = "'POSITION':1,'NORMAL':16"}, "NORMAL: 6 elements, but there are 4"},
		{{.primitive = ",'indices':3"}, "expected type \"SCALAR\""},
		{{.primitive = ",'indices':0,'mode':7"}, "/meshes/0/primitives/0/mode: 7"},
		{{.primitive = ",'indices':17",
		  .root = ",'accessors':[{},{'bufferView':1,'componentType':5126,'count':4,'type':'VEC3'}]"},
		 "/meshes/0/primitives/0/indices: 17, expected a whole number from 0 to 1"},
		{{.primitive = "",
		  .root = ",'accessors':[{},{'bufferView':1,'componentType':5126,'count':5,'type':'VEC3'}]"},
		 "/accessors/1: 5 elements from byte 0 end after bufferView 1"},
		{{.primitive = "",
		  .root = ",'accessors':[{},{'bufferView':1,'componentType':5126,'count':1e18,'type':'VEC3'}]"},
		 "/accessors/1/count: 1e+18"},
		{{.primitive = "",
		  .root = ",'accessors':[{},{'componentType':5126,'count':60000000,'type':'VEC3'}]"},
		 "it would take 720 MB of memory"},
		{{.primitive = "",
		  .root = ",'accessors':[{},{'bufferView':1,'componentType':5124,'count':3,'type':'VEC3'}]"},
		 "/accessors/1: componentType 5124"},
		{{.buffer = "{'byteLength':10000,'uri':'the%20square.bin'}"}, "expected 10000"},
		{{.buffer = "{'byteLength':36}"}, "/buffers/0: it has no bytes"},
		{{.buffer = "{'byteLength':36,'uri':'none.bin'}"}, "none.bin: No such file"},
		{{.buffer = "{'byteLength':3,'uri':'data:;base64,A*'}"}, "is none of base64"},
		{{.nodes = "{'mesh':3}"}, "/nodes/0/mesh: 3"},
		{{.nodes = "{'children':[1]},{'children':[0]}"}, "it is its own ancestor"},
		{{.nodes = "{'children':[2]},{'children':[2]},{}"}, "node 2 has two parents"},
		{{.nodes = "{'mesh':0,'scale':[1,2]}"}, "/nodes/0/scale: expected 3 numbers"},
		{{.attributes = "'POSITION':1,'JOINTS_0':11,'WEIGHTS_0':12",
		  .nodes = "{'mesh':0,'skin':0}",
		  .root = ",'skins':[{'joints':[0]}]"},
		 "hangs on joint 1"},
		{{.root = ",'asset':{'version':'1.0'}"}, "glTF of version \"1.0\""},
		{WITH_MATERIAL("'alphaMode':'SOFT'"), "/materials/0: alphaMode \"SOFT\""},
		{WITH_MATERIAL("'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}"),
		 "there are no textures"},
		{{.primitive = MATERIAL,
		  .root = ",'images':[{'bufferView':0}],'textures':[{'source':0}],'materials':[{'normalTexture':{'index':0}}]"},
		 "/images/0: not a picture"},
		{{.primitive = MATERIAL,
		  .root = ",'textures':[{'extensions':{'KHR_texture_basisu':{'source':0}}}],'materials':[{'normalTexture':{'index':0}}]"},
		 "/textures/0: it has no \"source\""},
		{{.root = ",'bufferViews':[{},{'buffer':0,'byteLength':36,'extensions':"
			  "{'EXT_meshopt_compression':{'buffer':0,'byteLength':20,'byteStride':12,'count':24000000,'mode':'ATTRIBUTES'}}}]"},
		 "it would take 288 MB of memory, expected at most 269 MB"},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct fault fault;
		struct mesh mesh;
		const int err = read_form(&mesh, &cases[k].form, &fault);

		mesh_free(&mesh);
		expect_that(err < 0, "k=%zu", k);
		expect_that(strstr(fault.text, "square.gltf: ") != NULL &&
				    strstr(fault.text, cases[k].words) != NULL,
			    "k=%zu: %s", k, fault.text);
	}
}

/* A file that is cut anywhere, or has a byte changed, is read or refused; a sanitizer sees the
 * rest. */
TEST("damage")
{
	struct fault fault;
	struct mesh mesh;
	char text[16384];
	size_t length;

	put_gltf(text,
		 &(struct form){
			 .attributes = "'POSITION':8,'TEXCOORD_0':5,'JOINTS_0':11,'WEIGHTS_0':12",
			 .nodes = "{'mesh':0,'skin':0},{}",
			 .root = ",'skins':[{'joints':[0,1],'inverseBindMatrices':13}]"});
	length = strlen(text);
	for (size_t k = 0; k < length; k += 3) {
		char kept = text[k];

		text[k] = k % 2 ? '9' : ' ';
		write_bytes("damaged.gltf", text, k % 5 ? length : k);
		text[k] = kept;
		mesh = (struct mesh){.part_count = 0};
		fault = (struct fault){.text = ""};
		expect_that((gltf_read(&mesh, small_scene_path("damaged.gltf"), 60, true, &fault) ==
			     0) == !fault.text[0],
			    "k=%zu", k);
		mesh_free(&mesh);
	}
}

TEST_GROUP(small_scene_begin, small_scene_end);
