/* SPDX-License-Identifier: MIT */
/* Tiles that are left out because no shadow can change them: each is computed as well, and has the
 * same bytes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor_parts.h"
#include "tests/support/basis/copied_basis.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 24, ACROSS = 20, WIDTH = ACROSS * BASIS_TILE + 5, HEIGHT = 12 * BASIS_TILE + 3 };

/* Multiplies numbers of the basis in its memory. */
static void scale_all(const float *scales, int count, double by)
{
	float *to = (float *)(uintptr_t)scales;

	for (int k = 0; k < count; k++)
		to[k] = (float)((double)to[k] * by);
}

/* Divides the coefficients of the first of three channels, which so has another bound. */
static void divide_first(const struct basis_block *b)
{
	int16_t *to = (int16_t *)(uintptr_t)b->coefficient;

	for (int k = 0; k < basis_panels16(b->pixels) * b->patterns * BASIS_LINE16; k++)
		to[k] /= b->channels == 3 ? 4 : 1;
}

/* Makes the shadow of each tile fainter, by up to 2^14, and its background darker, so that many
 * tiles are near the limit. */
static void make_faint(struct random_frame *f, const struct basis *basis, struct chance *chance)
{
	const struct basis_layer *layer = &basis->poses[0].shown;

	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++) {
		const struct basis_tile *tile = &layer->tiles[t];
		const double by = exp2(chance_real(chance, -14, 0));
		const int most = chance_int(chance, 1, 255);

		for (int n = 0; n < tile->block_count; n++) {
			const struct basis_block *b = &tile->blocks[n];

			divide_first(b);
			scale_all(b->pattern_scale, b->patterns, by);
			scale_all(b->column_scale, b->columns, by);
		}
		for (int y = 0; y < tile->height; y++)
			for (int x = 0; x < 4 * tile->width; x++)
				f->background[(size_t)(tile->y + y) * f->stride +
					      (size_t)(tile->x * 4 + x)] %= most + 1;
	}
}

/* A sky, and at last a sun; random colours; one light alone. */
static void make_light(struct random_frame *f, const struct basis *basis, int number,
		       struct chance *chance)
{
	float radiance[LIGHTS][3];

	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = number == 0   ? 1
					 : number == 1 ? (i ? 0.1F : 30)
					 : number == 2 ? (float)chance_real(chance, 0, 1)
						       : (float)(i == number);
	light_selection_choose(&f->lights, basis, 0, (const float(*)[3])radiance, 0, THRESHOLD_DROP,
			       1);
}

static struct layer *layer_of(struct compositor *c)
{
	return &c->poses[0].layer[COMPOSITOR_FAST];
}

/* Composites the frame with steady tiles left out, and with all computed. Returns how many were
 * left out. */
static int compare(struct random_frame *f, struct compositor *c, const char *what)
{
	struct layer *layer = layer_of(c);
	uint8_t *left_out = malloc(f->bytes);
	int steady = 0;

	assert_non_null(left_out);
	memset(layer->untried, 0, (size_t)c->tiles);
	assert_int_equal(compositor_run(c, 0, &f->lights, &f->backdrop, f->out, f->stride), 0);
	memcpy(left_out, f->out, f->bytes);
	for (int t = 0; t < c->tiles; t++)
		steady += layer->plan.tiles[t].bounded && !layer->untried[t];
	memset(layer->untried, 1, (size_t)c->tiles);
	assert_int_equal(compositor_run(c, 0, &f->lights, &f->backdrop, f->out, f->stride), 0);
	for (int t = 0; t < c->tiles; t++)
		assert_int_equal(layer->untried[t], !layer->plan.tiles[t].bounded);
	expect_same_picture(left_out, f->out, f->stride, f->bytes, "%s", what);
	free(left_out);
	return steady;
}

static void compare_kernel(struct random_frame *f, const struct basis *basis, const char *kernel,
			   struct chance *chance)
{
	static int8_t noise[GRAIN_SIDE * GRAIN_SIDE];
	const struct grain grain = {.floor = {1e-4F, 1e-4F, 1e-4F},
				    .slope = {1e-3F, 1e-3F, 1e-3F},
				    .table = {noise, noise, noise}};
	const struct compositor_options options = {.kernel = kernel};
	struct compositor *c;

	for (size_t k = 0; k < sizeof(noise); k++)
		noise[k] = (int8_t)chance_int(chance, -127, 127);
	assert_int_equal(compositor_create(&c, basis, &options, NULL), 0);
	for (int number = 0; number < 16; number++) {
		const struct compositor_settings settings = {
			.background = {.named = number % 3 == 2 ? TRANSFER_LINEAR : TRANSFER_SRGB},
			.output = {.named = number % 4 == 3 ? TRANSFER_LINEAR : TRANSFER_SRGB},
			.gain = 1,
			.object = true,
			.grain = number % 2 ? &grain : NULL};
		int steady;

		make_light(f, basis, number, chance);
		compositor_set(c, &settings);
		steady = compare(f, c, kernel);
		expect_that(steady > c->tiles / 20 && steady < c->tiles,
			    "%s, light %d: %d of %d tiles left out", kernel, number, steady,
			    c->tiles);
	}
	compositor_destroy(c);
}

TEST("a tile that is left out has the bytes of one that is computed")
{
	const struct synthetic_options options = {.width = WIDTH,
						  .height = HEIGHT,
						  .lights = LIGHTS,
						  .grounds = 2,
						  .patterns = 3,
						  .columns = 5,
						  .bits = 8,
						  .layers = 2,
						  .vary = true,
						  .ground_share = 0.9,
						  .bounce = 0.5,
						  .column_cut = 0.001,
						  .seed = 47};
	struct chance chance = chance_begin("steady");
	struct synthetic s;
	struct copied copy; /* struct synthetic's basis may not be written to */
	struct basis basis;
	struct random_frame f;
	struct fault fault = {""};

	synthetic_open(&s, &options);
	copy = copied_file(s.path);
	expect_success(
		basis_open_memory(&basis, copy.data, copy.bytes, "copy", BASIS_SHOWN, &fault),
		&fault);
	random_frame_begin(&f, &basis, NULL, &chance);
	make_faint(&f, &basis, &chance);
	for (int k = 0; kernels_all[k]; k++)
		if (kernels_all[k]->supported())
			compare_kernel(&f, &basis, kernels_all[k]->name, &chance);
	random_frame_end(&f);
	basis_close(&basis);
	copied_free(&copy);
	synthetic_close(&s);
}
