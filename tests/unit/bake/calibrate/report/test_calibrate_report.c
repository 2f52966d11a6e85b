/* SPDX-License-Identifier: MIT */
/* Reports of calibrations: few points, many views, unknown values, and what is refused. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "bake/calibrate/report/report.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

/* ---- findings that are made up ---- */

#define SEED 20

static struct chance made = {SEED};

/* -1..1 */
static double chance(void)
{
	return chance_real(&made, -1, 1);
}

static double grows_outwards(const void *context, const double px[2])
{
	const struct finding *f = context;
	const double far = hypot(px[0] - f->width / 2.0, px[1] - f->height / 2.0) / f->width;

	return 0.02 + 0.8 * far * far * far;
}

/* Axes from 100, 100: X to the right, Y down, Z up to the left; the third view sees none. */
static bool plain_axes(const void *context, int view, const double world[3], double px[2])
{
	(void)context;
	px[0] = 100 + 50 * world[0] - 30 * world[2];
	px[1] = 100 + 50 * world[1] - 30 * world[2];
	return view < 2;
}

static double of_a_circle(const void *context, const double px[2])
{
	const struct finding *f = context;
	const double far = hypot(px[0] - f->width / 2.0, px[1] - f->height / 2.0);

	return far < f->height / 2.0 ? grows_outwards(context, px) : -1;
}

static double unknown(const void *context, const double px[2])
{
	(void)context;
	(void)px;
	return NAN;
}

static double nothing(const void *context, const double px[2])
{
	(void)context;
	(void)px;
	return 0;
}

/* Views of across x down points each, somewhere in the picture, with noise. */
static void make_points(struct observations *seen, int views, int across, int down, int width,
			int height)
{
	seen->width = width;
	seen->height = height;
	for (int v = 0; v < views; v++) {
		const double left = width * (0.3 + 0.25 * chance());
		const double top = height * (0.3 + 0.25 * chance()), lean = 0.2 * chance();
		char name[32];

		snprintf(name, sizeof(name), "board<%d>&.png", v);
		assert_int_equal(observations_begin_view(seen, name), 0);
		for (int y = 0; y < down; y++)
			for (int x = 0; x < across; x++) {
				const double world[3] = {x, y, 0};
				const double px[2] = {left + width * 0.4 * x / across,
						      top + height * 0.4 * (y + lean * x) / down};

				assert_int_equal(observations_add(seen, world, px,
								  "%s corner %d,%d", name, x, y),
						 0);
			}
	}
}

static void make_estimate(struct estimate *e, int views)
{
	static const char *const lens[] = {"focal", "kappa1", "centre x", "centre y", "aspect"};
	static const char *const pose[] = {"rotation x",    "rotation y",    "rotation z",
					   "translation x", "translation y", "translation z"};
	const int count = 5 + 6 * views;

	assert_int_equal(estimate_create(e, count), 0);
	for (int k = 0; k < count; k++) {
		struct parameter *p = &e->parameter[k];

		if (k < 5)
			snprintf(p->name, sizeof(p->name), "%s", lens[k]);
		else
			snprintf(p->name, sizeof(p->name), "view %d %s", (k - 5) / 6 + 1,
				 pose[(k - 5) % 6]);
		snprintf(p->unit, sizeof(p->unit), "mm");
		p->value = 10 * chance();
		p->fixed = k == 4;
		for (int j = 0; j < count && !p->fixed; j++)
			if (j != 4)
				e->covariance[j * count + k] = e->covariance[k * count + j] =
					k == j ? 1e-4 : 3e-5 * chance();
	}
	e->covariance[0 * count + 10] = e->covariance[10 * count] = -9.7e-5;
	e->residuals = 200;
	e->freedom = 200 - count + 1;
	e->sigma = 0.1;
}

static void make_finding(struct finding *f, const struct observations *seen, double noise)
{
	assert_int_equal(finding_create(f, "camera", seen), 0);
	snprintf(f->model, sizeof(f->model), "Tsai, undistorted from distorted");
	make_estimate(&f->estimate, seen->views);
	for (int k = 0; k < seen->count; k++) {
		f->weight[k] = 1;
		for (int i = 0; i < 2; i++)
			f->expected[k][i] = seen->point[k].px[i] +
					    noise * (chance() + chance() + chance());
	}
	f->rms_px = noise;
	f->worst_px = 2.5 * noise;
	f->uncertainty = grows_outwards;
	f->context = f;
	finding_add(f, "object_error_px", "error at the object's place, one standard deviation",
		    "px", 0.04);
}

