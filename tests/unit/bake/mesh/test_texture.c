/* SPDX-License-Identifier: MIT */
/* What a texture shows at a place, and what it changes of a material. */
#include "bake/mesh/material.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static uint8_t row[] = {0, 0, 0, 255, 255, 255, 51, 102, 153, 0, 0, 0};
static uint8_t alpha[] = {0, 255, 51, 204};

/* A row of four texels. */
static struct texture make_row(void)
{
	struct texture texture = {
		.image = {.width = 4, .height = 1, .u8 = row, .alpha = alpha},
	};

	texture_prepare_data(&texture);
	return texture;
}

TEST("wrap")
{
	/* places in texels from the left edge; the red value there, linear between centres */
	static const struct {
		enum texture_wrap wrap;
		bool nearest;
		float at, expected;
	} cases[] = {
		{TEXTURE_REPEAT, false, 1.5f, 1},      {TEXTURE_REPEAT, false, 1, 0.5f},
		{TEXTURE_REPEAT, false, 6.5f, 0.2f},   {TEXTURE_REPEAT, false, -1.5f, 0.2f},
		{TEXTURE_REPEAT, false, 3.25f, 0.05f}, {TEXTURE_CLAMP, false, 9, 0},
		{TEXTURE_CLAMP, false, 1.5f, 1},       {TEXTURE_CLAMP, false, -3, 0},
		{TEXTURE_MIRROR, false, 5.5f, 0.2f},   {TEXTURE_MIRROR, false, -1.5f, 1},
		{TEXTURE_MIRROR, false, 9.5f, 1},      {TEXTURE_REPEAT, true, 1.1f, 1},
		{TEXTURE_REPEAT, true, 1.9f, 1},       {TEXTURE_REPEAT, true, 2.1f, 0.2f},
		{TEXTURE_REPEAT, true, 3.99f, 0},
	};

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct texture texture = make_row();

		texture.wrap[0] = cases[k].wrap;
		texture.nearest = cases[k].nearest;
		expect_below(
			fabsf(texture_at(&texture, cases[k].at / 4, 0.3f).c[0] - cases[k].expected),
			1e-5f, "k=%zu", k);
	}
}

TEST("coverage")
{
	const struct texture texture = make_row();
	struct material m = {.alpha = 0.5f, .alpha_cut = 0.3f, .texture = &texture};
	const struct material_point at[] = {
		{{{0.375f, 0}}, {{1, 1, 1}}, 1},    /* texel 1 */
		{{{0.875f, 0}}, {{1, 1, 1}}, 0.5f}, /* texel 3, of vertices with alpha 0.5 */
	};

	assert_true(material_coverage(&m, &at[1]) == 1);
	m.alpha_mode = ALPHA_BLEND;
	expect_below(fabsf(material_coverage(&m, &at[0]) - 0.5f), 1e-6f, "texel 1");
	expect_below(fabsf(material_coverage(&m, &at[1]) - 0.2f), 1e-6f, "texel 3");
	m.alpha_mode = ALPHA_MASK;
	assert_true(material_coverage(&m, &at[0]) == 1);
	assert_true(material_coverage(&m, &at[1]) == 0);
}

/* The second coordinates, turned and moved. */
TEST("placed")
{
	const struct texture texture = make_row();
	const struct material m = {
		.colour = {{1, 1, 1}},
		.placed = {&texture, 1, {0, 1, 0.25f, -1, 0, 1}},
	};
	const struct material_point at = {{{0.6f, 0.9f}, {0.5f, 0.125f}}, {{1, 0.5f, 1}}, 1};
	const struct bsdf bsdf = material_at_point(&m, &at);

	expect_below(fabsf(bsdf.colour.c[0] - 1), 1e-6f, "red");
	expect_below(fabsf(bsdf.colour.c[1] - 0.5f), 1e-6f, "green, of the vertices");
}

TEST("surface map")
{
	const struct texture texture = make_row();
	const struct texture_use use = {&texture, 0, {1, 0, 0, 0, 1, 0}};
	struct material m = {
		.kind = MATERIAL_GLOSSY,
		.map = {.use = use,
			.base = {{0.5f, 0.6f, 1}},
			.specular = {{0.04f, 0.04f, 0.04f}},
			.metallic = 0.5f,
			.roughness = 0.5f},
	};
	struct bsdf bsdf = material_at(&m, 0.625f, 0); /* texel 2: green 0.4, blue 0.6 */

	expect_below(fabsf(bsdf.alpha - 0.04f), 1e-6f, "roughness 0.2");
	expect_below(fabsf(bsdf.colour.c[1] - 0.6f * 0.7f), 1e-6f, "base of metalness 0.3");
	expect_below(fabsf(bsdf.specular.c[1] - (0.04f * 0.7f + 0.6f * 0.3f)), 1e-6f, "coat");
	m.map.glossiness = true;
	m.map.specular = rgb_make(0.5f, 0.5f, 0.5f);
	m.map.roughness = 0;
	bsdf = material_at(&m, 0.625f, 0); /* alpha 0.2 */
	expect_below(fabsf(bsdf.alpha - 0.64f), 1e-6f, "roughness 0.8");
	expect_below(fabsf(bsdf.specular.c[2] - 0.3f), 1e-6f, "specular");
	expect_below(fabsf(bsdf.colour.c[0] - 0.5f * 0.7f), 1e-6f, "base");
}

/* A texel that leans towards +u and -v, on a surface whose axes are skewed and mirrored. */
TEST("bump")
{
	uint8_t leaning[] = {204, 51, 255};
	struct texture texture = {.image = {.width = 1, .height = 1, .u8 = leaning}};
	const struct material m = {
		.bumps = {&texture, 0, {1, 0, 0, 0, 1, 0}},
		.bump_scale = 0.5f,
	};
	const struct material_point at = {.alpha = 1};
	struct v3 n;

	texture_prepare_data(&texture);
	n = material_bump(&m, &at, v3_make(2, 0, 1), v3_make(0.1f, -3, 0), v3_make(0, 0, 1));
	/* (0.3, -0.3, 1) with v along -y */
	expect_below(fabsf(n.x / n.z - 0.3f), 1e-5f, "along u");
	expect_below(fabsf(n.y / n.z - 0.3f), 1e-5f, "along -v");
}
