/* SPDX-License-Identifier: MIT */
/* The image circle of a fisheye in one picture: right to a part of a pixel, and doubted where the
 * circle cannot be seen. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/circle/fisheye_circle.h"
#include "drivers/sim/sim.h"
#include "hal/colour/transfer.h"
#include "hal/optics/panorama.h"
#include "tests/support/calibrate/fisheye_views.h"
#include "tests/support/chance.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

/* A scene through a lens, as an 8-bit camera takes it. */
struct circle_scene {
	struct fisheye_settings lens;
	double exposure, noise; /* levels */
	double blur_px;		/* standard deviation of the blur of lens and focus */
	/* The scene is dark between these angles around the axis. */
	double dark_from_deg, dark_to_deg;
	bool lamp; /* a bright lamp that the rim cuts */
	bool open; /* no dark surroundings */
	bool studio;
	const struct panorama *panorama;
};

/* Radiance of the rooms of the simulated cameras. */
static double light_of_room(const struct circle_scene *scene, const double dir[3])
{
	static const double origin[3] = {0, 0, 0.01};
	const struct studio_lamps lamps = studio_lamps(0, 0);
	double rgb[3];

	if (scene->studio)
		studio_radiance(origin, dir, &lamps, rgb);
	else
		panorama_radiance(scene->panorama, dir, rgb);
	return scene->exposure * (rgb[0] + rgb[1] + rgb[2]) / 3;
}

static double light_of(const struct circle_scene *scene, const struct fisheye *lens,
		       const double px[2])
{
	double dir[3], phi, light;

	if (!fisheye_ray(lens, px, dir))
		return scene->open ? 0.3 : 0.002;
	if (scene->studio || scene->panorama)
		return light_of_room(scene, dir);
	phi = atan2(px[1] - lens->centre_px[1], px[0] - lens->centre_px[0]) * (180 / M_PI) + 180;
	light = 0.3 + 0.15 * dir[2] + 0.05 * sin(4 * dir[0]) * cos(5 * dir[1]);
	if (phi > scene->dark_from_deg && phi < scene->dark_to_deg)
		light = 0.002;
	if (scene->lamp && phi > 20 && phi < 26 && dir[2] < 0.2)
		light = 30;
	return scene->exposure * light;
}

/* Blurs by a Gaussian, first along rows, then along columns. */
static void soften(double light[480][640], double deviation_px)
{
	enum { FAR = 8 };
	static double before[480][640];

	for (int axis = 0; axis < 2; axis++) {
		memcpy(before, light, sizeof(before));
		for (int y = 0; y < 480; y++)
			for (int x = 0; x < 640; x++) {
				double sum = 0, all = 0;

				for (int k = -FAR; k <= FAR; k++) {
					const int across = axis ? x : x + k,
						  down = axis ? y + k : y;
					const double far = k / deviation_px;
					const double by = exp(-far * far / 2);

					if (across < 0 || across >= 640 || down < 0 || down >= 480)
						continue;
					sum += by * before[down][across];
					all += by;
				}
				light[y][x] = sum / all;
			}
	}
}

static struct image circle_take(const struct circle_scene *scene, struct fisheye *lens,
				struct chance *chance)
{
	enum { PARTS = 4 };
	static double light[480][640];
	struct image image;

	assert_int_equal(fisheye_prepare(lens, &scene->lens, 640, 480, NULL), 0);
	assert_int_equal(image_create_u8(&image, 640, 480), 0);
	for (int p = 0; p < 640 * 480; p++) {
		double sum = 0;

		for (int k = 0; k < PARTS * PARTS; k++)
			sum += light_of(scene, lens,
					(double[]){p % 640 + (k % PARTS + 0.5) / PARTS,
						   p / 640 + (k / PARTS + 0.5) / PARTS});
		light[p / 640][p % 640] = sum / (PARTS * PARTS);
	}
	if (scene->blur_px > 0)
		soften(light, scene->blur_px);
	for (int p = 0; p < 640 * 480; p++) {
		const double is = fmin(light[p / 640][p % 640], 1);
		const double code = 255 * transfer_encode(TRANSFER_SRGB, is) +
				    scene->noise * chance_normal(chance);

		for (int c = 0; c < 3; c++)
			image.u8[3 * p + c] = (uint8_t)fmin(fmax(rint(code), 0), 255);
	}
	return image;
}

/* Largest distance of two lenses' images, over the whole image circle in the picture. */
static double error_of(const struct fisheye *truth, const struct fisheye_settings *found)
{
	struct fisheye lens;
	double worst = 0;

	assert_int_equal(fisheye_prepare(&lens, found, 640, 480, NULL), 0);
	for (int y = 0; y < 480; y += 8)
		for (int x = 0; x < 640; x += 8) {
			const double px[2] = {x + 0.5, y + 0.5};
			double dir[3], there[2];

			lens.field_rad = M_PI;
			if (fisheye_ray(truth, px, dir) && fisheye_project(&lens, dir, there))
				worst = fmax(worst, hypot(there[0] - px[0], there[1] - px[1]));
		}
	return worst;
}

