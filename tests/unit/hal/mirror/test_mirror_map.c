/* SPDX-License-Identifier: MIT */
/* The sky as mirrors show it: look-ups against double precision and at their extremes, energy, and
 * the fisheye's picture against the light that the sampler measures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/sampler.h"
#include "hal/mirror/mirror_eye.h"
#include "hal/mirror/mirror_look.h"
#include "hal/optics/sky_square.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define FREQUENCY 9
#define LEVEL_MOST ((BASIS_MIRROR_LEVELS - 1) * BASIS_MIRROR_STEP)

/* A basis that is nothing but the lights of a dome. */
struct sky {
	struct dome dome;
	struct basis_light *lights;
	struct basis basis;
	struct mirror_map map;
};

static void sky_open(struct sky *sky)
{
	struct fault fault = {""};

	memset(sky, 0, sizeof(*sky));
	assert_int_equal(dome_create(&sky->dome, FREQUENCY, &fault), 0);
	sky->lights = calloc((size_t)sky->dome.count, sizeof(*sky->lights));
	assert_non_null(sky->lights);
	for (int i = 0; i < sky->dome.count; i++) {
		memcpy(sky->lights[i].direction, sky->dome.direction[i], 3 * sizeof(double));
		sky->lights[i].solid_angle_sr = sky->dome.solid_angle_sr[i];
	}
	sky->basis.lights = sky->lights;
	sky->basis.info.lights = (uint32_t)sky->dome.count;
	sky->basis.info.dome_frequency = FREQUENCY;
	assert_int_equal(mirror_map_create(&sky->map, &sky->basis, &fault), 0);
}

static void sky_close(struct sky *sky)
{
	mirror_map_free(&sky->map);
	free(sky->lights);
	dome_free(&sky->dome);
}

static mirror_light looked_up(const struct mirror_map *map, const struct basis_mirror *m)
{
	struct mirror_look look;

	mirror_look_aim(&look, m, map->least);
	return mirror_look_read(map, &look);
}

static double looked(const struct mirror_map *map, double u, double v, int level, int c)
{
	const struct basis_mirror m = {.u = (uint16_t)lround(fmin(65536 * u, 65535)),
				       .v = (uint16_t)lround(fmin(65536 * v, 65535)),
				       .throughput = {65535, 65535, 65535},
				       .level = (uint16_t)level};

	return (double)looked_up(map, &m)[c] / 65535 / MIRROR_LOOK_ONE;
}

TEST("an even sky is even everywhere")
{
	static const double none[3], one[][3] = {{0.25, 1, 200000}};
	struct sky sky;
	double(*radiance)[3];
	struct chance chance = chance_begin("even sky");

	sky_open(&sky);
	radiance = calloc((size_t)sky.dome.count, sizeof(*radiance));
	assert_non_null(radiance);
	for (int i = 0; i < sky.dome.count; i++)
		memcpy(radiance[i], one[0], sizeof(one[0]));
	mirror_map_fill(&sky.map, (const double(*)[3])radiance, none);
	for (int k = 0; k < 1000; k++) {
		const struct basis_mirror m = {
			.u = (uint16_t)chance_int(&chance, 0, 65535),
			.v = (uint16_t)chance_int(&chance, 0, 65535),
			.throughput = {65535, 65535, 65535},
			.level = (uint16_t)chance_int(&chance, 0, LEVEL_MOST)};
		const mirror_light light = looked_up(&sky.map, &m);

		for (int c = 0; c < 3; c++)
			assert_true(fabs((double)light[c] / 65535 / MIRROR_LOOK_ONE / one[0][c] -
					 1) < 1e-6);
	}
	free(radiance);
	sky_close(&sky);
}

/* Bilinear in double precision; beyond the edge, the nearest texel. */
static double bilinear(const struct mirror_map *map, int level, double u, double v, int c)
{
	const int side = BASIS_MIRROR_SIDE >> level;
	const double x = u * side - 0.5, y = v * side - 0.5;
	double sum = 0;

	for (int k = 0; k < 4; k++) {
		const int i = (int)fmin(fmax(floor(x) + k % 2, 0), side - 1);
		const int j = (int)fmin(fmax(floor(y) + k / 2, 0), side - 1);

		sum += (k % 2 ? x - floor(x) : 1 - x + floor(x)) *
		       (k / 2 ? y - floor(y) : 1 - y + floor(y)) *
		       (double)mirror_texels(map, level)[j * MIRROR_STRIDE + i][c];
	}
	return sum;
}