/* ---- what a report holds ---- */

static void write_report(const char *folder, const struct finding *f,
			 const struct image *const *pictures)
{
	struct fault fault = {.text = ""};

	if (calibration_report_write(own_folder_path(folder), f, pictures, &fault))
		fail_msg("%s", fault.text);
}

static char *contents(const char *folder, const char *name)
{
	char path[2 * PATH_MAX];
	char *text = NULL;
	size_t bytes = 0;
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", own_folder_path(folder), name);
	file = fopen(path, "r");
	if (!file)
		fail_msg("%s is not there", path);
	assert_true(getdelim(&text, &bytes, 0, file) > 0);
	fclose(file);
	return text;
}

static void assert_holds(const char *folder, const char *name, const char *words)
{
	char *text = contents(folder, name);

	if (!strstr(text, words))
		fail_msg("%s/%s does not hold: %s", folder, name, words);
	free(text);
}

/* The table of the picture's parts counts this many points. */
static void assert_counts(const char *folder, int points)
{
	char *text = contents(folder, "parts.csv"), *at = strchr(text, '\n');
	int rows = 0, sum = 0, count;

	for (; at && sscanf(at, "\n%*f,%*f,%d", &count) == 1; at = strchr(at + 1, '\n')) {
		sum += count;
		rows++;
	}
	assert_int_equal(rows, 9);
	assert_int_equal(sum, points);
	free(text);
}

static int files(const char *folder, const char *begin)
{
	DIR *dir = opendir(own_folder_path(folder));
	const struct dirent *entry;
	int count = 0;

	assert_non_null(dir);
	while ((entry = readdir(dir)))
		count += entry->d_name[0] != '.' && !strncmp(entry->d_name, begin, strlen(begin));
	closedir(dir);
	return count;
}

static struct image shown(const char *folder, const char *name)
{
	struct fault fault = {.text = ""};
	char path[2 * PATH_MAX];
	struct image image;

	snprintf(path, sizeof(path), "%s/%s", own_folder_path(folder), name);
	if (image_read(path, &image, &fault))
		fail_msg("%s", fault.text);
	return image;
}

/* Number of pixels in the colour of outliers, above the line of the legend. */
static int outlier_pixels(const char *folder, const char *name)
{
	struct image image = shown(folder, name);
	int count = 0;

	for (int k = 0; k < image.width * (image.height - 36); k++)
		count += abs(image.u8[3 * k] - 213) < 4 && abs(image.u8[3 * k + 1] - 94) < 4 &&
			 image.u8[3 * k + 2] < 4;
	image_free(&image);
	return count;
}

/* Sum of a pixel's channels. */
static int brightness(const struct image *image, int x, int y)
{
	const uint8_t *pixel = image->u8 + 3 * (y * image->width + x);

	return pixel[0] + pixel[1] + pixel[2];
}

/* Returns the channel that is by far the strongest at this place of the camera's picture of 640 x
 * 480; -1: there is none. */
static int colour_at(const struct image *sheet, double x, double y)
{
	const double scale = (960 - 2 * 16) / 640.0;
	const uint8_t *pixel = sheet->u8 +
			       3 * ((int)(16 + scale * y) * sheet->width + (int)(16 + scale * x));

	for (int k = 0; k < 3; k++)
		if (pixel[k] > 60 + pixel[(k + 1) % 3] && pixel[k] > 60 + pixel[(k + 2) % 3])
			return k;
	return -1;
}

static void take_away(const char *folder)
{
	DIR *dir = opendir(own_folder_path(folder));
	const struct dirent *entry;

	assert_non_null(dir);
	while ((entry = readdir(dir)))
		if (entry->d_name[0] != '.')
			assert_int_equal(unlinkat(dirfd(dir), entry->d_name, 0), 0);
	closedir(dir);
	assert_int_equal(rmdir(own_folder_path(folder)), 0);
}

/* ---- the tests ---- */

