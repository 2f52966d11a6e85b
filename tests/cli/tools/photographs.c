/* SPDX-License-Identifier: MIT */
/*
 * What a person would photograph for inlay-calibrate fisheye, drawn through an equidistant lens of
 * 220 x 211 px/rad around (483.2, 357.4), and lamps through that of the first of fisheye_views_lenses:
 *     photographs FOLDER    writes eye1.png ... eye9.png, a board 9x6:20mm; dark.png of
 *                           their size; lamps.png, lamps.txt
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/calibrate/drawn_lamps.h"
#include "tests/support/calibrate/fisheye_photographs.h"
#include "tests/support/calibrate/fisheye_views.h"
#include "tests/support/chance.h"

static int keep(const char *folder, const char *name, struct image *image)
{
	char path[4096];
	struct fault fault = {""};
	int err;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	err = image_write(path, image, &fault);
	if (err)
		fprintf(stderr, "photographs: %s\n", fault.text);
	image_free(image);
	return err;
}

static int photograph(const char *folder, struct chance *chance)
{
	const struct fisheye_settings settings = {.focal_px = {220, 211},
						  .centre_px = {483.2, 357.4},
						  .field_deg = 88,
						  .model = FISHEYE_EQUIDISTANT};
	struct fisheye lens;
	struct board board;
	int err = board_parse(&board, "9x6:20mm", NULL);

	if (!err)
		err = fisheye_prepare(&lens, &settings, FISHEYE_PHOTOGRAPH_WIDTH,
				      FISHEYE_PHOTOGRAPH_HEIGHT, NULL);
	for (int k = 0; k < FISHEYE_PHOTOGRAPHS && !err; k++) {
		struct image image;
		char name[16];

		snprintf(name, sizeof(name), "eye%d.png", k + 1);
		err = fisheye_photograph_board(&image, &board, &lens, k, chance);
		if (!err)
			err = keep(folder, name, &image);
	}
	return err;
}

static int photograph_nothing(const char *folder)
{
	struct image image;
	const int err = image_create_u8(&image, FISHEYE_PHOTOGRAPH_WIDTH,
					FISHEYE_PHOTOGRAPH_HEIGHT);

	return err ? err : keep(folder, "dark.png", &image);
}

static int light_lamps(const char *folder, struct chance *chance)
{
	struct drawn_lamps lamps = {
		.lens = &fisheye_views_lenses[0], .walls = 0.05, .lamp_light = 2, .noise = 1};
	struct image image;
	char path[4096];
	FILE *file;
	int err;

	drawn_lamps_place(&lamps, 20, 84, chance);
	err = drawn_lamps_draw(&lamps, &image, chance);
	if (!err)
		err = keep(folder, "lamps.png", &image);
	snprintf(path, sizeof(path), "%s/lamps.txt", folder);
	file = err ? NULL : fopen(path, "w");
	if (!file)
		return -1;
	for (int n = 0; n < lamps.lamps.count; n++) {
		const double *dir = lamps.lamp[n].dir;

		fprintf(file, "%.6f %.6f\n", atan2(dir[1], dir[0]) * (180 / M_PI),
			asin(dir[2]) * (180 / M_PI));
	}
	return fclose(file);
}

int main(int argc, char **argv)
{
	struct chance chance;

	if (argc != 2)
		return EXIT_FAILURE;
	chance = chance_begin("photographs");
	return photograph(argv[1], &chance) || photograph_nothing(argv[1]) ||
			       light_lamps(argv[1], &chance)
		       ? EXIT_FAILURE
		       : EXIT_SUCCESS;
}