TEST("looks up as in double precision")
{
	struct chance chance = chance_begin("look-ups");
	double most = 0;
	struct sky sky;

	sky_open(&sky);
	for (int at = 0; at < BASIS_MIRROR_SIDE * MIRROR_STRIDE; at++)
		for (int c = 0; c < 3; c++)
			sky.map.texel[at][c] = (float)chance_real(&chance, 0, 1);
	mirror_map_finish(&sky.map);
	for (int k = 0; k < 20000; k++) {
		const int level = (int)chance_int(&chance, 0, LEVEL_MOST), whole = level / 256;
		const double u = (double)chance_int(&chance, 0, 65535) / 65536;
		const double v = (double)chance_int(&chance, 0, 65535) / 65536;
		const double next = level % 256 / 256.0;
		double want = (1 - next) * bilinear(&sky.map, whole, u, v, k % 3);

		if (next > 0)
			want += next * bilinear(&sky.map, whole + 1, u, v, k % 3);
		most = fmax(most, fabs(looked(&sky.map, u, v, level, k % 3) - want));
	}
	print_message("# look-ups: off by %.2g at most\n", most);
	assert_true(most < 8 * 0.5 / MIRROR_LOOK_ONE); /* eight weights are rounded */
	sky_close(&sky);
}

/* A map that is limited to what a pose looks up shows it as a whole one does. */
TEST("fills all that is looked up, and little else")
{
	enum { LOOKS = 20, TRIALS = 30 };
	struct chance chance = chance_begin("limits");
	static struct basis_mirror mirror[LOOKS];
	const int number = 0;
	struct basis_pose pose = {.mirror = mirror, .mirror_count = LOOKS};
	struct sky sky, whole;

	sky_open(&sky);
	sky_open(&whole);
	sky.basis.poses = &pose;
	for (int trial = 0; trial < TRIALS; trial++) {
		const int least = trial % 3, most = trial < TRIALS / 2 ? LEVEL_MOST : 256 * least;
		int filled = 0;

		for (int k = 0; k < LOOKS; k++) {
			mirror[k] = (struct basis_mirror){
				.u = (uint16_t)chance_int(&chance, 0, 65535),
				.v = (uint16_t)chance_int(&chance, 0, 65535),
				.throughput = {65535, 65535, 65535},
				.level = (uint16_t)chance_int(&chance, 0, most)};
		}
		mirror_map_limit(&sky.map, least, &sky.basis, &number, 1);
		sky.map.least = whole.map.least = least;
		for (int y = 0; y < BASIS_MIRROR_SIDE >> least; y++)
			for (int x = 0; x < BASIS_MIRROR_SIDE >> least; x++) {
				const struct mirror_span span = mirror_spans(&sky.map, least)[y];
				const size_t at = (size_t)(y * MIRROR_STRIDE + x);
				const bool shown = x >= span.first && x < span.end;

				mirror_texels(&whole.map, least)[at] += (float)chance_real(&chance,
											   0, 1);
				if (shown)
					mirror_texels(&sky.map, least)[at] =
						mirror_texels(&whole.map, least)[at];
				filled += shown;
			}
		mirror_map_finish(&whole.map);
		mirror_map_finish(&sky.map);
		for (int k = 0; k < LOOKS; k++) {
			const mirror_light a = looked_up(&whole.map, &mirror[k]);
			const mirror_light b = looked_up(&sky.map, &mirror[k]);

			assert_true(a[0] == b[0] && a[1] == b[1] && a[2] == b[2]);
		}
		/* Sharp mirrors have few rows, and look-ups of a row are far from each other. */
		if (trial >= TRIALS / 2)
			assert_true(filled <= 2 * LOOKS * (BASIS_MIRROR_SIDE >> least) / 4);
	}
	pose.mirror_count = 0;
	mirror_map_limit(&sky.map, 1, &sky.basis, &number, 1);
	for (int row = 0; row < 2 * BASIS_MIRROR_SIDE; row++)
		assert_int_equal(sky.map.span[row].end, 0);
	sky_close(&whole);
	sky_close(&sky);
}