TEST("five points")
{
	struct observations seen = {.count = 0};
	struct finding f;

	make_points(&seen, 1, 5, 1, 0, 0);
	for (int k = 0; k < 5; k++) {
		seen.point[k].px[0] = 100 + 40 * k;
		seen.point[k].px[1] = 90 + 3 * k * k;
	}
	make_finding(&f, &seen, 0.1);
	f.width = f.height = 0;
	f.uncertainty = nothing;
	verdict_doubt(&f.verdict, "spread them & \"turn\" <the board>", "all points lie on a line");
	write_report("five", &f, NULL);
	assert_holds(
		"five", "report.html",
		"<strong>Not trusted.</strong> all points lie on a line; spread them &amp; &quot;turn&quot; &lt;the board&gt;");
	assert_counts("five", 5);
	assert_holds("five", "calibration.json", "\"trusted\": false");
	assert_holds("five", "calibration.json", "spread them & \\\"turn\\\" <the board>");
	assert_int_equal(files("five", "view-"), 1);
	take_away("five");
	finding_free(&f);
	observations_free(&seen);
}

TEST("photographs")
{
	const struct image *pictures[3] = {NULL};
	struct observations seen = {.count = 0};
	struct image picture, image;
	struct finding f;

	assert_int_equal(image_create_u8(&picture, 640, 480), 0);
	for (int k = 0; k < 3 * 640 * 480; k++)
		picture.u8[k] = (uint8_t)((k / 60 + k / 38400) % 2 ? 40 : 220);
	make_points(&seen, 3, 9, 6, 640, 480);
	make_finding(&f, &seen, 0.1);
	f.weight[10] = 0.01;
	f.expected[10][0] += 12;
	f.expected[60][1] = NAN; /* behind the camera */
	pictures[0] = &picture;
	write_report("photographs", &f, pictures);
	assert_holds("photographs", "report.html", "<strong>Trusted.</strong>");
	assert_holds("photographs", "report.html", "Outliers left out: 2.");
	assert_holds("photographs", "calibration.json", "\"residual_px\": [null, null]");
	assert_holds("photographs", "calibration.json", "\"object_error_px\": {");
	assert_int_equal(files("photographs", "view-"), 3);
	assert_true(outlier_pixels("photographs", "view-001.png") > 20);
	assert_true(outlier_pixels("photographs", "view-002.png") > 20);
	assert_int_equal(outlier_pixels("photographs", "view-003.png"), 0);
	image = shown("photographs", "view-001.png");
	/* the photograph is there, paled: its squares show away from all marks */
	assert_true(brightness(&image, 20, 20) != brightness(&image, 20, 20 + 29));
	image_free(&image);
	image = shown("photographs", "view-002.png");
	assert_int_equal(brightness(&image, 20, 20), brightness(&image, 20, 20 + 29));
	image_free(&image);
	assert_counts("photographs", 3 * 9 * 6 - 2);
	/* the middles of a corner and of the picture: 0.02 + 0.8 (far / width)^3 */
	assert_holds("photographs", "parts.csv", "\n106.6667,80,");
	assert_holds("photographs", "parts.csv", ",0.07787037\n");
	assert_holds("photographs", "parts.csv", ",0.02\n");
	/* an earlier report is replaced; photographs are optional */
	write_report("photographs", &f, NULL);
	assert_int_equal(files("photographs", "view-"), 3);
	take_away("photographs");
	image_free(&picture);
	finding_free(&f);
	observations_free(&seen);
}

TEST("axes")
{
	struct observations seen = {.count = 0};
	struct image image;
	struct finding f;

	make_points(&seen, 3, 9, 6, 640, 480);
	make_finding(&f, &seen, 0.1);
	f.project = plain_axes;
	write_report("axes", &f, NULL);
	/* 8 across: axes of 2, which are 100 px long */
	assert_holds("axes", "report.html", "The axes X, Y and Z of its points are 2 long.");
	for (int v = 0; v < 3; v++) {
		const bool drawn = v < 2;
		char name[32];

		snprintf(name, sizeof(name), "view-%03d.png", v + 1);
		image = shown("axes", name);
		expect_equal(colour_at(&image, 195, 100), drawn ? 0 : -1, "v=%d", v);
		expect_equal(colour_at(&image, 100, 195), drawn ? 1 : -1, "v=%d", v);
		expect_equal(colour_at(&image, 50, 50), drawn ? 2 : -1, "v=%d", v);
		expect_equal(colour_at(&image, 100, 90), -1, "v=%d", v);
		image_free(&image);
	}
	take_away("axes");
	finding_free(&f);
	observations_free(&seen);
}

