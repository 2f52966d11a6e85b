/* SPDX-License-Identifier: MIT */
/* The view that helps to set up: lines lie where the calibration says, and a torch is found where
 * it is held. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/view/show.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 320, HEIGHT = 240 };

static const struct guide_lamps no_lamps;

static struct tsai_camera camera_at(double x, double y, double z)
{
	const double eye[3] = {x, y, z}, target[3] = {0};
	struct tsai_camera camera;

	assert_int_equal(tsai_look_at(&camera, WIDTH, HEIGHT, eye, target, 45, NULL), 0);
	return camera;
}

/* Lines are 1, 2 or 5 times a power of ten apart, and six to sixteen cross the picture's middle
 * row. */
TEST("spacing follows the scene")
{
	for (double scale = 0.01; scale < 2000; scale *= 1.37) {
		struct tsai_camera camera = camera_at(scale, -1.3 * scale, 0.8 * scale);
		const double spacing = guide_spacing(&camera);
		const double lead = spacing / pow(10, floor(log10(spacing) + 1e-9));
		const double distance = scale * sqrt(1 + 1.69 + 0.64);
		const double across = 2 * distance * tan(22.5 * M_PI / 180);

		expect_that(fabs(lead - 1) < 1e-6 || fabs(lead - 2) < 1e-6 || fabs(lead - 5) < 1e-6,
			    "spacing %g at scale %g", spacing, scale);
		expect_that(across / spacing >= 5 && across / spacing <= 16, "%g lines at scale %g",
			    across / spacing, scale);
	}
}

TEST("a camera is read from a basis")
{
	static const char text[] =
		"[camera]\nwidth = 640\nheight = 480\nrotation = 1 0 0 0 1 0 0 0 1\n"
		"translation = 0 0 5\nfocal = 4\ncentre = 320 240\npixel = 0.01 0.01\n";
	struct tsai_camera camera;

	assert_int_equal(tsai_read_text(text, &camera, NULL), 0);
	assert_int_equal(camera.width, 640);
	assert_int_equal(tsai_read_text("", &camera, NULL), -EINVAL);
	assert_int_equal(tsai_read_text("[camera]\nwidth = many\n", &camera, NULL), -EINVAL);
}

#if WITH_CAIRO
static const uint8_t *pixel_at(const struct canvas *canvas, const double px[2])
{
	return canvas->pixels + (size_t)px[1] * canvas->stride + 4 * (size_t)px[0];
}

TEST("axes lie where the camera sees them")
{
	const struct tsai_camera camera = camera_at(2, 2.5, 1.5);
	const double length = 2 * guide_spacing(&camera);
	static uint16_t coverage[HEIGHT * WIDTH];
	int outlined = 0, within = 0;
	struct canvas canvas;

	assert_int_equal(canvas_create(&canvas, WIDTH, HEIGHT), 0);
	for (int y = 200; y < 210; y++)
		for (int x = 20; x < 40; x++)
			coverage[y * WIDTH + x] = 65535;
	guide_draw_ground(&canvas, &camera, coverage, &no_lamps, 8);
	for (int c = 0; c < 3; c++) {
		double world[3] = {0}, px[2];
		const uint8_t *bgr;

		world[c] = 0.7 * length;
		assert_int_equal(tsai_project(&camera, world, px), 0);
		bgr = pixel_at(&canvas, px);
		for (int other = 0; other < 3; other++)
			if (other != c)
				expect_above(bgr[2 - c], bgr[2 - other], "axis %d", c);
	}
	for (int x = 20; x < 40; x++) { /* lines of the grid may cross it */
		outlined += canvas.pixels[200 * canvas.stride + 4 * (size_t)x + 2] == 255;
		within += canvas.pixels[205 * canvas.stride + 4 * (size_t)x + 2] == 255;
	}
	expect_above(outlined, 10, "pixels of the outline's upper edge");
	expect_at_most(within, 2, "pixels of its sides in a row");
	canvas_free(&canvas);
}

