/* SPDX-License-Identifier: MIT */
/* The purpose of all calibration: an object of the material of the ground, flat on it and
 * composited with two calibrated cameras, cannot be told from the ground. */
#include <math.h>

#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline.h"
#include "bake/calibrate/response/light_gain.h"
#include "bake/calibrate/response/light_response.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/calibrate/patch_chart.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define EYE 240 /* side of the fisheye picture, px */
#define EXPOSURES 5
#define ALBEDO 0.5

static const struct chart_camera fisheye = {CHART_FILM, 12, 0.0005, 0.008};
static const struct chart_camera background = {CHART_BT709, 16, 0.0005, 0.008};

/* Radiance of the sky, in true units: bright towards one side, another colour towards the other. */
static void sky_at(const double dir[3], double light[3])
{
	light[0] = 0.4 + 0.35 * dir[0];
	light[1] = 0.4 + 0.2 * dir[0] * dir[1] + 0.1 * dir[2];
	light[2] = 0.5 - 0.3 * dir[1];
}

/* Calibrates the response of a camera from five exposures of patches. */
static struct transfer_curve calibrate(const struct chart_camera *camera, struct chance *chance)
{
	struct light_response_settings settings = {.time_deviation = 0};
	struct image picture[EXPOSURES];
	const struct image *pictures[EXPOSURES];
	struct light_samples samples;
	struct light_response found;
	struct transfer_curve curve;

	for (int j = 0; j < EXPOSURES; j++) {
		settings.time[j] = 4.0 / (1 << j);
		assert_int_equal(image_create_u8(&picture[j], 320, 240), 0);
		chart_photograph(camera, settings.time[j], 2e-3, chance, &picture[j]);
		pictures[j] = &picture[j];
	}
	assert_int_equal(light_samples_create(&samples, pictures, EXPOSURES, camera->black, NULL),
			 0);
	assert_int_equal(light_response_find(&found, &samples, &settings, NULL), 0);
	if (!found.verdict.trusted)
		fail_msg("%s", found.verdict.reason);
	curve = found.curve;
	for (int j = 0; j < EXPOSURES; j++)
		image_free(&picture[j]);
	light_samples_free(&samples);
	light_response_free(&found);
	return curve;
}

static struct canvas canvas_of(int width, int height)
{
	struct canvas canvas;

	assert_int_equal(canvas_create(&canvas, width, height), 0);
	return canvas;
}

static void set_pixel(struct canvas *canvas, int x, int y, const struct chart_camera *camera,
		      const double linear[3], struct chance *chance)
{
	uint8_t *to = canvas->pixels + (size_t)y * canvas->stride + 4 * (size_t)x;

	for (int c = 0; c < 3; c++)
		to[2 - c] = chart_code(camera, linear[c], chance);
	to[3] = 255;
}

static struct canvas photograph_sky(const struct fisheye *lens, double exposure,
				    struct chance *chance)
{
	struct canvas canvas = canvas_of(EYE, EYE);

	for (int y = 0; y < EYE; y++)
		for (int x = 0; x < EYE; x++) {
			const double px[2] = {x + 0.5, y + 0.5};
			double dir[3], light[3] = {0};

			if (fisheye_ray(lens, px, dir))
				sky_at(dir, light);
			for (int c = 0; c < 3; c++)
				light[c] *= exposure;
			set_pixel(&canvas, x, y, &fisheye, light, chance);
		}
	return canvas;
}

/* Radiance of the ground: reflectance / pi * integral of L cos(theta), over 256 x 1024 directions.
 */
static void ground_light(double exposure, double light[3])
{
	memset(light, 0, 3 * sizeof(*light));
	for (int k = 0; k < 256 * 1024; k++) {
		/* uniform in projected solid angle */
		const double r = sqrt((k / 1024 + 0.5) / 256);
		const double phi = 2 * M_PI * (k % 1024 + 0.5) / 1024;
		const double dir[3] = {r * cos(phi), r * sin(phi), sqrt(1 - r * r)};
		double there[3];

		sky_at(dir, there);
		for (int c = 0; c < 3; c++)
			light[c] += exposure * ALBEDO * there[c] / (256 * 1024);
	}
}

