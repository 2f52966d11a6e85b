/* SPDX-License-Identifier: MIT */
/* The sky that mirrors show, as the pipeline fills it: with and without a picture, what clips, in
 * grey, of several exposures, and whether it flickers. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/mirror/mirror_look.h"
#include "hal/optics/sky_square.h"
#include "hal/optics/vec.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/plain_pipeline.h"
#include "tests/support/test.h"

enum { LIGHTS = 26, SIDE = 96, MIRRORS = 400 };

/* A lamp of ten degrees in the fisheye's picture. */
static const double lamp[3] = {0.6, -0.48, 0.64};

static char folder[] = "/tmp/test_app_mirror_XXXXXX";
static char path[80];
static struct basis basis;
static struct basis_mirror mirror[MIRRORS];
static uint8_t picture[SIDE * SIDE][4];

/* One object pixel; its mirrors, all over the sky, are added to the open file. */
static int open_basis(void **state)
{
	struct basis_info_chunk info = {.width = 16,
					.height = 16,
					.lights = LIGHTS,
					.dome_frequency = 2,
					.poses = 1,
					.coarse = LIGHTS};
	static struct basis_light lights[LIGHTS];
	static uint16_t coverage[16 * 16] = {65535};
	static float peak[LIGHTS + 1][3], value[3][LIGHTS];
	const uint16_t pixel = 0;
	struct chance chance = {3};
	struct basis_block_payload block;
	struct fault fault = {""};

	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/hand.inlay", folder);
	hand_block_lights(2, LIGHTS, lights);
	for (int c = 0; c < 3; c++)
		value[c][0] = peak[0][c] = peak[LIGHTS][c] = 0.1F;
	block = hand_block_of_object(0, 1, &pixel, LIGHTS, lights, &value[0][0]);
	hand_block_file(path, &info, lights, &block, coverage, (const float(*)[3])peak);
	expect_success(basis_open(&basis, path, BASIS_SHOWN, &fault), &fault);
	for (int k = 0; k < MIRRORS; k++) {
		double place[2], d[3] = {1, 0, 0};

		for (int c = 0; c < 3; c++)
			d[c] = k ? chance_real(&chance, c < 2 ? -1 : 0.1, 1) : lamp[c];
		sky_square_of(d, place);
		mirror[k] = (struct basis_mirror){.u = (uint16_t)(65536 * place[0]),
						  .v = (uint16_t)(65536 * place[1]),
						  .throughput = {65535, 65535, 65535},
						  .level = (uint16_t)(k % 2 * 700)};
	}
	return 0;
}

static int close_basis(void **state)
{
	(void)state;
	basis_close(&basis);
	unlink(path);
	return rmdir(folder);
}

static struct pipeline *open_pipeline(const struct pipeline_settings *settings, size_t mirrors)
{
	struct pipeline *pipeline;
	struct fault fault = {""};

	basis.poses[0].mirror = mirror;
	basis.poses[0].mirror_count = mirrors;
	expect_success(pipeline_create(&pipeline, &basis, settings, &fault), &fault);
	return pipeline;
}

static void choose(struct pipeline *p)
{
	const struct pipeline_choice choice = {.object = true};

	assert_int_equal(pipeline_choose(p, &choice, NULL), 0);
}

/* Takes a picture of these colours, B G R, with another where the lamp is, and noise; and fills the
 * map. */
static void show(struct pipeline *p, const int sky[3], const int lit[3], struct chance *noise)
{
	const struct picture view = {picture[0], 4, 4 * SIDE, SIDE, SIDE};
	struct fault fault = {""};
	struct fisheye lens;

	expect_success(fisheye_prepare(&lens, &p->settings.lens, SIDE, SIDE, &fault), &fault);
	for (int at = 0; at < SIDE * SIDE; at++) {
		const double px[2] = {at % SIDE + 0.5, at / SIDE + 0.5};
		double d[3] = {0, 0, -1};
		const bool is_lit = fisheye_ray(&lens, px, d) &&
				    vec_angle(d, lamp) < 5 * M_PI / 180;

		for (int c = 0; c < 3; c++) {
			const int code = (is_lit ? lit : sky)[c] +
					 (noise ? (int)chance_int(noise, -3, 3) : 0);

			picture[at][c] = (uint8_t)(code > 255 ? 255 : code);
		}
	}
	assert_int_equal(pipeline_light_picture(p, &view, NULL), 0);
	choose(p);
}

/* What one of the mirrors shows. */
static double shown(const struct pipeline *p, int number, int c)
{
	struct mirror_look look;

	mirror_look_aim(&look, &mirror[number], p->mirror.map.least);
	return (double)mirror_look_read(&p->mirror.map, &look)[c] / 65535 / MIRROR_LOOK_ONE;
}

static double light_of(int code)
{
	return transfer_decode(TRANSFER_SRGB, code / 255.0);
}

