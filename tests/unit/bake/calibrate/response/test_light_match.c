/* SPDX-License-Identifier: MIT */
/* Black level, patches, gain, colours, and the file that holds them. */
#include <math.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "bake/calibrate/response/light_black.h"
#include "bake/calibrate/response/light_colours.h"
#include "bake/calibrate/response/light_file.h"
#include "bake/calibrate/response/light_gain.h"
#include "tests/support/calibrate/patch_chart.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static void doubted(const struct verdict *verdict, const char *words)
{
	if (verdict->trusted || !strstr(verdict->reason, words))
		fail_msg("expected a doubt with \"%s\", got \"%s\"", words,
			 verdict->trusted ? "trusted" : verdict->reason);
	assert_true(strlen(verdict->remedy) > 0);
}

static void trusted(const struct verdict *verdict)
{
	if (!verdict->trusted)
		fail_msg("not trusted: %s", verdict->reason);
}

/* ---- black level ---- */

static struct image dark(double level, double noise, struct chance *chance)
{
	struct image picture;

	assert_int_equal(image_create_u8(&picture, 160, 128), 0);
	for (int k = 0; k < 160 * 128 * 3; k++)
		picture.u8[k] = (uint8_t)fmax(lrint(level + noise * chart_noise(chance)), 0);
	return picture;
}

TEST("black is found with its deviation")
{
	struct chance chance = chance_begin("light");
	int within[2] = {0};
	const int runs = 200;

	for (int k = 0; k < runs; k++) {
		const double level = chance_real(&chance, 8, 40);
		struct image picture = dark(level, 1.5, &chance);
		struct light_black black;

		assert_int_equal(light_black_covered(&black, &picture, NULL), 0);
		trusted(&black.verdict);
		expect_below(fabs(black.level - level), 0.05, "k=%d", k);
		within[0] += fabs(black.level - level) <= black.deviation;
		within[1] += fabs(black.level - level) <= 2 * black.deviation;
		image_free(&picture);
	}
	print_message("# black level: %d and %d of %d within 1 and 2 deviations\n", within[0],
		      within[1], runs);
	/* 68 % and 95 %, within four deviations of the binomial distribution: 1 seed in 200 is
	 * beyond three. */
	assert_true(fabs(within[0] - 0.683 * runs) < 4 * sqrt(0.683 * 0.317 * runs));
	assert_true(within[1] > 0.954 * runs - 4 * sqrt(0.954 * 0.046 * runs));
}

/* Noise that the camera clips at black raises the mean, but not the black level found. */
TEST("cut off noise is seen")
{
	struct chance chance = chance_begin("light");
	struct image picture = dark(16, 1.5, &chance);
	struct light_black black;

	for (int k = 0; k < 160 * 128 * 3; k++)
		picture.u8[k] = picture.u8[k] < 16 ? 16 : picture.u8[k];
	assert_int_equal(light_black_covered(&black, &picture, NULL), 0);
	trusted(&black.verdict);
	assert_true(black.level == 16);
	image_free(&picture);
}

TEST("black is doubted")
{
	struct chance chance = chance_begin("light");
	struct image picture = dark(90, 2, &chance), leak = dark(16, 1, &chance), small;
	struct light_black black;

	assert_int_equal(light_black_covered(&black, &picture, NULL), 0);
	doubted(&black.verdict, "not dark");
	for (int y = 0; y < 16; y++)
		for (int x = 0; x < 3 * 20; x++)
			leak.u8[3 * 160 * y + x] = (uint8_t)(leak.u8[3 * 160 * y + x] + 9);
	assert_int_equal(light_black_covered(&black, &leak, NULL), 0);
	doubted(&black.verdict, "light falls in");
	assert_int_equal(image_create_u8(&small, 32, 32), 0);
	assert_int_equal(light_black_covered(&black, &small, NULL), -EINVAL);
	image_free(&picture);
	image_free(&leak);
	image_free(&small);
}

/* ---- patches ---- */

TEST("areas are parsed")
{
	static const char *const wrong[] = {"",	       "1,2,3",	    "1,2,3,4,5",   "1,2,0,4",
					    "1,2 3,4", "1,2,3,nan", "1,2 3,4 5,x", "a"};
	struct light_area area;

	assert_int_equal(light_area_parse(&area, "10,20,30,40", NULL), 0);
	assert_int_equal(area.corners, 4);
	assert_true(area.corner[2][0] == 40 && area.corner[2][1] == 60);
	assert_int_equal(light_area_parse(&area, "1,2 3,4 5,6", NULL), 0);
	assert_int_equal(area.corners, 3);
	for (size_t k = 0; k < sizeof(wrong) / sizeof(*wrong); k++)
		expect_equal(light_area_parse(&area, wrong[k], NULL), -EINVAL, "k=%zu", k);
}