TEST("the brightest light fits")
{
	struct sky sky;

	sky_open(&sky);
	for (int at = 0; at < BASIS_MIRROR_SIDE * MIRROR_STRIDE; at++)
		sky.map.texel[at] = MIRROR_MOST + (mirror_light){0, 0, 0, 0};
	mirror_map_finish(&sky.map);
	for (int level = 0; level <= LEVEL_MOST; level += 128)
		assert_true(fabs(looked(&sky.map, 0.3, 0.7, level, 1) / (double)MIRROR_MOST - 1) <
			    1e-6);
	sky_close(&sky);
}

/* The mean of what is looked up over all directions is that of the sky, at every level. */
TEST("no level gains or loses light")
{
	struct sky sky;
	double all = 0, whole = 0;

	sky_open(&sky);
	for (int at = 0; at < MIRROR_TEXELS; at++) {
		/* patches of some degrees, a few of them a hundred times as bright */
		struct chance patch = {
			(uint64_t)(at / BASIS_MIRROR_SIDE / 16 * 32 + at % BASIS_MIRROR_SIDE / 16)};
		const double light = chance_real(&patch, 0, 1) *
				     (chance_int(&patch, 0, 63) ? 1 : 100);

		sky.map.texel[at / BASIS_MIRROR_SIDE * MIRROR_STRIDE + at % BASIS_MIRROR_SIDE][0] =
			(float)light;
		all += sky.map.texel_sr[at] * light;
		whole += sky.map.texel_sr[at];
	}
	expect_below(fabs(whole / (2 * M_PI) - 1), 1e-3, "solid angle");
	mirror_map_finish(&sky.map);
	for (int level = 0; level <= 4; level++) {
		double sum = 0;

		for (int at = 0; at < MIRROR_TEXELS; at++)
			sum += sky.map.texel_sr[at] *
			       looked(&sky.map, (at % BASIS_MIRROR_SIDE + 0.5) / BASIS_MIRROR_SIDE,
				      (at / BASIS_MIRROR_SIDE + 0.5) / BASIS_MIRROR_SIDE,
				      256 * level, 0);
		print_message("# level %d: %+.5f\n", level, sum / all - 1);
		expect_below(fabs(sum / all - 1), 0.005 * (1 + level), "level %d", level);
	}
	sky_close(&sky);
}

/* ---- the fisheye's picture ---- */

/* The texel of the first level filled that covers one of level 0. */
static double green_at(const struct mirror_map *map, int at)
{
	const int x = at % BASIS_MIRROR_SIDE >> map->least,
		  y = at / BASIS_MIRROR_SIDE >> map->least;

	return (double)mirror_texels(map, map->least)[y * MIRROR_STRIDE + x][1];
}

#define SIDE 320

/* An 8-bit picture of a lens that is tilted, off its middle and squashed: light that rises towards
 * +X, and a lamp of ten degrees at a direction. Black where there is no sky. */
static void draw_sky(const struct fisheye *lens, const double lamp[3], uint8_t *picture)
{
	for (int at = 0; at < SIDE * SIDE; at++) {
		const double px[2] = {at % SIDE + 0.5, at / SIDE + 0.5};
		double d[3];
		const bool sky = fisheye_ray(lens, px, d) && d[2] >= 0;
		const bool lit = sky && d[0] * lamp[0] + d[1] * lamp[1] + d[2] * lamp[2] >
						cos(5 * M_PI / 180);

		for (int c = 0; c < 3; c++)
			picture[4 * at + c] = !sky ? 0 : lit ? 255 : (uint8_t)(100 + 40 * d[0]);
	}
}

static struct fisheye tilted_lens(void)
{
	const struct fisheye_settings settings = {
		.focal_px = {95, 88},
		.centre_px = {165, 157},
		.rotation_deg = {4, -7, 65},
		.field_deg = 100,
		.falloff = {-0.1, 0, 0},
	};
	struct fault fault = {""};
	struct fisheye lens;