TEST("lights are shown until a picture comes")
{
	static const int even[3] = {90, 120, 150};
	struct pipeline_settings settings = plain_pipeline(1);
	float radiance[LIGHTS][3] = {{0}};
	struct pipeline *p;

	settings.gain = 3; /* the compositor's */
	settings.sampler.gain = 2;
	p = open_pipeline(&settings, MIRRORS);
	for (int i = 0; i < LIGHTS; i++)
		radiance[i][1] = 7;
	pipeline_light_given(p, (const float(*)[3])radiance);
	choose(p);
	for (int k = 0; k < MIRRORS; k++)
		expect_below(fabs(shown(p, k, 1) / 7 - 1), 1e-6, "given light, mirror %d", k);
	show(p, even, even, NULL);
	assert_ptr_equal(p->selection.mirror, &p->mirror.map);
	for (int k = 0; k < MIRRORS; k++)
		for (int c = 0; c < 3; c++)
			expect_below(fabs(shown(p, k, c) / 2 / light_of(even[2 - c]) - 1), 1e-4,
				     "picture, mirror %d, c=%d", k, c);
	pipeline_destroy(p);
}

TEST("in neutral light mirrors are grey")
{
	static const int sky[3] = {90, 120, 150};
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *p;

	settings.neutral = 1;
	p = open_pipeline(&settings, MIRRORS);
	show(p, sky, sky, NULL);
	for (int k = 0; k < MIRRORS; k++)
		for (int c = 0; c < 3; c++)
			expect_below(fabs(shown(p, k, c) - 0.2126 * light_of(150) -
					  0.7152 * light_of(120) - 0.0722 * light_of(90)),
				     1e-4, "mirror %d, c=%d", k, c);
	pipeline_destroy(p);
}

TEST("a pose without mirrors costs nothing")
{
	static const int sky[3] = {90, 90, 90};
	const struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *p = open_pipeline(&settings, 0);

	show(p, sky, sky, NULL);
	assert_null(p->selection.mirror);
	assert_null(p->mirror.map.texel);
	assert_int_equal(p->mirror.eye.width, 0);
	pipeline_destroy(p);
}

/* The lamp clips in the first exposure; the second, a twentieth of the light, shows it whole. */
TEST("what clips comes from a shorter exposure, and all else from the first")
{
	static const int sky[3] = {90, 90, 90}, clipped[3] = {255, 255, 255};
	static const int dark[3] = {17, 17, 17}, whole[3] = {200, 200, 200};
	static const double ratio[2] = {1, 0.05};
	struct pipeline_settings settings = plain_pipeline(1);
	const double bright = light_of(200) / ratio[1];
	struct pipeline *p;

	settings.exposures = 2;
	memcpy(settings.exposure, ratio, sizeof(ratio));
	p = open_pipeline(&settings, MIRRORS);
	for (int k = 0; k < 4; k++) {
		pipeline_expose(p, k % 2, ratio);
		show(p, k % 2 ? dark : sky, k % 2 ? whole : clipped, NULL);
	}
	print_message("# lamp of %.1f: %.1f\n", bright, shown(p, 0, 1));
	expect_below(fabs(shown(p, 0, 1) / bright - 1), 0.1, "the lamp");
	for (int k = 2; k < MIRRORS; k += 2) {
		const double place[2] = {mirror[k].u / 65536.0, mirror[k].v / 65536.0};
		double d[3];

		sky_square_direction(place, d);
		if (vec_angle(d, lamp) > 12 * M_PI / 180)
			expect_below(fabs(shown(p, k, 1) / light_of(90) - 1), 1e-4, "mirror %d", k);
	}
	pipeline_destroy(p);
}

/* Second differences of what mirrors show, beside those of single pixels of the picture, which have
 * the noise that the fisheye's picture has anyway. */
TEST("mirrors flicker less than the fisheye's picture")
{
	enum { FRAMES = 100 };
	static const int sky[3] = {110, 110, 110}, lit[3] = {253, 253, 253};
	static const int probe[2] = {SIDE * SIDE / 3, SIDE * SIDE / 2 + SIDE / 4};
	const struct pipeline_settings settings = plain_pipeline(1);
	static double own[FRAMES][2], seen[FRAMES][MIRRORS];
	struct chance noise = chance_begin("noise");
	double pixels = 0, mirrors = 0, lamps = 0;
	struct pipeline *p = open_pipeline(&settings, MIRRORS);

	for (int t = 0; t < FRAMES; t++) {
		show(p, sky, lit, &noise); /* the lamp clips in some pixels of each frame */
		for (int k = 0; k < 2; k++)
			own[t][k] = light_of(picture[probe[k]][1]);
		for (int k = 0; k < MIRRORS; k++)
			seen[t][k] = shown(p, k, 1);
	}
	for (int t = 2; t < FRAMES; t++) {
		for (int k = 0; k < 2; k++)
			pixels += pow(own[t][k] - 2 * own[t - 1][k] + own[t - 2][k], 2) / 2;
		for (int k = 0; k < MIRRORS; k++)
			mirrors += pow(seen[t][k] - 2 * seen[t - 1][k] + seen[t - 2][k], 2) /
				   MIRRORS;
		lamps += pow(seen[t][0] - 2 * seen[t - 1][0] + seen[t - 2][0], 2);
	}
	print_message("# second difference: %.4f in mirrors, %.4f in pixels, %.4f in the lamp\n",
		      sqrt(mirrors / FRAMES), sqrt(pixels / FRAMES), sqrt(lamps / FRAMES));
	expect_below(sqrt(mirrors / pixels), 1.5, "flicker");
	pipeline_destroy(p);
}

TEST_GROUP(open_basis, close_basis);
