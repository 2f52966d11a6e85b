/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_black.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>

#define PARTS 8
#define DARK_MOST 64 /* largest plausible black level, code */

static int check_black_picture(const struct image *picture, struct fault *fault)
{
	if (!picture->u8)
		return fault_say(fault, -EINVAL,
				 "the picture holds linear light, expected an 8-bit picture");
	if (picture->width < 64 || picture->height < 64)
		return fault_say(fault, -EINVAL,
				 "the picture is %dx%d pixels, expected at least 64x64",
				 picture->width, picture->height);
	return 0;
}

/* Returns the mean over a rectangle, of one channel or, for channel -1, of all; and the mean
 * square. */
static double mean_of_rectangle(const struct image *p, int x0, int y0, int width, int height,
				int channel, double *square)
{
	double sum = 0, squares = 0;
	int count = 0;

	for (int y = y0; y < y0 + height; y++)
		for (int x = x0; x < x0 + width; x++)
			for (int c = 0; c < 3; c++) {
				const double code =
					p->u8[3 * ((size_t)y * (size_t)p->width + (size_t)x) +
					      (size_t)c];

				if (channel >= 0 && c != channel)
					continue;
				sum += code;
				squares += code * code;
				count++;
			}
	*square = squares / count;
	return sum / count;
}

/* Estimates the deviation of the mean from how the parts of the picture differ, which holds for any
 * kind of noise. */
static void measure_parts(struct light_black *b, const struct image *p)
{
	const int width = p->width / PARTS, height = p->height / PARTS;
	double sum = 0, squares = 0, unused;

	b->lightest = 0;
	for (int k = 0; k < PARTS * PARTS; k++) {
		const double mean = mean_of_rectangle(p, k % PARTS * width, k / PARTS * height,
						      width, height, -1, &unused);

		sum += mean;
		squares += mean * mean;
		b->lightest = fmax(b->lightest, mean);
	}
	sum /= PARTS * PARTS;
	b->deviation = sqrt(fmax(squares / (PARTS * PARTS) - sum * sum, 0) / (PARTS * PARTS - 1));
}

/* A camera that clips noise at the black level shows that code and some above it. Share of pixels
 * at the lowest code from which it is taken as the level. */
#define CUT_OFF 0.4

static bool is_cut_off(const struct image *p, int *lowest)
{
	const int count = 3 * p->width * p->height;
	int codes[256] = {0};

	for (int k = 0; k < count; k++)
		codes[p->u8[k]]++;
	*lowest = 0;
	while (!codes[*lowest])
		++*lowest;
	return codes[*lowest] > CUT_OFF * count;
}

int light_black_covered(struct light_black *b, const struct image *p, struct fault *fault)
{
	const int err = check_black_picture(p, fault);
	double square;
	int lowest;

	if (err)
		return err;
	*b = (struct light_black){.level = 0};
	verdict_begin(&b->verdict);
	b->level = mean_of_rectangle(p, 0, 0, p->width, p->height, -1, &square);
	b->noise = sqrt(fmax(square - b->level * b->level, 0));
	for (int c = 0; c < 3; c++)
		b->channel[c] = mean_of_rectangle(p, 0, 0, p->width, p->height, c, &square);
	measure_parts(b, p);
	if (b->level > DARK_MOST)
		verdict_doubt(&b->verdict, "cover the lens",
			      "the picture's mean is code %.0f: it is not dark", b->level);
	if (b->lightest - b->level > 1.5)
		verdict_doubt(
			&b->verdict, "cover the lens tightly",
			"a part of the picture is %.1f codes lighter than the rest: light falls in",
			b->lightest - b->level);
	if (is_cut_off(p, &lowest)) {
		b->level = lowest;
		b->deviation = sqrt(1.0 / 12); /* error of rounding */
	}
	for (int c = 0; c < 3; c++)
		if (fabs(b->channel[c] - b->level) > 2)
			verdict_doubt(
				&b->verdict,
				"cover the lens tightly, or switch off the camera's white balance",
				"the channels have different black levels");
	return 0;
}
