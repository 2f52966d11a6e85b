/* SPDX-License-Identifier: MIT */
/* A tile under lights that all send the same, so that every weight ends in the same digits. The
 * sums are as large as they can be with that many lights, below and above the number of columns
 * from which the compositor converts them to Q24 at once. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/basis/basis_writer.h"
#include "hal/compositor/compositor.h"
#include "hal/compositor/kernels/kernels.h"
#include "hal/optics/dome.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 46, FREQUENCY = 3, PIXELS = BASIS_TILE * BASIS_TILE };

static char folder[] = "/tmp/test_compositor_lines_XXXXXX";
static char path[80];
static struct basis basis;

/* Each light alone makes every pixel as bright as its solid angle times its radiance. */
static void write_basis(const char *to)
{
	struct basis_info_chunk info = {.width = BASIS_TILE,
					.height = BASIS_TILE,
					.lights = LIGHTS,
					.dome_frequency = FREQUENCY,
					.poses = 1,
					.coarse = LIGHTS,
					.column_cut = 1e-12};
	static struct basis_light lights[LIGHTS];
	static uint16_t coverage[PIXELS], pixel[PIXELS];
	static float peak[LIGHTS + 1][3], value[PIXELS * 3][LIGHTS];
	struct basis_block_payload block;

	hand_block_lights(FREQUENCY, LIGHTS, lights);
	for (int i = 0; i < LIGHTS; i++) {
		const float share = (float)lights[i].solid_angle_sr;

		for (int k = 0; k < PIXELS * 3; k++)
			value[k][i] = share;
		for (int c = 0; c < 3; c++) {
			peak[i][c] = share;
			peak[LIGHTS][c] += share;
		}
	}
	for (int p = 0; p < PIXELS; p++) {
		pixel[p] = (uint16_t)p;
		coverage[p] = 65535;
	}
	block = hand_block_of_object(0, PIXELS, pixel, LIGHTS, lights, &value[0][0]);
	hand_block_file(to, &info, lights, &block, coverage, (const float(*)[3])peak);
}

static int setup(void **state)
{
	struct fault fault = {.text = ""};

	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/lines.inlay", folder);
	write_basis(path);
	expect_success(basis_open(&basis, path, BASIS_SHOWN, &fault), &fault);
	return 0;
}

static int teardown(void **state)
{
	(void)state;
	basis_close(&basis);
	unlink(path);
	return rmdir(folder);
}

/* Composites with `lit` equal lights whose radiance adds up to `bright`. */
static void test_lines_check(struct compositor *compositor, struct light_selection *selection,
			     int lit, double bright)
{
	static uint8_t background[PIXELS * 4], out[PIXELS * 4];
	const struct picture picture = {background, 4, BASIS_TILE * 4, BASIS_TILE, BASIS_TILE};
	const struct backdrop backdrop = backdrop_of(&picture);
	const double level = 255 * transfer_encode(TRANSFER_SRGB, bright);
	float radiance[LIGHTS][3] = {{0}};

	for (int i = 0; i < lit; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)(bright / lit / basis.lights[i].solid_angle_sr);
	light_selection_choose(selection, &basis, 0, (const float(*)[3])radiance, 0, THRESHOLD_DROP,
			       1);
	assert_int_equal(compositor_run(compositor, 0, selection, &backdrop, out, BASIS_TILE * 4),
			 0);
	assert_int_equal(compositor_last(compositor).columns, lit);
	for (int k = 0; k < PIXELS * 4; k++)
		if (k % 4 < 3 && fabs(out[k] - level) > 0.6)
			fail_msg("%d lights, %g of white, pixel %d: %d, expected %g", lit, bright,
				 k / 4, out[k], level);
}

TEST("lines add up however many count")
{
	const struct compositor_settings settings = {.mode = COMPOSITOR_FAST,
						     .background = {.named = TRANSFER_SRGB},
						     .output = {.named = TRANSFER_SRGB},
						     .gain = 1,
						     .object = true};

	for (int k = 0; kernels_all[k]; k++) {
		const struct compositor_options options = {.kernel = kernels_all[k]->name};
		struct light_selection selection;
		struct compositor *compositor;
		struct fault fault = {.text = ""};

		if (!kernels_all[k]->supported())
			continue;
		expect_success(compositor_create(&compositor, &basis, &options, &fault), &fault);
		compositor_set(compositor, &settings);
		assert_int_equal(light_selection_create(&selection, &basis), 0);
		for (int lit = 1; lit <= LIGHTS; lit++)
			for (double bright = 0.02; bright < 1; bright *= 1.3)
				test_lines_check(compositor, &selection, lit, bright);
		light_selection_free(&selection);
		compositor_destroy(compositor);
	}
}

TEST_GROUP(setup, teardown);