TEST("patches are measured")
{
	const struct transfer_curve curve = {.named = TRANSFER_BT709, .black = 16};
	struct light_area area;
	struct light_patch patch;
	struct image picture;

	assert_int_equal(image_create_u8(&picture, 64, 48), 0);
	memset(picture.u8, 255, (size_t)64 * 48 * 3);
	for (int y = 8; y < 40; y++)
		for (int x = 8; x < 40; x++)
			for (int c = 0; c < 3; c++)
				picture.u8[3 * (64 * y + x) + c] = (uint8_t)(100 + 20 * c);
	light_area_parse(&area, "8,8,32,32", NULL);
	assert_int_equal(light_patch_measure(&patch, &picture, &area, &curve, NULL), 0);
	assert_int_equal(patch.pixels, 32 * 32);
	for (int c = 0; c < 3; c++)
		expect_below(fabs(patch.mean[c] -
				  transfer_decode(TRANSFER_BT709, (84 + 20 * c) / 239.0)),
			     1e-12, "c=%d", c);
	assert_true(patch.uneven < 1e-9 && patch.clipped == 0);
	light_area_parse(&area, "24,8 40,8 40,40 24,40", NULL);
	assert_int_equal(light_patch_measure(&patch, &picture, &area, &curve, NULL), 0);
	assert_int_equal(patch.pixels, 16 * 32);
	light_area_parse(&area, "30,8,32,32", NULL);
	assert_int_equal(light_patch_measure(&patch, &picture, &area, &curve, NULL), 0);
	assert_true(patch.clipped > 0.5 && patch.uneven > 0.1);
	light_area_parse(&area, "60,46,100,100", NULL);
	assert_int_equal(light_patch_measure(&patch, &picture, &area, &curve, NULL), -EINVAL);
	image_free(&picture);
}

/* ---- gain ---- */

static struct light_pair pair_of(double gain, double noise, struct chance *chance)
{
	struct light_pair pair = {.clipped_sky = 0};

	for (int c = 0; c < 3; c++) {
		pair.predicted[c] = chance_real(chance, 0.05, 0.3);
		pair.patch.mean[c] = gain * pair.predicted[c];
	}
	for (int c = 0; c < 3; c++)
		pair.patch.mean[c] *= 1 + noise;
	pair.patch.pixels = 1000;
	return pair;
}

TEST("gain is found with its deviation")
{
	struct chance chance = chance_begin("light");
	int within[2] = {0};
	const int runs = 1000, pairs = 8;

	for (int k = 0; k < runs; k++) {
		struct light_pair pair[8];
		struct light_gain found;

		for (int i = 0; i < pairs; i++)
			pair[i] = pair_of(1.7, 0.03 * chart_noise(&chance), &chance);
		assert_int_equal(light_gain_find(&found, pair, pairs, NULL), 0);
		within[0] += fabs(found.gain - 1.7) <= found.deviation;
		within[1] += fabs(found.gain - 1.7) <= 2.365 * found.deviation; /* Student's, 7 */
	}
	print_message("# gain: %d and %d of %d within 1 and 2.365 deviations\n", within[0],
		      within[1], runs);
	/* Student's t with 7 degrees of freedom: 65 % and 95 %. */
	assert_true(fabs(within[0] - 0.649 * runs) < 4 * sqrt(0.649 * 0.351 * runs));
	assert_true(fabs(within[1] - 0.95 * runs) < 5 * sqrt(0.95 * 0.05 * runs));
}

TEST("gain is doubted")
{
	struct chance chance = chance_begin("light");
	struct light_pair pair[6];
	struct light_gain found;

	for (int i = 0; i < 6; i++)
		pair[i] = pair_of(0.8, 0.002 * chart_noise(&chance), &chance);
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), 0);
	trusted(&found.verdict);
	assert_true(fabs(found.gain - 0.8) < 0.01);
	for (int c = 0; c < 3; c++)
		pair[2].patch.mean[c] *= 0.4; /* the object's shadow */
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), 0);
	doubted(&found.verdict, "pair 3 gives");
	assert_true(fabs(found.gain - 0.8) < 0.01);
	pair[2] = pair[1];
	pair[4].patch.uneven = 0.2;
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), 0);
	doubted(&found.verdict, "patch of pair 5 is not of one brightness");
	pair[4].patch.uneven = 0;
	pair[1].patch.clipped = 0.1;
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), 0);
	doubted(&found.verdict, "patch of pair 2 is clipped");
	pair[1].patch.clipped = 0;
	pair[0].clipped_sky = 0.01;
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), 0);
	doubted(&found.verdict, "sky of pair 1 is clipped");
	for (int i = 0; i < 6; i++)
		pair[i] = pair_of(i % 2 ? 1 : 1.5, 0, &chance);
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), 0);
	doubted(&found.verdict, "the pairs differ");
	memset(pair[3].predicted, 0, sizeof(pair[3].predicted));
	assert_int_equal(light_gain_find(&found, pair, 6, NULL), -EINVAL);
	assert_int_equal(light_gain_find(&found, pair, 0, NULL), -EINVAL);
}

