/* SPDX-License-Identifier: MIT */
/* Vignetting (falloff of light towards the rim) from a picture of something uniform. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_falloff.h"
#include "hal/colour/transfer.h"
#include "tests/support/calibrate/fisheye_views.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static const double truth[FISHEYE_FALLOFF_TERMS] = {-0.22, 0.05, -0.012};

static struct image fisheye_falloff_take(const struct fisheye_settings *settings, double level,
					 double slope, bool thing, struct chance *chance)
{
	struct fisheye lens;
	struct image image;

	assert_int_equal(fisheye_prepare(&lens, settings, 640, 480, NULL), 0);
	assert_int_equal(image_create_u8(&image, 640, 480), 0);
	for (int p = 0; p < 640 * 480; p++) {
		const double px[2] = {p % 640 + 0.5, p / 640 + 0.5};
		double dir[3], light = 0.001;

		if (fisheye_ray(&lens, px, dir)) {
			light = level * fisheye_falloff(&lens, px) * (1 + slope * dir[0]);
			if (thing && px[0] < 260 && px[1] > 300)
				light *= 0.4;
		}
		for (int c = 0; c < 3; c++)
			image.u8[3 * p + c] = (uint8_t)fmin(
				fmax(rint(255 * transfer_encode(TRANSFER_SRGB, light) +
					  chance_normal(chance)),
				     0),
				255);
	}
	return image;
}

static void fisheye_falloff_check(double level, double slope, bool thing, const char *expected)
{
	struct chance chance = chance_begin("fisheye_falloff");

	for (int model = 0; model < FISHEYE_MODEL_COUNT; model++) {
		struct fisheye_settings settings = fisheye_views_lenses[model];
		struct falloff falloff;
		struct image image;
		char said[600];

		memcpy(settings.falloff, truth, sizeof(truth));
		image = fisheye_falloff_take(&settings, level, slope, thing, &chance);
		memset(settings.falloff, 0, sizeof(settings.falloff));
		assert_int_equal(falloff_find(&falloff, &image, &settings, NULL), 0);
		verdict_sentence(&falloff.verdict, said, sizeof(said));
		print_message("# %s: %s, spread %.3f\n", fisheye_model_names[model], said,
			      falloff.spread);
		if (*expected)
			assert_non_null(strstr(said, expected));
		else
			assert_true(falloff.verdict.trusted);
		for (double t = 0; !*expected && t < 1.5; t += 0.1) {
			const double u = t * t, *v = falloff.v;
			const double found = 1 + u * (v[0] + u * (v[1] + u * v[2]));
			const double right = 1 + u * (truth[0] + u * (truth[1] + u * truth[2]));

			expect_below(fabs(found / right - 1), 0.01, "model=%d, t=%g", model, t);
		}
		image_free(&image);
	}
}

TEST("uniform views")
{
	fisheye_falloff_check(0.6, 0, false, "");
	fisheye_falloff_check(0.6, 0, true, ""); /* something dark in a corner */
}

TEST("doubted")
{
	fisheye_falloff_check(0.5, 0.4, false, "not equally bright");
	fisheye_falloff_check(3, 0, false, "over-exposed");
	fisheye_falloff_check(0, 0, false, "no uniform view");
}
