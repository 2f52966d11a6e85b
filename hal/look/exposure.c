/* SPDX-License-Identifier: MIT */
#include "hal/look/exposure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/look/median.h"

enum { POINTS = 2048, ENOUGH = POINTS / 16, START_FRAMES = 25, MOMENTS = 6, STATE = 1 + MOMENTS };

/* Code values between which a pixel counts. */
#define DARKEST 12
#define BRIGHTEST 249
#define LIGHT_LEAST 1e-4 /* irradiance below which there is nothing to compare with */

/* Standard deviations: of y in a frame; of ln gain from frame to frame; of b before anything is
 * learned, and from frame to frame. */
#define MEASURED 0.004
#define WANDERING 2e-4
#define UNKNOWN 0.3
#define FORGOTTEN 1e-5
#define JUMP 4.0 /* standard deviations of y beyond which the camera has changed */
#define SWITCHED                                                                                   \
	0.05 /* change of ln E between frames that is a lamp's, and not the time for that */

struct exposure_filter {
	double x[STATE]; /* ln gain, b */
	double covariance[STATE][STATE];
};

struct exposure {
	const struct dome *dome;
	float decode[256];
	struct {
		int x, y;
		float start[3]; /* mean linear light of the first frames, R, G, B */
		int seen[3];	/* of them, those in which it counted */
	} point[POINTS];
	int frames;
	/* Means over the first frames: of ln E, and of the moments. */
	double light[3], moment[3][MOMENTS];
	double last[3];	    /* ln E of the frame before */
	double expected[3]; /* ln of B / B_start */
	struct exposure_filter filter[3];
};

int exposure_create(struct exposure **exposure, int width, int height,
		    const struct transfer_curve *curve, const struct dome *dome)
{
	struct exposure *e = calloc(1, sizeof(*e));

	if (!e)
		return -ENOMEM;
	e->dome = dome;
	for (int i = 0; i < 256; i++)
		e->decode[i] = (float)transfer_curve_decode(curve, i / 255.0);
	/* A sequence of low discrepancy: multiples of the plastic number's powers (Roberts 2018). */
	for (int i = 0; i < POINTS; i++) {
		e->point[i].x = (int)(fmod(0.5 + i * 0.7548776662466927, 1) * width);
		e->point[i].y = (int)(fmod(0.5 + i * 0.5698402909980532, 1) * height);
	}
	for (int c = 0; c < 3; c++)
		for (int k = 1; k < STATE; k++)
			e->filter[c].covariance[k][k] = UNKNOWN * UNKNOWN;
	*exposure = e;
	return 0;
}

void exposure_destroy(struct exposure *exposure)
{
	free(exposure);
}

/* ln E of a channel, and moments of its light over the sky, which do not depend on its strength.
 * False: it is dark. */
static bool sky_moments(const struct dome *dome, const float (*radiance)[3], int c, double *light,
			double moment[MOMENTS])
{
	double sum = 0, of[MOMENTS] = {0};

	for (int i = 0; i < dome->count; i++) {
		const double *d = dome->direction[i];
		const double sent = dome->solid_angle_sr[i] * (double)radiance[i][c];
		const double e = sent * fmax(d[2], 0);

		sum += e;
		of[0] += e * d[0];
		of[1] += e * d[1];
		of[2] += e * d[2];
		of[3] += e * (d[0] * d[0] - d[1] * d[1]);
		of[4] += e * d[0] * d[1];
		of[5] += sent / 2;
	}
	if (!(sum > LIGHT_LEAST))
		return false;
	*light = log(sum);
	for (int k = 0; k < MOMENTS; k++)
		moment[k] = of[k] / sum;
	return true;
}

/* Linear light of a point; 0: it does not count. */
static float point_light(const struct exposure *e, int point, int c, const struct picture *picture)
{
	const int code = picture->origin[e->point[point].y * picture->y_step +
					 e->point[point].x * picture->x_step + 2 - c];

	return code < DARKEST || code > BRIGHTEST ? 0 : e->decode[code];
}

