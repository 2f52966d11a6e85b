/* SPDX-License-Identifier: MIT */
/*
 * What a person would photograph for inlay-calibrate fisheye, drawn through an equidistant lens of
 * 220 x 211 px/rad around (483.2, 357.4):
 *     photographs FOLDER    writes eye1.png ... eye9.png, a board 9x6:20mm; dark.png of
 *                           their size
 */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/calibrate/fisheye_photographs.h"
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

int main(int argc, char **argv)
{
	struct chance chance;

	if (argc != 2)
		return EXIT_FAILURE;
	chance = chance_begin("photographs");
	return photograph(argv[1], &chance) || photograph_nothing(argv[1]) ? EXIT_FAILURE
									   : EXIT_SUCCESS;
}