TEST("many views")
{
	struct observations seen = {.count = 0};
	struct finding f;

	make_points(&seen, 100, 10, 10, 1920, 1080);
	make_finding(&f, &seen, 0.3);
	for (int k = 7000; k < 7100; k++)
		f.expected[k][0] += 3e6; /* the worst view, by far */
	f.estimate.covariance[2 * f.estimate.count + 2] = INFINITY;
	f.uncertainty = unknown;
	write_report("many", &f, NULL);
	assert_int_equal(files("many", "view-"), 12);
	assert_int_equal(files("many", "view-071"), 1);
	assert_holds("many", "report.html", "12 of 100 views are drawn");
	assert_holds("many", "parts.csv", ",\n"); /* its uncertainty is not known */
	take_away("many");
	finding_free(&f);
	observations_free(&seen);
}

TEST("fisheye")
{
	struct observations seen = {.count = 0};
	struct finding f;

	make_points(&seen, 8, 7, 5, 720, 576);
	make_finding(&f, &seen, 0);
	f.what = "fisheye";
	f.uncertainty = of_a_circle;
	write_report("fisheye", &f, NULL);
	assert_holds("fisheye", "report.html", "<title>Calibration of the fisheye</title>");
	assert_holds("fisheye", "parts.csv", ",0.02\n");
	assert_holds("fisheye", "parts.csv", ",\n"); /* a corner is not seen */
	take_away("fisheye");
	finding_free(&f);
	observations_free(&seen);
}

/* Nothing could be solved: the points are shown all the same. */
TEST("without model")
{
	struct observations seen = {.count = 0};
	struct finding f;

	make_points(&seen, 2, 4, 3, 640, 480);
	assert_int_equal(finding_create(&f, "camera", &seen), 0);
	verdict_doubt(&f.verdict, "spread them", "all points lie on a line");
	write_report("none", &f, NULL);
	assert_holds("none", "report.html", "No model was found.");
	assert_holds("none", "report.html", "View 2, board&lt;1&gt;&amp;.png: 12 points.");
	assert_holds("none", "report.html", "<td>board&lt;1&gt;&amp;.png</td>");
	assert_holds("none", "calibration.json", "\"residual_px\": [null, null]");
	assert_holds("none", "calibration.json", "\"rms_px\": null");
	assert_int_equal(files("none", "view-"), 2);
	assert_int_equal(files("none", "residuals"), 0);
	take_away("none");
	finding_free(&f);
	observations_free(&seen);
}

TEST("refused")
{
	const struct image *pictures[1];
	struct observations seen = {.count = 0};
	struct fault fault = {.text = ""};
	struct image picture;
	struct finding f;
	FILE *file;

	make_points(&seen, 1, 4, 3, 640, 480);
	make_finding(&f, &seen, 0.1);
	assert_int_equal(image_create_u8(&picture, 64, 48), 0);
	pictures[0] = &picture;
	assert_int_equal(calibration_report_write(own_folder_path("none"), &f, pictures, &fault),
			 -EINVAL);
	assert_string_equal(fault.text,
			    "board<0>&.png: a picture of 64 x 48, expected 8 bits and 640 x 480");
	assert_int_equal(access(own_folder_path("none"), F_OK), -1);
	/* an earlier report stays */
	assert_int_equal(calibration_report_write(own_folder_path("kept"), &f, NULL, &fault), 0);
	assert_int_equal(calibration_report_write(own_folder_path("kept"), &f, pictures, &fault),
			 -EINVAL);
	assert_int_equal(files("kept", "report.html"), 1);
	take_away("kept");
	assert_int_equal(mkdir(own_folder_path("full"), 0755), 0);
	file = fopen(own_folder_path("full/letter.txt"), "w");
	assert_non_null(file);
	fclose(file);
	assert_int_equal(calibration_report_write(own_folder_path("full"), &f, NULL, &fault),
			 -EEXIST);
	take_away("full");
	image_free(&picture);
	finding_free(&f);
	observations_free(&seen);
}

TEST_GROUP(own_folder_make, own_folder_remove);