	assert_int_equal(fisheye_prepare(&lens, &settings, SIDE, SIDE, &fault), 0);
	return lens;
}

TEST("shows the picture where it is, and all of its light")
{
	static const double lamp[3] = {0.6, -0.48, 0.64};
	const struct light_sampler_settings settings = {.curve = {.named = TRANSFER_SRGB},
							.gain = 0.7};
	const struct fisheye lens = tilted_lens();
	uint8_t *picture = malloc((size_t)SIDE * SIDE * 4);
	struct mirror_colours light = {.matrix = {0.7, 0, 0, 0, 0.7, 0, 0, 0, 0.7}};
	struct light_sampler *sampler;
	struct fault fault = {""};
	struct frame_reader reader;
	struct mirror_eye eye = {.width = 0};
	struct picture view = {picture, 4, 4 * SIDE, SIDE, SIDE};
	float(*radiance)[3];
	double(*more)[3];
	double cells = 0, map = 0, middle[3] = {0, 0, 0}, place[2], length;
	struct sky sky;

	sky_open(&sky);
	radiance = calloc((size_t)sky.dome.count, sizeof(*radiance));
	more = calloc((size_t)sky.dome.count, sizeof(*more));
	assert_true(picture && radiance && more);
	draw_sky(&lens, lamp, picture);
	reader = frame_reader_of(&view);
	assert_int_equal(
		light_sampler_create(&sampler, &sky.dome, &lens, SIDE, SIDE, &settings, &fault), 0);
	assert_int_equal(light_sampler_read(sampler, &view, radiance, NULL), 0);
	for (int code = 0; code < 256; code++)
		light.decode[code] = transfer_decode(TRANSFER_SRGB, code / 255.0);
	assert_int_equal(mirror_eye_prepare(&eye, &lens, SIDE, SIDE), 0);
	assert_int_equal(mirror_eye_take(&eye, &reader, 0), 0);
	light.clipped = (const double(*)[3])more;
	mirror_eye_fill(&eye, &light, NULL, &sky.map);
	for (int i = 0; i < sky.dome.count; i++)
		cells += sky.dome.solid_angle_sr[i] * (double)radiance[i][1];
	for (int at = 0; at < MIRROR_TEXELS; at++) {
		const double texel = green_at(&sky.map, at);
		double d[3];

		place[0] = (at % BASIS_MIRROR_SIDE + 0.5) / BASIS_MIRROR_SIDE;
		place[1] = (at / BASIS_MIRROR_SIDE + 0.5) / BASIS_MIRROR_SIDE;
		sky_square_direction(place, d);
		map += sky.map.texel_sr[at] * texel;
		assert_true(texel > 0.02); /* no texel is black, at the horizon neither */
		for (int k = 0; k < 3 && texel > 0.6; k++)
			middle[k] += d[k] * sky.map.texel_sr[at];
	}
	print_message("# light of the picture: %.4f in cells, %.4f in mirrors\n", cells, map);
	expect_below(fabs(map / cells - 1), 0.005, "all light");
	length = sqrt(middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]);
	for (int k = 0; k < 3; k++)
		expect_below(fabs(middle[k] / length - lamp[k]), 0.01, "direction %d", k);
	/* What clips may get more, and nothing else does. */
	{
		double after = 0, gained = 0;

		for (int i = 0; i < sky.dome.count; i++)
			more[i][1] = 9;
		mirror_eye_fill(&eye, &light, NULL, &sky.map);
		for (int at = 0; at < MIRROR_TEXELS; at++)
			after += sky.map.texel_sr[at] * green_at(&sky.map, at);
		gained = (after - map) / 9 / (2 * M_PI * (1 - cos(5 * M_PI / 180)));
		expect_below(fabs(gained - 1), 0.03, "clipped solid angle");
	}
	free(more);
	light_sampler_destroy(sampler);
	mirror_eye_free(&eye);
	free(radiance);
	free(picture);
	sky_close(&sky);
}
