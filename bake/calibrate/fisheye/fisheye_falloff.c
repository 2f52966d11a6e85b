/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_falloff.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "hal/colour/transfer.h"
#include "hal/optics/vec.h"

enum { RINGS = 40, SECTORS = 24, BINS = RINGS * SECTORS };
enum { LEVEL, TERMS, NUMBERS = TERMS + FISHEYE_FALLOFF_TERMS };

#define PIXELS_LEAST 6	/* fewest pixels of a bin */
#define BINS_LEAST 100	/* fewest bins */
#define RIM_SHARE 0.985 /* of the field: beyond, pixels are partly outside of the circle */
#define WHITE 250
#define DARK 0.005 /* least mean light, white being 1 */
#define SPREAD_MOST 0.05
#define OUTLIERS_MOST 0.3
#define OUTLIER_WEIGHT 0.1
#define LOSS_SCALE 3.0

struct bin {
	double light, square; /* sums, later means, of light and of theta^2 */
	int pixels, clipped;
};

struct bins {
	struct bin bin[BINS];
	int count;
};

static void bins_add_pixel(struct bins *bins, const struct fisheye *lens,
			   const struct image *picture, const double decode[256], int x, int y)
{
	const double px[2] = {x + 0.5, y + 0.5};
	const size_t at = 3 * ((size_t)y * (size_t)picture->width + (size_t)x);
	double dir[3], c[3], theta, phi, light = 0;
	bool clipped = false;
	struct bin *bin;

	if (!fisheye_ray(lens, px, dir))
		return;
	mat_apply(lens->rotation, dir, c);
	theta = atan2(hypot(c[0], c[1]), c[2]);
	phi = (atan2(c[1], c[0]) + M_PI) / (2 * M_PI);
	if (theta > RIM_SHARE * lens->field_rad)
		return;
	bin = &bins->bin[(int)(theta / lens->field_rad * RINGS) * SECTORS +
			 (int)(phi * SECTORS) % SECTORS];
	for (size_t k = 0; k < 3; k++) {
		light += picture->u8 ? decode[picture->u8[at + k]] : (double)picture->f32[at + k];
		clipped |= picture->u8 && picture->u8[at + k] > WHITE;
	}
	bin->light += light / 3;
	bin->square += theta * theta;
	bin->pixels++;
	bin->clipped += clipped;
}

/* Turns sums into means and drops empty and clipped bins. Returns the share of clipped bins. */
static double bins_settle(struct bins *bins)
{
	int clipped = 0, all = 0;

	for (int k = 0; k < BINS; k++) {
		struct bin bin = bins->bin[k];

		if (bin.pixels < PIXELS_LEAST)
			continue;
		all++;
		clipped += bin.clipped > 0;
		if (bin.clipped)
			continue;
		bin.light /= bin.pixels;
		bin.square /= bin.pixels;
		bins->bin[bins->count++] = bin;
	}
	return all ? (double)clipped / all : 0;
}

static bool falloff_evaluate(void *context, const double *x, double *residual)
{
	const struct bins *bins = context;

	for (int k = 0; k < bins->count; k++) {
		const double u = bins->bin[k].square;

		residual[k] = x[LEVEL] *
				      (1 + u * (x[TERMS] + u * (x[TERMS + 1] + u * x[TERMS + 2]))) -
			      bins->bin[k].light;
	}
	return x[LEVEL] > 0;
}

static int falloff_fit(struct falloff *falloff, struct bins *bins, double x[NUMBERS],
		       struct least_squares_fit *found, struct fault *fault)
{
	const double scale[NUMBERS] = {0.1 * x[LEVEL], 0.1, 0.1, 0.1};
	const struct least_squares problem = {
		.parameters = NUMBERS,
		.residuals = bins->count,
		.evaluate = falloff_evaluate,
		.context = bins,
		.scale = scale,
		.loss_scale = LOSS_SCALE,
		.group = 1,
	};
	const int err = least_squares_solve(&problem, x, found, fault);
	int outliers = 0;

	if (err)
		return err;
	for (int k = 0; k < FISHEYE_FALLOFF_TERMS; k++) {
		falloff->v[k] = x[TERMS + k];
		falloff->deviation[k] = sqrt(found->covariance[(TERMS + k) * NUMBERS + TERMS + k]);
	}
	falloff->spread = found->sigma / x[LEVEL];
	for (int k = 0; k < bins->count; k++)
		outliers += found->weight[k] < OUTLIER_WEIGHT;
	if (falloff->spread > SPREAD_MOST || outliers > OUTLIERS_MOST * bins->count)
		verdict_doubt(&falloff->verdict,
			      "use a white diffuser on the lens, or an evenly overcast sky",
			      "the view is not equally bright around the lens's axis");
	return 0;
}

static int falloff_from_picture(struct falloff *falloff, struct bins *bins,
				const struct fisheye *lens, const struct fisheye_settings *settings,
				struct fault *fault)
{
	const double u = lens->field_rad * lens->field_rad, clipped = bins_settle(bins);
	struct least_squares_fit found = {.covariance = NULL};
	struct fisheye_settings with = *settings;
	double x[NUMBERS] = {0};
	struct fisheye made;
	int err;

	if (clipped > 0.2)
		verdict_doubt(&falloff->verdict, "expose less",
			      "the picture of the uniform view is over-exposed");
	for (int k = 0; k < bins->count; k++)
		x[LEVEL] += bins->bin[k].light / bins->count;
	if (bins->count < BINS_LEAST || !(x[LEVEL] > DARK)) {
		verdict_doubt(&falloff->verdict,
			      "take one of a white diffuser on the lens, well exposed",
			      "the picture shows no uniform view");
		return 0;
	}
	err = falloff_fit(falloff, bins, x, &found, fault);
	least_squares_free(&found);
	if (err)
		return err;
	falloff->rim = 1 + u * (falloff->v[0] + u * (falloff->v[1] + u * falloff->v[2]));
	memcpy(with.falloff, falloff->v, sizeof(with.falloff));
	if (fisheye_prepare(&made, &with, 64, 64, fault))
		verdict_doubt(&falloff->verdict, "take a picture with light out to the rim", "%s",
			      fault->text);
	return 0;
}

int falloff_find(struct falloff *falloff, const struct image *picture,
		 const struct fisheye_settings *settings, struct fault *fault)
{
	struct bins *bins = calloc(1, sizeof(*bins));
	double decode[256];
	struct fisheye lens;
	int err;

	*falloff = (struct falloff){.rim = 1};
	verdict_begin(&falloff->verdict);
	if (!bins)
		return fault_say(fault, -ENOMEM, "falloff: out of memory");
	err = fisheye_prepare(&lens, settings, picture->width, picture->height, fault);
	for (int code = 0; code < 256; code++)
		decode[code] = transfer_decode(TRANSFER_SRGB, code / 255.0);
	for (int y = 0; !err && y < picture->height; y++)
		for (int x = 0; x < picture->width; x++)
			bins_add_pixel(bins, &lens, picture, decode, x, y);
	if (!err)
		err = falloff_from_picture(falloff, bins, &lens, settings, fault);
	free(bins);
	return err;
}
