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

/* Levels of the screen where a mirror shows a third of this light. */
static double level_of(double light)
{
	return 255 * transfer_encode(TRANSFER_SRGB, fmin(light / 3, 1));
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

/* A lamp that shades off, in two exposures with noise: second differences of what mirrors show of
 * it, beside those of the pictures' pixels, which have the noise that the fisheye has anyway. */
TEST("mirrors flicker less than the fisheye's pictures")
{
	enum { FRAMES = 100 };
	static const double ratio[2] = {1, 0.1};
	struct pipeline_settings settings = plain_pipeline(1);
	static double pixel[3][MIRRORS], seen[3][MIRRORS];
	struct chance noise = chance_begin("noise");
	const struct picture view = {picture[0], 4, 4 * SIDE, SIDE, SIDE};
	double pixels = 0, worst = 0, mirrors[MIRRORS] = {0};
	struct fault fault = {""};
	struct fisheye lens;
	struct pipeline *p;

	/* Mirrors show the directions of pixels in a square around the lamp. */
	expect_success(fisheye_prepare(&lens, &settings.lens, SIDE, SIDE, &fault), &fault);
	for (int k = 0; k < MIRRORS; k++) {
		const double px[2] = {19.5 + k % 20 * 3, 19.5 + k / 20 * 3};
		double d[3], place[2];

		assert_true(fisheye_ray(&lens, px, d));
		sky_square_of(d, place);
		mirror[k].u = (uint16_t)(65536 * place[0]);
		mirror[k].v = (uint16_t)(65536 * place[1]);
	}
	settings.exposures = 2;
	memcpy(settings.exposure, ratio, sizeof(ratio));
	p = open_pipeline(&settings, MIRRORS);
	for (int t = 0; t < 2 * FRAMES; t++) {
		for (int at = 0; at < SIDE * SIDE; at++) {
			const double off = hypot(at % SIDE - 45.3, at / SIDE - 49.6) / 16;
			const double light = 0.1 + 6 * exp(-off * off);
			/* sRGB, which goes on above white until noise has been added */
			const double code = 255 *
					    (1.055 * pow(light * ratio[t % 2], 1 / 2.4) - 0.055);

			for (int c = 0; c < 3; c++)
				picture[at][c] = (uint8_t)fmin(
					code + (double)chance_int(&noise, -2, 2), 255);
		}
		pipeline_expose(p, t % 2, ratio);
		assert_int_equal(pipeline_light_picture(p, &view, NULL), 0);
		choose(p);
		for (int k = 0; k < MIRRORS; k++) {
			const int at = (19 + k / 20 * 3) * SIDE + 19 + k % 20 * 3,
				  code = picture[at][1];
			if (t % 2 == 0) {
				seen[t / 2 % 3][k] = level_of(shown(p, k, 1));
				pixel[t / 2 % 3][k] = code < 255 ? level_of(light_of(code)) : -1;
			} else if (pixel[t / 2 % 3][k] < 0) {
				pixel[t / 2 % 3][k] = level_of(light_of(code) / ratio[1]);
			}
			if (t % 2 == 0 || t < 8)
				continue;
			mirrors[k] += pow(seen[0][k] + seen[1][k] + seen[2][k] -
						  3 * seen[(t / 2 + 2) % 3][k],
					  2);
			pixels += pow(pixel[0][k] + pixel[1][k] + pixel[2][k] -
					      3 * pixel[(t / 2 + 2) % 3][k],
				      2);
		}
	}
	for (int k = 0; k < MIRRORS; k++)
		worst = fmax(worst, sqrt(mirrors[k] * MIRRORS / pixels));
	print_message("# second difference of the worst mirror: %.2f of that of pixels\n", worst);
	expect_below(worst, 1.5, "flicker");
	pipeline_destroy(p);
}

TEST_GROUP(open_basis, close_basis);