static struct canvas photograph_ground(const double light[3], int width, int height,
				       struct chance *chance)
{
	struct canvas canvas = canvas_of(width, height);

	for (int k = 0; k < width * height; k++)
		set_pixel(&canvas, k % width, k / width, &background, light, chance);
	return canvas;
}

static struct image image_of(const struct canvas *canvas)
{
	struct image image;

	assert_int_equal(image_create_u8(&image, canvas->width, canvas->height), 0);
	for (int k = 0; k < canvas->width * canvas->height; k++) {
		const uint8_t *from = canvas->pixels +
				      (size_t)(k / canvas->width) * canvas->stride +
				      4 * (size_t)(k % canvas->width);

		for (int c = 0; c < 3; c++)
			image.u8[3 * k + c] = from[2 - c];
	}
	return image;
}

static struct picture whole(const struct canvas *canvas)
{
	const struct view view = {.width = canvas->width, .height = canvas->height};

	return view_picture(&view, canvas->pixels, canvas->stride);
}

struct slab {
	struct basis basis;
	struct pipeline *pipeline;
};

static void open_pipeline(struct slab *s, const struct transfer_curve curves[2], double gain)
{
	struct pipeline_settings settings = {
		.sampler = {.placed = true, .curve = curves[0], .gain = gain},
		.lens = {.field_deg = 90},
		.threshold_mode = THRESHOLD_AMBIENT,
		.background = curves[1],
		.gain = 1,
		.threads = 1,
	};
	struct fault fault = {""};

	if (pipeline_create(&s->pipeline, &s->basis, &settings, &fault) < 0)
		fail_msg("%s", fault.text);
}

/* What the kiosk shows: mean code values of the object and of the ground around it. */
static void composite(struct slab *s, const struct canvas *sky, const struct canvas *ground,
		      double object[3], double around[3])
{
	const struct pipeline_choice choice = {.object = true};
	const struct picture eye = whole(sky), behind = whole(ground);
	const struct backdrop backdrop = backdrop_of(&behind);
	struct canvas out = canvas_of(ground->width, ground->height);
	int count[2] = {0};

	assert_int_equal(pipeline_light_picture(s->pipeline, &eye, NULL), 0);
	assert_int_equal(pipeline_choose(s->pipeline, &choice, NULL), 0);
	assert_int_equal(pipeline_composite(s->pipeline, &backdrop, out.pixels, out.stride, NULL),
			 0);
	memset(object, 0, 3 * sizeof(*object));
	memset(around, 0, 3 * sizeof(*around));
	for (int k = 0; k < out.width * out.height; k++) {
		const uint8_t *from = out.pixels + (size_t)(k / out.width) * out.stride +
				      4 * (size_t)(k % out.width);
		const int coverage = s->basis.poses[0].coverage[k];

		if (coverage && coverage < 65535)
			continue;
		for (int c = 0; c < 3; c++)
			(coverage ? object : around)[c] += from[2 - c];
		count[!coverage]++;
	}
	assert_true(count[0] > 200 && count[1] > 200);
	for (int c = 0; c < 3; c++) {
		object[c] /= count[0];
		around[c] /= count[1];
	}
	canvas_free(&out);
}

static void bake_slab(struct slab *s)
{
	small_scene_write("slab.obj", "v -0.5 -0.4 0.0005\nv 0.5 -0.4 0.0005\nv 0.5 0.4 0.0005\n"
				      "v -0.5 0.4 0.0005\nf 1 2 3\nf 1 3 4\n");
	small_scene_write("slab.ini",
			  "[camera]\nposition = 0 -4 4\nlook_at = 0 0 0\nfield_deg = 20\n"
			  "width = 64\nheight = 48\n[dome]\nfrequency = 9\n[render]\n"
			  "samples = 400\n[ground]\nmaterial = m\n[object slab]\n"
			  "file = slab.obj\nup = z\nmaterial = m\n[material m]\n"
			  "colour = 0.5 0.5 0.5\n");
	s->basis = small_scene_bake("slab.ini");
}