/* A level patch under an even sky gives off its reflectance times the sky. */
TEST("an even sky is predicted")
{
	static const double reflectance[3] = {0.5, 0.25, 1};
	float radiance[406][3];
	double predicted[3];
	struct dome dome;

	assert_int_equal(dome_create(&dome, 9, NULL), 0);
	for (int i = 0; i < dome.count; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = 0.5F;
	light_gain_predict(&dome, (const float(*)[3])radiance, reflectance, predicted);
	for (int c = 0; c < 3; c++)
		expect_below(fabs(predicted[c] - 0.5 * reflectance[c]), 1e-9, "c=%d", c);
	dome_free(&dome);
}

/* ---- colours ---- */

static const double truth[9] = {0.9, 0.2, -0.1, 0.05, 1.05, -0.1, -0.05, -0.15, 1.2};

static void fill_patches(struct light_colour_pair *pairs, int count, double saturation,
			 double noise, struct chance *chance)
{
	for (int k = 0; k < count; k++) {
		const double grey = chance_real(chance, 0.1, 0.6);
		double mean = 0;

		for (int c = 0; c < 3; c++)
			pairs[k].fisheye[c] = grey *
					      (1 + saturation * chance_real(chance, -0.8, 0.8));
		for (int r = 0; r < 3; r++) {
			double sum = 0;

			for (int c = 0; c < 3; c++)
				sum += truth[3 * r + c] * pairs[k].fisheye[c];
			pairs[k].background[r] = 2.5 * sum;
			mean += 2.5 * sum / 3;
		}
		for (int r = 0; r < 3; r++)
			pairs[k].background[r] = fmax(
				pairs[k].background[r] + mean * noise * chart_noise(chance), 0);
	}
}

TEST("colours are found with deviations")
{
	struct chance chance = chance_begin("light");
	struct light_colour_pair pairs[24];
	int within[2] = {0}, all = 0;

	for (int run = 0; run < 200; run++) {
		struct light_colours found;

		fill_patches(pairs, 24, 1, 0.01, &chance);
		assert_int_equal(light_colours_find(&found, pairs, 24, NULL), 0);
		trusted(&found.verdict);
		expect_that(found.after < found.before / 3 && found.after < 0.03, "run=%d", run);
		for (int e = 0; e < 9; e++) {
			const double off = fabs(found.matrix[e] * found.scale / 2.5 - truth[e]);
			const double d = estimate_deviation(&found.estimate, e);

			within[0] += off <= d;
			within[1] += off <= 2 * d;
			all++;
		}
		light_colours_free(&found);
	}
	print_message("# colours: %.3f and %.3f within 1 and 2 deviations\n",
		      (double)within[0] / all, (double)within[1] / all);
	assert_true(fabs((double)within[0] / all - 0.683) < 0.05);
	assert_true(fabs((double)within[1] / all - 0.954) < 0.03);
}

TEST("colours are doubted")
{
	struct chance chance = chance_begin("light");
	struct light_colour_pair pairs[24];
	struct light_colours found;

	fill_patches(pairs, 24, 0, 0, &chance);
	assert_int_equal(light_colours_find(&found, pairs, 24, NULL), 0);
	doubted(&found.verdict, "all grey");
	light_colours_free(&found);
	fill_patches(pairs, 24, 0.003, 0.01, &chance);
	assert_int_equal(light_colours_find(&found, pairs, 24, NULL), 0);
	assert_false(found.verdict.trusted);
	light_colours_free(&found);
	fill_patches(pairs, 24, 1, 0.6, &chance);
	assert_int_equal(light_colours_find(&found, pairs, 24, NULL), 0);
	assert_false(found.verdict.trusted);
	light_colours_free(&found);
	fill_patches(pairs, 3, 1, 0, &chance);
	assert_int_equal(light_colours_find(&found, pairs, 3, NULL), 0);
	doubted(&found.verdict, "so few patches");
	light_colours_free(&found);
	assert_int_equal(light_colours_find(&found, pairs, 2, NULL), -EINVAL);
	memset(&pairs[1], 0, sizeof(pairs[1]));
	assert_int_equal(light_colours_find(&found, pairs, 3, NULL), -EINVAL);
}

/* ---- files ---- */

static char path[80];

static int make_folder(void **state)
{
	if (own_folder_make(state))
		return -1;
	snprintf(path, sizeof(path), "%.70s", own_folder_path("light.ini"));
	return 0;
}

static void write_text(const char *text)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fputs(text, file);
	fclose(file);
}

