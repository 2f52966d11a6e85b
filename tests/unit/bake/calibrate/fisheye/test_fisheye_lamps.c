/* SPDX-License-Identifier: MIT */
/* Lamps at known directions, found in pictures drawn through known lenses: right to a part of a
 * pixel among everything that is no lamp, and doubted where they should be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/calibrate/fisheye/lamps/fisheye_lamps.h"
#include "bake/calibrate/fisheye/lamps/lamps_spots.h"
#include "hal/optics/vec.h"
#include "tests/support/calibrate/drawn_lamps.h"
#include "tests/support/calibrate/fisheye_views.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"

static double error_of(const struct fisheye_settings *truth, const struct fisheye_settings *found)
{
	struct fisheye is, should;
	double worst = 0;

	assert_int_equal(fisheye_prepare(&is, found, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT, NULL),
			 0);
	assert_int_equal(
		fisheye_prepare(&should, truth, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT, NULL), 0);
	for (int k = 0; k < 2000; k++) {
		const double theta = 1.5 * sqrt((k + 0.5) / 2000), phi = k * 2.39996;
		const double ray[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
		double dir[3], a[2], b[2];

		mat_apply_transposed(should.rotation, ray, dir);
		if (fisheye_project(&should, dir, a) && fisheye_project(&is, dir, b))
			worst = fmax(worst, hypot(a[0] - b[0], a[1] - b[1]));
	}
	return worst;
}

/* Draws, finds, and expects this verdict. A trusted lens must be right over the whole circle: to
 * error_px, or to three reported deviations where the lamps leave an unknown model more room than
 * that. */
static void test_lamps_look(const char *name, const struct drawn_lamps *d, int model,
			    const char *expected, double error_px, struct lamps_told *told,
			    struct chance *chance)
{
	const struct fisheye_wanted wanted = {
		.model = model, .field_deg = 88, .tolerance_px = 0.5, .world_view = -1};
	struct fisheye_result result;
	struct observations seen;
	struct image image;
	struct fault fault = {""};
	double error = NAN, most = 0;
	char said[VERDICT_SENTENCE_MAX];

	assert_int_equal(drawn_lamps_draw(d, &image, chance), 0);
	assert_int_equal(fisheye_lamps(&result, &seen, told, &d->lamps, "lamps.txt", &image,
				       "lamps.png", &wanted, &fault),
			 0);
	verdict_sentence(&result.finding.verdict, said, sizeof(said));
	if (result.finding.verdict.trusted) {
		error = error_of(d->lens, &result.lens);
		most = fmax(error_px, 3 * knowledge_errors(&result.knowledge).most_px);
	}
	print_message(
		"# %s: %d of %d found, %s; off by %.3f px; missing %s; merged %s; no lamps %s\n",
		name, told->found, told->lamps, said, error, told->missing, told->merged,
		told->strange);
	assert_non_null(strstr(said, expected));
	assert_false(error > most);
	fisheye_result_free(&result);
	observations_free(&seen);
	image_free(&image);
}

/* Clear lamps before dark walls. */
static struct drawn_lamps dark_room(int model)
{
	return (struct drawn_lamps){
		.lens = &fisheye_views_lenses[model], .walls = 0.02, .lamp_light = 3, .noise = 1};
}

static void every_model(void **state)
{
	struct chance chance = chance_begin("fisheye_lamps");

	(void)state;
	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++) {
		struct drawn_lamps d = dark_room(m);
		struct lamps_told told;

		drawn_lamps_place(&d, 24, 84, &chance);
		test_lamps_look(fisheye_model_names[m], &d, FISHEYE_MODEL_AUTO, "trusted", 0.2,
				&told, &chance);
		expect_equal(told.found, 24, "m=%d", m);
	}
}

