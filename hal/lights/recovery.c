/* SPDX-License-Identifier: MIT */
#include "hal/lights/recovery.h"

#include <math.h>

#define CLIPPED 0.001 /* share of a patch's pixels that noise alone may clip */

struct light_ground light_ground_see(const struct frame_reader *picture, int x, int y, int width,
				     int height, const float decode[256], uint32_t *row)
{
	struct light_ground ground = {.clipped = 0};
	const double pixels = (double)width * height;

	for (int down = 0; down < height; down++) {
		const uint32_t *bgrx = frame_reader_row(picture, x, y + down, width, row);

		for (int i = 0; i < width; i++) {
			const uint32_t code[3] = {bgrx[i] >> 16 & 255, bgrx[i] >> 8 & 255,
						  bgrx[i] & 255};

			for (int c = 0; c < 3; c++)
				ground.radiance[c] += (double)decode[code[c]];
			ground.clipped += code[0] == 255 || code[1] == 255 || code[2] == 255;
		}
	}
	for (int c = 0; c < 3; c++)
		ground.radiance[c] /= pixels;
	ground.clipped /= pixels;
	return ground;
}

/* D' of recovery.h: the missing radiance, reduced near the uncertainty. */
static double ground_missing(double seen, double known)
{
	const double d = seen - known, unsure = LIGHT_RECOVERY_UNSURE * seen;

	return d > 0 ? d * d * d / (d * d + unsure * unsure) : 0;
}

/* Relative radiance expected of a light's clipped pixels: (u / w) / (A + SMALL_SR). */
static double pixel_brightness(const struct light_clipping *k, int i, int c)
{
	return k->term[c][i] / (k->solid_angle_sr[i] * (k->piece_sr[i] + LIGHT_RECOVERY_SMALL_SR));
}

/* Estimated share of a light that is clipped in one channel: q min(1, L / (q white))^8. */
static double clipped_in(const struct light_clipping *k, int i, double radiance)
{
	const double q = (double)k->clipped[i], full = fmin(radiance / (q * k->white), 1);
	const double squared = full * full, fourth = squared * squared;

	return q * fourth * fourth;
}

/* Recovers one channel; returns its factor. */
static double recover_channel(const struct light_ground *ground, const struct light_clipping *k,
			      int c, float (*radiance)[3], struct light_recovery *r)
{
	double known = 0, reach = 0, brightest = 0, x, most;

	for (int i = 0; i < k->lights; i++) {
		known += k->term[c][i] * (double)radiance[i][c];
		if (!(k->clipped[i] > 0))
			continue;
		reach += k->term[c][i] * pixel_brightness(k, i, c) *
			 clipped_in(k, i, (double)radiance[i][c]);
		brightest = fmax(brightest, pixel_brightness(k, i, c));
	}
	x = reach > 0 ? ground_missing(ground->radiance[c], known) / reach : 0;
	if (!(x > 0))
		return 1;
	most = (LIGHT_RECOVERY_MAX - 1) * k->white / brightest;
	r->recovered = true;
	r->at_bound |= x > most || ground->clipped > CLIPPED;
	x = fmin(x, most);
	for (int i = 0; i < k->lights; i++)
		if (k->clipped[i] > 0)
			radiance[i][c] += (float)(x * pixel_brightness(k, i, c) *
						  clipped_in(k, i, (double)radiance[i][c]));
	return 1 + x * brightest / k->white;
}

struct light_recovery light_recover(const struct light_ground *ground,
				    const struct light_clipping *clipping, float (*radiance)[3])
{
	struct light_recovery r = {.recovered = false};

	for (int c = 0; c < 3; c++)
		r.factor[c] = recover_channel(ground, clipping, c, radiance, &r);
	return r;
}
