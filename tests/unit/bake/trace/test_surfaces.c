/* SPDX-License-Identifier: MIT */
/* What rays meet on a square whose material has alpha, colours of vertices or bumps. */
#include <math.h>

#include "bake/base/random.h"
#include "bake/trace/world.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define RAYS 16000

/* From (0, 0, 2) to (1, 1, 2), seen from below, with texture coordinates x and 1 - y. */
static float position[4][4] = {{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
static struct v3 normal[4] = {{0, 0, -1}, {0, 0, -1}, {0, 0, -1}, {0, 0, -1}};
static float uv[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
static uint32_t corner[2][3] = {{0, 2, 1}, {0, 3, 2}};

static struct mesh_part square = {.vertices = 4,
				  .triangles = 2,
				  .position = position,
				  .normal = normal,
				  .uv = uv,
				  .index = corner};
static const struct mesh mesh = {.parts = &square, .part_count = 1};

static struct world *make_world(const struct material *material)
{
	struct fault fault = {.text = ""};
	struct world *world;

	expect_success(world_create(&world, &fault), &fault);
	expect_success(world_add(world, &mesh, material, SURFACE_OBJECT, &fault), &fault);
	expect_success(world_commit(world, &fault), &fault);
	return world;
}

/* From (0.5, 0.5, 0) to a point of the square. */
static struct v3 towards(float x, float y)
{
	return v3_unit(v3_make(x - 0.5f, y - 0.5f, 2));
}

/* A quarter of the rays meets a surface of alpha 0.25, alone and in batches. */
TEST("blend")
{
	const struct material veil = {
		.colour = {{1, 1, 1}}, .alpha_mode = ALPHA_BLEND, .alpha = 0.25f};
	const struct v3 from = {0.5f, 0.5f, 0};
	struct world *world = make_world(&veil);
	struct random random = {.state = 5};
	struct ray_batch batch;
	double alone = 0, together = 0;

	assert_int_equal(ray_batch_create(&batch), 0);
	batch.count = RAYS;
	for (int k = 0; k < RAYS; k++) {
		const float x = random_next(&random), y = random_next(&random);
		const struct v3 d = towards(x, y);
		struct surface s, again;
		const bool met = world_nearest(world, WITH_OBJECTS, from, d, &s);

		expect_equal(met, world_nearest(world, WITH_OBJECTS, from, d, &again), "k=%d", k);
		alone += met;
		batch.x[k] = d.x;
		batch.y[k] = d.y;
		batch.z[k] = d.z;
	}
	world_occluded(world, WITH_OBJECTS, from, &batch);
	for (int k = 0; k < RAYS; k++)
		together += batch.blocked[k] == RAY_BLOCKED;
	/* four standard deviations */
	expect_below(fabs(alone / RAYS - 0.25), 4 * sqrt(0.25 * 0.75 / RAYS), "alone");
	expect_below(fabs(together / RAYS - 0.25), 4 * sqrt(0.25 * 0.75 / RAYS), "together");
	ray_batch_free(&batch);
	world_destroy(world);
}

/* The left half is a hole. */
TEST("mask")
{
	static uint8_t white[] = {255, 255, 255, 255, 255, 255}, alpha[] = {0, 255};
	struct texture texture = {.image = {.width = 2, .height = 1, .u8 = white, .alpha = alpha},
				  .nearest = true};
	const struct material material = {.colour = {{1, 1, 1}},
					  .texture = &texture,
					  .alpha_mode = ALPHA_MASK,
					  .alpha = 1,
					  .alpha_cut = 0.5f};
	struct world *world = make_world(&material);

	texture_prepare(&texture);
	for (int k = 0; k < 100; k++) {
		const float x = ((float)k + 0.5f) / 100;
		struct surface s;

		expect_equal(world_nearest(world, WITH_OBJECTS, v3_make(0.5f, 0.5f, 0),
					   towards(x, 0.3f), &s),
			     x > 0.5f, "x=%g", (double)x);
	}
	world_destroy(world);
}

TEST("colours")
{
	static float colour[4][4] = {{0, 0, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}};
	const struct material material = {.colour = {{0.5f, 1, 1}}};
	struct world *world = make_world(&material);
	struct surface s;

	square.colour = colour;
	assert_true(world_nearest(world, WITH_OBJECTS, v3_make(0.5f, 0.5f, 0), towards(0.3f, 0.8f),
				  &s));
	square.colour = NULL;
	expect_below(fabsf(s.bsdf.colour.c[0] - 0.15f), 1e-5f, "red");
	expect_below(fabsf(s.bsdf.colour.c[1] - 0.8f), 1e-5f, "green");
	expect_below(s.bsdf.colour.c[2], 1e-5f, "blue");
	assert_ptr_equal(s.mesh, &mesh);
	world_destroy(world);
}

/* A texel leans towards +u, +x, and towards +v, -y; the surface faces down. */
TEST("bumps")
{
	static uint8_t leaning[] = {204, 179, 255}; /* (0.6, 0.404, 1) */
	struct texture texture = {.image = {.width = 1, .height = 1, .u8 = leaning}};
	const struct material material = {
		.colour = {{1, 1, 1}}, .bumps = {&texture, 0, {1, 0, 0, 0, 1, 0}}, .bump_scale = 1};
	struct world *world = make_world(&material);
	struct surface s;

	texture_prepare_data(&texture);
	for (int side = -1; side <= 1;
	     side += 2) { /* a face seen from behind leans the other way */
		const struct v3 from = {0.3f, 0.3f, 2 + 2 * (float)side};

		assert_true(
			world_nearest(world, WITH_OBJECTS, from, v3_make(0, 0, (float)-side), &s));
		expect_below(fabsf(s.normal.x / s.normal.z + 0.6f), 1e-4f, "side=%d", side);
		expect_below(fabsf(s.normal.y / s.normal.z - 0.40392f), 1e-4f, "side=%d", side);
		expect_that(s.normal.z * (float)side > 0, "side=%d", side);
	}
	world_destroy(world);
}

/* A texture that is turned by 90 degrees turns its axes: u' = v, v' = -u, so that +u' is -y and +v'
 * is -x. */
TEST("bumps turned")
{
	static uint8_t leaning[] = {204, 179, 255};
	struct texture texture = {.image = {.width = 1, .height = 1, .u8 = leaning}};
	const struct material material = {.colour = {{1, 1, 1}},
					  .bumps = {&texture, 0, {0, 1, 0, -1, 0, 1}},
					  .bump_scale = 1};
	struct world *world = make_world(&material);
	struct surface s;

	texture_prepare_data(&texture);
	assert_true(
		world_nearest(world, WITH_OBJECTS, v3_make(0.3f, 0.3f, 0), v3_make(0, 0, 1), &s));
	expect_below(fabsf(s.normal.x / -s.normal.z + 0.40392f), 1e-4f, "%d", 0);
	expect_below(fabsf(s.normal.y / -s.normal.z + 0.6f), 1e-4f, "%d", 0);
	world_destroy(world);
}

/* The same with tangents of its own, along +y; along v is then +x, of another sign -x. */
TEST("tangents")
{
	static uint8_t leaning[] = {204, 179, 255};
	static float tangent[4][4] = {{0, 2, 0, 1}, {0, 2, 0, 1}, {0, 2, 0, 1}, {0, 2, 0, 1}};
	struct texture texture = {.image = {.width = 1, .height = 1, .u8 = leaning}};
	const struct material material = {
		.colour = {{1, 1, 1}}, .bumps = {&texture, 0, {1, 0, 0, 0, 1, 0}}, .bump_scale = 1};
	struct surface s;

	texture_prepare_data(&texture);
	square.tangent = tangent;
	for (int sign = -1; sign <= 1; sign += 2) {
		struct world *world;

		for (int v = 0; v < 4; v++)
			tangent[v][3] = (float)sign;
		world = make_world(&material);
		assert_true(world_nearest(world, WITH_OBJECTS, v3_make(0.3f, 0.3f, 0),
					  v3_make(0, 0, 1), &s));
		expect_below(fabsf(s.normal.x / -s.normal.z - 0.40392f * (float)sign), 1e-4f,
			     "sign=%d", sign);
		expect_below(fabsf(s.normal.y / -s.normal.z - 0.6f), 1e-4f, "sign=%d", sign);
		world_destroy(world);
	}
	square.tangent = NULL;
}