static void much_else(void **state)
{
	struct chance chance = chance_begin("fisheye_lamps");
	struct drawn_lamps d = {.lens = &fisheye_views_lenses[FISHEYE_EQUISOLID],
				.walls = 0.1,
				.lamp_light = 1.5,
				.noise = 2,
				.reflections = 8,
				.hidden = 3,
				.window = true};
	struct lamps_told told;

	(void)state;
	drawn_lamps_place(&d, 30, 84, &chance);
	test_lamps_look("reflections, a window, hidden lamps", &d, FISHEYE_MODEL_AUTO, "trusted",
			0.25, &told, &chance);
	assert_non_null(strstr(told.missing, "1 at ("));
	assert_true(*told.strange);
	d.reflections = d.hidden = 0;
	d.window = false;
	d.walls = 0.02;
	d.lamp_light = 400; /* with halos that clip far around */
	test_lamps_look("clipped", &d, FISHEYE_MODEL_AUTO, "trusted", 0.2, &told, &chance);
	d.lamp_light = 0.4;
	test_lamps_look("dim", &d, FISHEYE_MODEL_AUTO, "trusted", 0.2, &told, &chance);
	drawn_lamps_place(&d, 6, 80, &chance);
	test_lamps_look("few, of a model that is known", &d, FISHEYE_EQUISOLID, "trusted", 0.5,
			&told, &chance);
}

static void merged(void **state)
{
	struct chance chance = chance_begin("fisheye_lamps");
	struct drawn_lamps d = dark_room(FISHEYE_EQUIDISTANT);
	struct lamps_told told;

	(void)state;
	drawn_lamps_place(&d, 20, 84, &chance);
	d.lamp[5] = d.lamp[4];
	d.lamp[5].line = 6;
	for (int i = 0; i < 3; i++)
		d.lamp[5].dir[i] += i == 2 ? 0.016 : 0.004;
	vec_normalize(d.lamp[5].dir);
	test_lamps_look("two in one spot", &d, FISHEYE_MODEL_AUTO, "trusted", 0.2, &told, &chance);
	assert_string_equal(told.merged, "5, 6");
	assert_int_equal(told.found, 18);
}

static void doubted(void **state)
{
	struct chance chance = chance_begin("fisheye_lamps");
	struct drawn_lamps d = dark_room(FISHEYE_EQUIDISTANT);
	struct lamps_told told;

	(void)state;
	drawn_lamps_place(&d, 20, 84, &chance);
	d.mirrored = true;
	test_lamps_look("mirrored", &d, FISHEYE_MODEL_AUTO, "the picture is mirrored", 0, &told,
			&chance);
	d.mirrored = false;
	d.hidden = 13;
	test_lamps_look("most are hidden", &d, FISHEYE_EQUIDISTANT,
			"only 7 of the 20 lamps of lamps.txt were found", 0, &told, &chance);
	d.hidden = 18;
	test_lamps_look("two are seen", &d, FISHEYE_MODEL_AUTO,
			"shows 2 bright spots, fewer than 4", 0, &told, &chance);
	d.hidden = 0;
	drawn_lamps_place(&d, 5, 84, &chance);
	test_lamps_look("five, of any model", &d, FISHEYE_MODEL_AUTO,
			"fewer than the 6 that tell a lens", 0, &told, &chance);
	drawn_lamps_place(&d, 12, 84, &chance);
	for (int n = 0; n < 12; n++)
		chance_direction(&chance, 0, d.lamp[n].dir);
	{
		struct lamp other[DRAWN_LAMPS_MAX];
		struct drawn_lamps e = d;

		memcpy(other, d.lamp, sizeof(other));
		for (int n = 0; n < 12; n++)
			chance_direction(&chance, 0, other[n].dir);
		e.lamps.lamp = other;
		test_lamps_look("other lamps", &e, FISHEYE_MODEL_AUTO,
				"not where any fisheye shows the lamps", 0, &told, &chance);
	}
}

/* A ring of lamps looks the same after each step of its turn, unless one direction is known about.
 */