static double find_gain(const struct transfer_curve curves[2], const struct fisheye *lens,
			struct chance *chance)
{
	static const double reflectance[3] = {ALBEDO, ALBEDO, ALBEDO};
	const struct light_sampler_settings settings = {.curve = curves[0], .gain = 1};
	struct light_sampler *sampler;
	struct light_pair pairs[3];
	struct light_gain found;
	struct light_area area;
	struct dome dome;

	assert_int_equal(dome_create(&dome, 24, NULL), 0);
	assert_int_equal(light_sampler_create(&sampler, &dome, lens, EYE, EYE, &settings, NULL), 0);
	light_area_parse(&area, "4,4,40,20", NULL);
	for (int k = 0; k < 3; k++) {
		struct canvas sky = photograph_sky(lens, 1.1, chance), ground;
		const struct picture picture = whole(&sky);
		float(*radiance)[3] = calloc((size_t)dome.count, sizeof(*radiance));
		struct image image;
		double light[3];

		assert_non_null(radiance);
		ground_light(2.4, light);
		ground = photograph_ground(light, 64, 48, chance);
		image = image_of(&ground);
		assert_int_equal(
			light_sampler_read(sampler, &picture, radiance, &pairs[k].clipped_sky), 0);
		light_gain_predict(&dome, (const float(*)[3])radiance, reflectance,
				   pairs[k].predicted);
		assert_int_equal(
			light_patch_measure(&pairs[k].patch, &image, &area, &curves[1], NULL), 0);
		free(radiance);
		image_free(&image);
		canvas_free(&sky);
		canvas_free(&ground);
	}
	assert_int_equal(light_gain_find(&found, pairs, 3, NULL), 0);
	if (!found.verdict.trusted)
		fail_msg("%s", found.verdict.reason);
	print_message("# gain %.4f, deviation %.4f; true %.4f\n", found.gain, found.deviation,
		      2.4 / 1.1);
	assert_true(fabs(found.gain - 2.4 / 1.1) < 0.01 * found.gain);
	light_sampler_destroy(sampler);
	dome_free(&dome);
	return found.gain;
}

TEST("the slab is the ground")
{
	const struct fisheye_settings settings = {.field_deg = 90};
	struct chance chance = chance_begin("light");
	struct transfer_curve curves[2];
	struct fisheye lens;
	struct slab s;

	assert_int_equal(fisheye_prepare(&lens, &settings, EYE, EYE, NULL), 0);
	curves[0] = calibrate(&fisheye, &chance);
	curves[1] = calibrate(&background, &chance);
	bake_slab(&s);
	open_pipeline(&s, curves, find_gain(curves, &lens, &chance));
	/* In light two stops away from the light of the calibration. */
	for (int k = 0; k < 4; k++) {
		const double day = 1.2 * pow(0.6, k);
		struct canvas sky = photograph_sky(&lens, 1.1 * day, &chance), ground;
		double light[3], object[3], around[3];

		ground_light(2.4 * day, light);
		ground = photograph_ground(light, 64, 48, &chance);
		composite(&s, &sky, &ground, object, around);
		for (int c = 0; c < 3; c++) {
			print_message("# light %.2f, channel %d: object %.2f, ground %.2f\n", day,
				      c, object[c], around[c]);
			expect_at_most(fabs(object[c] - around[c]), 1, "k=%d, c=%d", k, c);
		}
		canvas_free(&sky);
		canvas_free(&ground);
	}
	pipeline_destroy(s.pipeline);
	basis_close(&s.basis);
}

TEST_GROUP(small_scene_begin, small_scene_end);