/* Expects this verdict ("": trusted) and, where it trusts, the right lens. */
static void circle_check(const char *name, const struct circle_scene *scene, const char *expected,
			 double error_px)
{
	struct chance chance = chance_begin(name);
	const struct fisheye_wanted wanted = {.model = scene->lens.model,
					      .field_deg = scene->lens.field_deg,
					      .tolerance_px = 0.5,
					      .world_view = -1};
	struct fisheye_result result;
	struct observations seen;
	struct fisheye truth;
	struct image image = circle_take(scene, &truth, &chance);
	char said[600];

	assert_int_equal(
		fisheye_circle(&result, &seen, &image, name, scene->lens.field_deg, &wanted, NULL),
		0);
	verdict_sentence(&result.finding.verdict, said, sizeof(said));
	print_message("# %s: %s; rms %.3f px, lens off by %.3f px\n", name, said,
		      result.finding.rms_px,
		      result.finding.estimate.count ? error_of(&truth, &result.lens) : NAN);
	if (*expected)
		assert_non_null(strstr(said, expected));
	else
		assert_true(result.finding.verdict.trusted);
	if (!*expected)
		assert_true(error_of(&truth, &result.lens) < error_px);
	fisheye_result_free(&result);
	observations_free(&seen);
	image_free(&image);
}

static const struct fisheye_settings whole = {
	.focal_px = {140, 134}, .centre_px = {322.3, 238.6}, .field_deg = 90};

TEST("every model")
{
	for (int model = 0; model < FISHEYE_POLYNOMIAL;
	     model += thorough() ? 1 : FISHEYE_STEREOGRAPHIC) {
		struct circle_scene scene = {.lens = whole, .exposure = 1, .noise = 1};

		scene.lens.model = model;
		if (model == FISHEYE_STEREOGRAPHIC)
			scene.lens.focal_px[0] = scene.lens.focal_px[1] = 110;
		if (model == FISHEYE_ORTHOGRAPHIC)
			scene.lens.focal_px[0] = scene.lens.focal_px[1] = 215;
		circle_check(fisheye_model_names[model], &scene, "", 0.2);
	}
}

TEST("hard pictures")
{
	struct circle_scene scene = {.lens = whole, .exposure = 1, .noise = 1};

	scene.lamp = true;
	circle_check("lamp at the rim", &scene, "", 0.2);
	scene.lamp = false;
	scene.noise = 6;
	circle_check("noise", &scene, "", 0.2);
	scene.noise = 5; /* which black cuts off */
	scene.exposure = 0.05;
	circle_check("low light", &scene, "", 0.2);
	scene.noise = scene.exposure = 1;
	scene.blur_px = 0.7; /* the blur of any lens and of demosaicing */
	circle_check("a little blur", &scene, "", 0.1);
	scene.blur_px = 1.8; /* out of focus */
	circle_check("blur", &scene, "", 0.2);
	scene.blur_px = 0;
	scene.dark_from_deg = 100;
	scene.dark_to_deg = 190;
	circle_check("a quarter dark", &scene, "", 0.2);
	scene.dark_to_deg = 340;
	circle_check("mostly dark", &scene, "the rim is dark", 0);
	scene.dark_from_deg = scene.dark_to_deg = 0;
	scene.exposure = 6;
	circle_check("over-exposed", &scene, "over-exposed at the rim", 0);
	scene.exposure = 1;
	scene.lens.focal_px[0] = scene.lens.focal_px[1] = 190;
	circle_check("cut at top and bottom", &scene, "", 0.2);
	scene.lens.focal_px[0] = scene.lens.focal_px[1] = 240;
	circle_check("cut nearly everywhere", &scene, "no image circle was found", 0);
	scene.lens.focal_px[0] = 150;
	scene.lens.focal_px[1] = 75;
	circle_check("squashed", &scene, "", 0.2);
}

TEST("no circle")
{
	struct circle_scene scene = {.lens = whole, .exposure = 1, .noise = 1, .open = true};

	circle_check("no circle", &scene, "no image circle was found", 0);
	scene = (struct circle_scene){.lens = whole, .exposure = 0, .noise = 2};
	circle_check("lens cap", &scene, "no image circle was found", 0);
}

/* Real rooms: walls, windows and furniture at the rim. */
TEST("studio and panoramas")
{
	static const char *const names[] = {"studio_small_03_1k", "venice_sunset_1k",
					    "st_fagans_interior_1k"};
	static const double exposures[] = {1.5, 0.4, 0.6};

	const char *folder = getenv("INLAY_SHARED_DATA");
	struct circle_scene scene = {.lens = whole, .exposure = 0.8, .noise = 1, .studio = true};

	circle_check("studio", &scene, "", 0.2);
	scene.studio = false;
	for (int k = 0; k < (thorough() ? 3 : 1); k++) {
		struct image image = {.width = 0};
		const struct panorama panorama = {.image = &image, .scale = 1};
		char path[512];

		snprintf(path, sizeof(path), "%s/hdri/%s.hdr", folder ? folder : "../shared/data",
			 names[k]);
		if (image_read(path, &image, NULL)) {
			print_message("# %s is not there: not looked at\n", path);
			continue;
		}
		scene.panorama = &panorama;
		scene.exposure = exposures[k];
		circle_check(names[k], &scene, "", 0.2);
		image_free(&image);
	}
}