static void ring(void **state)
{
	struct chance chance = chance_begin("fisheye_lamps");
	struct drawn_lamps d = {.lens = &fisheye_views_lenses[FISHEYE_EQUIDISTANT],
				.walls = 0.02,
				.lamp_light = 3,
				.noise = 1,
				.lamps = {d.lamp, 17}};
	struct lamps_told told;
	struct fisheye lens;

	(void)state;
	assert_int_equal(
		fisheye_prepare(&lens, d.lens, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT, NULL), 0);
	for (int n = 0; n < 17; n++) {
		const double theta = n < 8 ? 1.35 : n < 16 ? 0.7 : 0, phi = M_PI / 4 * (n % 8);

		d.lamp[n] = (struct lamp){
			.line = n + 1,
			.dir = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)}};
	}
	test_lamps_look("a ring", &d, FISHEYE_MODEL_AUTO, "which is which cannot be told", 0, &told,
			&chance);
	for (int n = 0; n < 2; n++) {
		expect_that(fisheye_project(&lens, d.lamp[n].dir, d.lamp[n].near_px), "n=%d", n);
		d.lamp[n].hinted = true;
		d.lamp[n].near_px[0] += 15;
	}
	test_lamps_look("a ring with a hint", &d, FISHEYE_MODEL_AUTO, "trusted", 0.2, &told,
			&chance);
}

static void expect_fault(const char *text, const char *words)
{
	char path[] = "/tmp/inlay-lamps-XXXXXX";
	const int file = mkstemp(path);
	struct fault fault = {""};
	struct lamps lamps;
	int err;

	assert_true(file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text));
	close(file);
	err = lamps_read(&lamps, path, &fault);
	unlink(path);
	print_message("# %s\n", fault.text);
	assert_int_equal(err, words ? -EINVAL : 0);
	if (words)
		assert_non_null(strstr(fault.text, words));
	else
		assert_int_equal(lamps.count, 3);
	lamps_free(&lamps);
}

static void files(void **state)
{
	(void)state;
	expect_fault("# lamps\r\n0 45\r\n\r\n90, 10, 320, 17\r\n0 0 2 3 4 # above\r\n", NULL);
	expect_fault("", "holds no lamps");
	expect_fault("0 45\n0 95\n", ":2: expected azimuth and elevation");
	expect_fault("0 45\n0 nan\n", ":2: expected azimuth and elevation");
	expect_fault("0 0 0\n", ":1: expected azimuth and elevation");
	expect_fault("1\n", ":1: expected azimuth and elevation");
	expect_fault("1 2 3 4 5 6\n", ":1: expected azimuth and elevation");
	expect_fault("0 45\n0 1 0\n1 0 1\n", ":3: is in the direction of line 1");
}

/* Two soft spots, a hot pixel's light beside them, and something large. */
static void spots(void **state)
{
	struct image image;
	struct spots found;

	(void)state;
	assert_int_equal(image_create_f32(&image, DRAWN_LAMPS_WIDTH, DRAWN_LAMPS_HEIGHT), 0);
	for (int p = 0; p < DRAWN_LAMPS_WIDTH * DRAWN_LAMPS_HEIGHT; p++)
		for (int c = 0; c < 3; c++) {
			const double x = p % DRAWN_LAMPS_WIDTH + 0.5,
				     y = p / DRAWN_LAMPS_WIDTH + 0.5;
			const double a = hypot(x - 100.3, y - 50.8), b = hypot(x - 111.3, y - 50.8);

			image.f32[3 * p + c] =
				(float)(0.1 + exp(-a * a / 8) + 0.5 * exp(-b * b / 8) +
					(x > 300 && x < 380 && y > 200 && y < 290 ? 0.8 : 0) +
					(y < 1 && x > 400 && x < 403 ? 2 : 0));
		}
	assert_int_equal(spots_find(&found, &image), 0);
	assert_int_equal(found.count, 2);
	assert_true(hypot(found.spot[0].px[0] - 100.3, found.spot[0].px[1] - 50.8) < 0.02);
	assert_true(hypot(found.spot[1].px[0] - 111.3, found.spot[1].px[1] - 50.8) < 0.05);
	spots_free(&found);
	memset(image.f32, 0, sizeof(float) * 3 * DRAWN_LAMPS_WIDTH * DRAWN_LAMPS_HEIGHT);
	assert_int_equal(spots_find(&found, &image), 0);
	assert_int_equal(found.count, 0);
	spots_free(&found);
	image_free(&image);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(spots),       cmocka_unit_test(files),
		cmocka_unit_test(every_model), cmocka_unit_test(much_else),
		cmocka_unit_test(merged),      cmocka_unit_test(doubted),
		cmocka_unit_test(ring),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