static void start_channel(struct exposure *e, int c, const struct picture *picture, double light,
			  const double moment[MOMENTS])
{
	const double share = 1.0 / (e->frames + 1);

	for (int i = 0; i < POINTS; i++) {
		const float seen = point_light(e, i, c, picture);

		if (!(seen > 0))
			continue;
		e->point[i].seen[c]++;
		e->point[i].start[c] += (seen - e->point[i].start[c]) / (float)e->point[i].seen[c];
	}
	e->light[c] += share * (light - e->light[c]);
	for (int k = 0; k < MOMENTS; k++)
		e->moment[c][k] += share * (moment[k] - e->moment[c][k]);
}

/* Median of B / B_start; 0: too few pixels tell it. */
static double seen_ratio(const struct exposure *e, int c, const struct picture *picture)
{
	float ratio[POINTS];
	int count = 0;

	for (int i = 0; i < POINTS; i++) {
		const float seen = point_light(e, i, c, picture);

		if (e->point[i].seen[c] >= START_FRAMES / 2 && seen > 0)
			ratio[count++] = seen / e->point[i].start[c];
	}
	return count < ENOUGH ? 0 : (double)select_median(ratio, count);
}

/* One step of the filter: y = h . x + noise. jumps: the gain may have jumped. */
static void filter_take(struct exposure_filter *f, const double h[STATE], double y, bool jumps)
{
	double gain[STATE], off = y, variance = MEASURED * MEASURED;

	f->covariance[0][0] += WANDERING * WANDERING;
	for (int k = 1; k < STATE; k++)
		f->covariance[k][k] += FORGOTTEN * FORGOTTEN;
	for (int j = 0; j < STATE; j++) {
		gain[j] = 0;
		for (int k = 0; k < STATE; k++)
			gain[j] += f->covariance[j][k] * h[k];
		variance += h[j] * gain[j];
		off -= h[j] * f->x[j];
	}
	if (jumps && off * off > JUMP * JUMP * variance) {
		f->covariance[0][0] += off * off;
		gain[0] += off * off;
		variance += off * off;
	}
	for (int j = 0; j < STATE; j++) {
		f->x[j] += gain[j] / variance * off;
		for (int k = 0; k < STATE; k++)
			f->covariance[j][k] -= gain[j] * gain[k] / variance;
	}
}

static void look_channel(struct exposure *e, int c, const struct picture *picture, double light,
			 const double moment[MOMENTS])
{
	const double ratio = seen_ratio(e, c, picture);
	double h[STATE] = {1};

	for (int k = 0; k < MOMENTS; k++)
		h[1 + k] = moment[k] - e->moment[c][k];
	if (ratio > 0)
		filter_take(&e->filter[c], h, log(ratio) - (light - e->light[c]),
			    fabs(light - e->last[c]) < SWITCHED);
	e->expected[c] = light - e->light[c];
	for (int k = 0; k < STATE; k++)
		e->expected[c] += h[k] * e->filter[c].x[k];
}

void exposure_look(struct exposure *e, const struct picture *background, const float (*radiance)[3])
{
	double light[3], moment[3][MOMENTS];

	for (int c = 0; c < 3; c++)
		if (!sky_moments(e->dome, radiance, c, &light[c], moment[c]))
			return;
	for (int c = 0; c < 3; c++) {
		if (e->frames < START_FRAMES)
			start_channel(e, c, background, light[c], moment[c]);
		else
			look_channel(e, c, background, light[c], moment[c]);
		e->last[c] = light[c];
	}
	e->frames += e->frames < START_FRAMES;
}

void exposure_expected(const struct exposure *e, float ratio[3])
{
	for (int c = 0; c < 3; c++)
		ratio[c] = (float)fmax(nearbyint(exp(e->expected[c]) * 0x1p20) * 0x1p-20, 0x1p-20);
}

void exposure_gain(const struct exposure *e, double gain[3])
{
	for (int c = 0; c < 3; c++)
		gain[c] = exp(e->filter[c].x[0]);
}