TEST("files keep other keys")
{
	struct response response;
	char all[2048] = "";
	FILE *file;

	unlink(path);
	assert_int_equal(light_file_set(path, "gain", "1.5", "Gain: once.", NULL), 0);
	assert_int_equal(light_file_set(path, "black_level", "16.25", "Black.\nTwo lines.", NULL),
			 0);
	assert_int_equal(light_file_set(path, "gain", "2.5", "Gain: again.", NULL), 0);
	assert_int_equal(light_file_read(path, &response, NULL), 0);
	assert_true(response.gain == 2.5 && response.black_level == 16.25);
	assert_true(response.knot[TRANSFER_KNOTS - 1] == 0 && response.colours[0] == 0);
	file = fopen(path, "r");
	assert_true(fread(all, 1, sizeof(all) - 1, file) > 0);
	fclose(file);
	assert_non_null(strstr(all, "; Two lines.\nblack_level = 16.25\n"));
	assert_non_null(strstr(all, "; Gain: again.\ngain = 2.5\n"));
	assert_null(strstr(all, "once"));
	unlink(path);
}

/* Text that somebody wrote at the end of the file stays when it is measured again. */
TEST("files keep their end")
{
	static const char expected[] =
		"; What a camera's code values mean: inlay-calibrate light.\n"
		"[light]\n\n; Gain.\ngain = 3.5\n\n; Of the left camera.\n";
	char all[2048] = "";
	FILE *file;

	write_text("[light]\n; Of the left camera.\n");
	assert_int_equal(light_file_set(path, "gain", "2.5", "Gain.", NULL), 0);
	assert_int_equal(light_file_set(path, "gain", "3.5", "Gain.", NULL), 0);
	file = fopen(path, "r");
	assert_true(fread(all, 1, sizeof(all) - 1, file) > 0);
	fclose(file);
	assert_string_equal(all, expected);
	unlink(path);
}

TEST("damaged files are refused")
{
	static const struct {
		const char *text, *words;
	} cases[] = {
		{"", ":1: has no section [light]"},
		{"[light]\ngain = 1\n\ngain = 2\n", ":4: [light] gain: is given twice"},
		{"[light]\nblack_level = 300\n", ":2: [light] black_level: is \"300\""},
		{"[light]\nresponse = 0 1\n", ":2: [light] response: is \"0 1\", expected 33"},
		{"[light]\n\n"
		 "response = 0 .1 .1 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 .2 1\n",
		 ":3: [light] response: response does not rise from number 2 (0.1)"},
		{"[light]\ngian = 1\n", "did you mean \"gain\"?"},
		{"[light]\ncolours = 1 0 0 0 1 0 0 0 nan\n", ":2: [light] colours"},
	};
	struct response response;

	for (size_t k = 0; k < sizeof(cases) / sizeof(*cases); k++) {
		struct fault fault = {.text = ""};

		write_text(cases[k].text);
		expect_equal(light_file_read(path, &response, &fault), -EINVAL, "k=%zu", k);
		if (!strstr(fault.text, path) || !strstr(fault.text, cases[k].words))
			fail_msg("expected \"%s\" in: %s", cases[k].words, fault.text);
		expect_equal(light_file_set(path, "gain", "1", NULL, &fault), -EINVAL, "k=%zu", k);
	}
	unlink(path);
	assert_int_equal(light_file_read(path, &response, NULL), 0);
	assert_true(response.black_level == -1 && response.gain == 0);
}

TEST("patches are read")
{
	struct light_colour_pair pairs[LIGHT_PATCHES_MAX];
	struct fault fault;

	write_text("# colours\n.1 .2 .3  .4 .5 .6 # one\n\n1,1,1,2,2,2\n");
	assert_int_equal(light_colours_read(path, pairs, NULL), 2);
	assert_true(pairs[0].background[1] == 0.5 && pairs[1].fisheye[2] == 1);
	write_text("1 2 3 4 5 6\n1 2 3 4 5\n");
	assert_int_equal(light_colours_read(path, pairs, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, ".ini:2: expected six numbers"));
	unlink(path);
	assert_int_equal(light_colours_read(path, pairs, &fault), -ENOENT);
}

TEST_GROUP(make_folder, own_folder_remove);
