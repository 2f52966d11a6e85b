/* SPDX-License-Identifier: MIT */
/*
 * compare A B [--difference OUT.png] [--mirror] [--mean SIDE]
 *
 * Measures how far two pictures are apart, in 8-bit sRGB levels: prints "PSNR_dB RMS MAX". 8-bit
 * pictures are compared as they are; float ones hold linear light and are clipped to 0..1 and
 * encoded, but not rounded. The difference picture is mid-grey where they agree, plus four levels
 * for each level of A - B. --mirror first swaps left and right in A, which a test must notice.
 * --mean compares means over squares of that many pixels, from which noise is gone.
 */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/colour/transfer.h"
#include "hal/image/image.h"

#define MAGNIFIED 4

struct options {
	const char *path[2];
	const char *difference;
	bool mirror;
	int side; /* of the squares; 1: each pixel */
};

static double level(const struct image *image, size_t i)
{
	return image->u8 ? image->u8[i] : 255 * transfer_encode(TRANSFER_SRGB, image->f32[i]);
}

static int write_difference(const char *path, const struct image *size, const double *difference,
			    struct fault *fault)
{
	struct image out;
	int err = image_create_u8(&out, size->width, size->height);

	if (err)
		return fault_say(fault, err, "out of memory");
	for (size_t i = 0; i < (size_t)3 * size->width * size->height; i++)
		out.u8[i] = (uint8_t)lrint(fmin(fmax(128 + MAGNIFIED * difference[i], 0), 255));
	err = image_write(path, &out, fault);
	image_free(&out);
	return err;
}

/* Replaces each value by the mean over its square; squares fill the picture. */
static void average(double *value, int width, int height, int side)
{
	for (int pass = 0; pass < 2; pass++)
		for (int i = 0; i < 3 * width * height; i++) {
			const int x = i / 3 % width, y = i / 3 / width;
			/* of the square's pixel that comes first in memory */
			const int first = i - 3 * (y % side * width + x % side);

			if (pass)
				value[i] = first == i ? value[i] / (side * side) : value[first];
			else if (first != i)
				value[first] += value[i];
		}
}

static int compare(const struct options *options, const struct image picture[2],
		   struct fault *fault)
{
	const int width = picture[0].width, height = picture[0].height;
	const size_t count = (size_t)3 * width * height;
	double *difference, squares = 0, worst = 0;
	int err = 0;

	if (width != picture[1].width || height != picture[1].height)
		return fault_say(fault, -1, "%s is %d x %d, %s is %d x %d: expected one size",
				 options->path[0], width, height, options->path[1],
				 picture[1].width, picture[1].height);
	difference = malloc(count * sizeof(*difference));
	if (!difference)
		return fault_say(fault, -1, "out of memory");
	for (size_t i = 0; i < count; i++) {
		const size_t x = i / 3 % width;
		const size_t from = options->mirror ? i + 3 * (width - 1 - 2 * x) : i;

		difference[i] = level(&picture[0], from) - level(&picture[1], i);
	}
	average(difference, width, height, options->side);
	for (size_t i = 0; i < count; i++) {
		squares += difference[i] * difference[i];
		worst = fmax(worst, fabs(difference[i]));
	}

	const double rms = sqrt(squares / (double)count);

	printf("%.2f %.3f %.1f\n", 20 * log10(255 / rms), rms, worst);
	if (options->difference)
		err = write_difference(options->difference, &picture[0], difference, fault);
	free(difference);
	return err;
}

static bool parse(struct options *options, int argc, char **argv)
{
	int paths = 0;

	for (int i = 1; i < argc; i++) {
		if (!strcmp(argv[i], "--mirror"))
			options->mirror = true;
		else if (!strcmp(argv[i], "--difference") && i + 1 < argc)
			options->difference = argv[++i];
		else if (!strcmp(argv[i], "--mean") && i + 1 < argc)
			options->side = atoi(argv[++i]);
		else if (argv[i][0] != '-' && paths < 2)
			options->path[paths++] = argv[i];
		else
			return false;
	}
	return paths == 2 && options->side > 0;
}

int main(int argc, char **argv)
{
	struct options options = {.side = 1};
	struct image picture[2] = {{0}, {0}};
	struct fault fault = {0};
	int err = 0;

	if (!parse(&options, argc, argv)) {
		fprintf(stderr,
			"usage: compare A B [--difference OUT.png] [--mirror] [--mean SIDE]\n");
		return 2;
	}
	for (int k = 0; k < 2 && !err; k++)
		err = image_read(options.path[k], &picture[k], &fault);
	if (!err)
		err = compare(&options, picture, &fault);
	for (int k = 0; k < 2; k++)
		image_free(&picture[k]);
	if (err) {
		fprintf(stderr, "compare: %s\n", fault.text);
		return 1;
	}
	return 0;
}