/* Whether a pixel within 2 of px has the lamps' colour: more green than red and blue, but both. */
static bool is_lamp_at(const struct canvas *canvas, const double px[2])
{
	for (int dy = -2; dy <= 2; dy++)
		for (int dx = -2; dx <= 2; dx++) {
			const double at[2] = {px[0] + dx, px[1] + dy};
			const uint8_t *bgr = pixel_at(canvas, at);

			if (bgr[1] > 200 && bgr[0] > 150 && bgr[2] < 140)
				return true;
		}
	return false;
}

TEST("lamps are drawn where they are said to be")
{
	static const struct lamps lamps = {
		2, {{{0.4, 0.3, 1}, 0.3}, {{-0.4, 0.3, 0.9}, 0.3}}, {0, 0, 0.1}};
	static const char name[2][CONFIG_NAME_MAX] = {"desk", "door"};
	static const bool missing[LAMPS_MAX] = {true};
	static const struct fisheye_settings settings = {.field_deg = 90};
	const struct guide_lamps shown = {&lamps, name, missing};
	const struct tsai_camera camera = camera_at(2, 2.5, 1.5);
	struct canvas canvas, sky;
	struct fisheye lens;
	struct dome dome;

	assert_int_equal(canvas_create(&canvas, WIDTH, HEIGHT), 0);
	assert_int_equal(canvas_create(&sky, HEIGHT, HEIGHT), 0);
	assert_int_equal(fisheye_prepare(&lens, &settings, HEIGHT, HEIGHT, NULL), 0);
	assert_int_equal(dome_create(&dome, 1, NULL), 0);
	guide_draw_ground(&canvas, &camera, NULL, &shown, 8);
	guide_draw_sky(&sky, &lens, &dome, NULL, &shown, 8);
	for (int l = 0; l < 2; l++) {
		const double *at = lamps.lamp[l].position;
		const double half[3] = {at[0], at[1], at[2] / 2}, foot[3] = {at[0], at[1], 0};
		/* the disc's edge, at right angles to the direction */
		const double d[3] = {at[0], at[1], at[2] - 0.1};
		const double distance = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
		const double tangent = 0.3 / sqrt(distance * distance - 0.09);
		const double level = hypot(d[0], d[1]);
		const double edge[3] = {d[0] - d[1] / level * tangent * distance,
					d[1] + d[0] / level * tangent * distance, d[2]};
		double px[2];

		assert_int_equal(tsai_project(&camera, half, px), 0);
		expect_that(is_lamp_at(&canvas, px), "the line of lamp %d", l);
		assert_int_equal(tsai_project(&camera, foot, px), 0);
		px[0] += 2;
		expect_that(is_lamp_at(&canvas, px), "the foot of lamp %d", l);
		assert_true(fisheye_project(&lens, edge, px));
		expect_that(is_lamp_at(&sky, px), "the ring of lamp %d", l);
	}
	canvas_free(&canvas);
	canvas_free(&sky);
	dome_free(&dome);
}
#endif

TEST("a torch is found where it is held")
{
	static float radiance[DOME_LIGHTS_MAX][3];
	struct guide_light found[GUIDE_LIGHTS];
	struct dome dome;

	assert_int_equal(dome_create(&dome, 9, NULL), 0);
	for (int i = 0; i < dome.count; i++)
		radiance[i][0] = radiance[i][1] = radiance[i][2] = 1;
	assert_int_equal(guide_find_lights(&dome, (const float(*)[3])radiance, found), 0);
	for (int azimuth = 0; azimuth < 360; azimuth += 90) {
		const double dir[3] = {cos(azimuth * M_PI / 180) * cos(0.5),
				       sin(azimuth * M_PI / 180) * cos(0.5), sin(0.5)};
		int torch = dome_cell_of(&dome, dir);
		double off;

		radiance[torch][1] = 50;
		assert_int_equal(guide_find_lights(&dome, (const float(*)[3])radiance, found), 1);
		assert_int_equal(found[0].light, torch);
		off = fabs(found[0].azimuth_deg - azimuth);
		expect_at_most(off > 180 ? 360 - off : off, 6, "azimuth %d", azimuth);
		expect_at_most(fabs(found[0].height_deg - 0.5 * 180 / M_PI), 6, "azimuth %d",
			       azimuth);
		radiance[torch][1] = 1;
	}
	dome_free(&dome);
}
