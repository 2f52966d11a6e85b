/* SPDX-License-Identifier: MIT */
/* The image circle as the simulated camera draws it, with noise, in 8 bits. */
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/calibrate/fisheye/circle/fisheye_circle.h"
#include "drivers/drivers.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

static void *place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

static void test_sim_set(void *options, const char *option)
{
	const struct ini_table tables[] = {
		{.section = "sim", .keys = camera_sim.keys, .place = place}, INI_TABLES_END};
	struct ini_report report = {0};
	char text[600];

	snprintf(text, sizeof(text), "sim.%s", option);
	if (ini_set(text, tables, options, &report))
		fail_msg("%s", report.first.text);
}

/* Takes a picture; options are "key=value", NULL at the end. */
static struct image test_sim_take(const char *const *options)
{
	struct camera_settings settings = {
		.width = 640, .height = 480, .buffers = 2, .format = PIXEL_BGRX};
	void *sim = calloc(1, camera_sim.options_size);
	struct camera camera = {.ops = NULL};
	struct fault fault = {.text = ""};
	struct image image;
	struct frame frame;
	struct pollfd waiting = {.events = POLLIN};

	ini_defaults(camera_sim.keys, sim);
	while (*options)
		test_sim_set(sim, *options++);
	if (camera_open(&camera, &camera_sim, &settings, sim, &fault))
		fail_msg("%s", fault.text);
	waiting.fd = camera_descriptor(&camera);
	assert_int_equal(poll(&waiting, 1, 60000), 1);
	assert_int_equal(camera_grab(&camera, &frame, &fault), 0);
	assert_int_equal(image_create_u8(&image, 640, 480), 0);
	for (size_t p = 0; p < 640 * 480; p++)
		for (size_t c = 0; c < 3; c++)
			image.u8[3 * p + c] = frame.planes[0].data[4 * p + 2 - c];
	camera_release(&camera, &frame);
	camera_close(&camera);
	free(sim);
	return image;
}

/* Largest distance of two lenses' images in the image circle. */
static double error_of(const struct fisheye *truth, const struct fisheye_settings *found)
{
	struct fisheye lens;
	double worst = 0;

	assert_int_equal(fisheye_prepare(&lens, found, 640, 480, NULL), 0);
	lens.field_rad = M_PI;
	for (int y = 0; y < 480; y += 4)
		for (int x = 0; x < 640; x += 4) {
			const double px[2] = {x + 0.5, y + 0.5};
			double dir[3], there[2];

			if (!fisheye_ray(truth, px, dir))
				continue;
			expect_that(fisheye_project(&lens, dir, there), "y=%d, x=%d", y, x);
			worst = fmax(worst, hypot(there[0] - px[0], there[1] - px[1]));
		}
	return worst;
}

static void test_sim_check(const char *name, const char *source, const char *exposure)
{
	const char *const options[] = {"clock=frames",
				       "focal=140 134",
				       "centre=322.3 238.6",
				       "read_noise=0.3",
				       "shot_noise=1.5",
				       "black_level=8",
				       exposure,
				       source ? "source=panorama" : "source=studio",
				       source,
				       NULL};
	const struct fisheye_settings lens = {
		.focal_px = {140, 134}, .centre_px = {322.3, 238.6}, .field_deg = 90};
	const struct fisheye_wanted wanted = {.model = FISHEYE_EQUIDISTANT,
					      .field_deg = 90,
					      .tolerance_px = 0.5,
					      .world_view = -1};
	struct image image = test_sim_take(options);
	struct fisheye_result result;
	struct observations seen;
	struct fisheye truth;
	char said[600];
	double error;

	assert_int_equal(fisheye_prepare(&truth, &lens, 640, 480, NULL), 0);
	assert_int_equal(fisheye_circle(&result, &seen, &image, name, 90, &wanted, NULL), 0);
	verdict_sentence(&result.finding.verdict, said, sizeof(said));
	assert_true(result.finding.estimate.count > 0);
	error = error_of(&truth, &result.lens);
	print_message("# %s, %s: %s; lens off by %.3f px\n", name, exposure, said, error);
	assert_true(result.finding.verdict.trusted);
	assert_true(error < 0.2);
	fisheye_result_free(&result);
	observations_free(&seen);
	image_free(&image);
}

TEST("studio")
{
	test_sim_check("studio", NULL, "exposure=0.8");
	test_sim_check("studio", NULL, "exposure=0.2");
}

TEST("panoramas")
{
	static const char *const names[] = {"studio_small_03_1k", "venice_sunset_1k",
					    "st_fagans_interior_1k"};
	static const char *const exposures[][2] = {{"exposure=1.5", "exposure=0.6"},
						   {"exposure=0.4", "exposure=0.1"},
						   {"exposure=0.6", "exposure=0.2"}};
	const char *folder = getenv("INLAY_SHARED_DATA");

	for (int k = 0; k < (thorough() ? 3 : 1); k++)
		for (int e = 0; e < 2; e++) {
			char option[520];

			snprintf(option, sizeof(option), "file=%s/hdri/%s.hdr",
				 folder ? folder : "../shared/data", names[k]);
			if (access(option + strlen("file="), R_OK))
				print_message("# %s is not there: not looked at\n", option);
			else
				test_sim_check(names[k], option, exposures[k][e]);
		}
}
