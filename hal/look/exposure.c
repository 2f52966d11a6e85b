/* SPDX-License-Identifier: MIT */
#include "hal/look/exposure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/look/median.h"

/* The gain is measured at POINTS points, at least POINTS_LEAST of which must be usable. Both, and
 * START_FRAMES (a second at 25 frames a second), were chosen by trial; make look shows their
 * effect. */
enum { POINTS = 2048, POINTS_LEAST = POINTS / 16, START_FRAMES = 25 };
enum { MOMENTS = 6, STATE = 1 + MOMENTS };

/* A pixel is used if its code value lies between these: darker ones are mostly noise, brighter
 * ones may be clipped. They were chosen by trial; make look shows their effect. */
#define DARKEST 12
#define BRIGHTEST 249
/* A channel with less irradiance (white is 1) is skipped: its logarithm would be noise. */
#define LIGHT_LEAST 1e-4

/* Standard deviations of the Kalman filter, chosen by trial; make look shows their effect. */
#define Y_NOISE 0.004	/* error of one measurement of y */
#define GAIN_DRIFT 2e-4 /* change of ln gain from frame to frame */
#define B_START 0.3	/* uncertainty of b before anything is learned */
#define B_DRIFT 1e-5	/* change of b from frame to frame */
#define JUMP 4.0	/* y is this many deviations off: the camera has changed its exposure */
/* Where ln E changes by more than this in one frame, a lamp was switched; y then tells little about
 * the camera, so that its gain may not jump. */
#define LAMP_SWITCHED 0.05

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
		int usable[3];	/* number of first frames in which the point was usable */
	} point[POINTS];
	int frames;
	double light[3], moment[3][MOMENTS]; /* means of ln E and of f over the first frames */
	double last[3];			     /* ln E of the frame before */
	double expected[3];		     /* ln (B / B_start) that light and gain predict */
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
	/* Multiples of the plastic number's inverse powers are a low-discrepancy sequence, R2 of
	 * Roberts 2018: they cover the picture evenly. */
	for (int i = 0; i < POINTS; i++) {
		e->point[i].x = (int)(fmod(0.5 + i * 0.7548776662466927, 1) * width);
		e->point[i].y = (int)(fmod(0.5 + i * 0.5698402909980532, 1) * height);
	}
	for (int c = 0; c < 3; c++)
		for (int k = 1; k < STATE; k++)
			e->filter[c].covariance[k][k] = B_START * B_START;
	*exposure = e;
	return 0;
}

void exposure_destroy(struct exposure *exposure)
{
	free(exposure);
}

/* Computes ln E and the moments f of one channel's light over the sky. The moments are divided by
 * E, so they do not change with its strength. Returns false if the channel is dark. */
static bool sky_moments(const struct dome *dome, const float (*radiance)[3], int c, double *light,
			double moment[MOMENTS])
{
	double sum = 0, integral[MOMENTS] = {0};

	for (int i = 0; i < dome->count; i++) {
		const double *d = dome->direction[i];
		const double sent = dome->solid_angle_sr[i] * (double)radiance[i][c];
		const double e = sent * fmax(d[2], 0);

		sum += e;
		integral[0] += e * d[0];
		integral[1] += e * d[1];
		integral[2] += e * d[2];
		integral[3] += e * (d[0] * d[0] - d[1] * d[1]);
		integral[4] += e * d[0] * d[1];
		integral[5] += sent / 2;
	}
	if (!(sum > LIGHT_LEAST))
		return false;
	*light = log(sum);
	for (int k = 0; k < MOMENTS; k++)
		moment[k] = integral[k] / sum;
	return true;
}

/* Returns the linear light of a point, or 0 if it is too dark or too bright to be used. */
static float point_light(const struct exposure *e, int point, int c, const struct picture *picture)
{
	const int code = picture->origin[e->point[point].y * picture->y_step +
					 e->point[point].x * picture->x_step + 2 - c];

	return code < DARKEST || code > BRIGHTEST ? 0 : e->decode[code];
}

/* Adds one of the first frames to the means that later frames are compared with. */
static void channel_start(struct exposure *e, int c, const struct picture *picture, double light,
			  const double moment[MOMENTS])
{
	const double share = 1.0 / (e->frames + 1);

	for (int i = 0; i < POINTS; i++) {
		const float b = point_light(e, i, c, picture);

		if (!(b > 0))
			continue;
		e->point[i].usable[c]++;
		e->point[i].start[c] += (b - e->point[i].start[c]) / (float)e->point[i].usable[c];
	}
	e->light[c] += share * (light - e->light[c]);
	for (int k = 0; k < MOMENTS; k++)
		e->moment[c][k] += share * (moment[k] - e->moment[c][k]);
}

/* Returns the median of B / B_start, or 0 if too few points are usable. */
static double median_ratio(const struct exposure *e, int c, const struct picture *picture)
{
	float ratio[POINTS];
	int count = 0;

	for (int i = 0; i < POINTS; i++) {
		const float b = point_light(e, i, c, picture);

		if (e->point[i].usable[c] >= START_FRAMES / 2 && b > 0)
			ratio[count++] = b / e->point[i].start[c];
	}
	return count < POINTS_LEAST ? 0 : (double)select_median(ratio, count);
}

/* Updates the filter by one measurement y = h . x + noise. If may_jump is set and y is far from its
 * prediction, the variance of ln gain is raised first, so that the gain follows within this
 * frame. */
static void filter_update(struct exposure_filter *f, const double h[STATE], double y, bool may_jump)
{
	double gain[STATE], off = y, variance = Y_NOISE * Y_NOISE;

	f->covariance[0][0] += GAIN_DRIFT * GAIN_DRIFT;
	for (int k = 1; k < STATE; k++)
		f->covariance[k][k] += B_DRIFT * B_DRIFT;
	for (int j = 0; j < STATE; j++) {
		gain[j] = 0;
		for (int k = 0; k < STATE; k++)
			gain[j] += f->covariance[j][k] * h[k];
		variance += h[j] * gain[j];
		off -= h[j] * f->x[j];
	}
	if (may_jump && off * off > JUMP * JUMP * variance) {
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

/* Compares a frame with the first ones, and updates the channel's filter and expected ratio. */
static void channel_follow(struct exposure *e, int c, const struct picture *picture, double light,
			   const double moment[MOMENTS])
{
	const double ratio = median_ratio(e, c, picture);
	double h[STATE] = {1};

	for (int k = 0; k < MOMENTS; k++)
		h[1 + k] = moment[k] - e->moment[c][k];
	if (ratio > 0)
		filter_update(&e->filter[c], h, log(ratio) - (light - e->light[c]),
			      fabs(light - e->last[c]) < LAMP_SWITCHED);
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
			channel_start(e, c, background, light[c], moment[c]);
		else
			channel_follow(e, c, background, light[c], moment[c]);
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
