/* SPDX-License-Identifier: MIT */
/*
 * The unified camera of Mei and Rives (Kalibr's omni) as a polynomial fisheye. A ray at theta from
 * the axis is seen at
 *     m = sin(theta) / (cos(theta) + xi)
 * in focal lengths before lens_bend() distorts it.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/convert/convert.h"
#include "bake/calibrate/estimate/linear.h"

enum {
	SPOKES = 24,
	STEPS = 60,
	ROWS = 2 * SPOKES * STEPS,
	OMNI_RADIAL = FISHEYE_TERMS + 1, /* theta, theta^3, ... */
	OMNI_UNKNOWNS = OMNI_RADIAL + 2	 /* and the centre */
};

#define MOST_RAD (M_PI / 2)

/* A direction and its place, in focal lengths from the centre. */
struct omni_sample {
	double theta, spoke[2], place[2];
};

/* Samples the lens along spokes as far as the picture and its rise go. Returns how many. */
static int take_samples(const struct lens *lens, struct omni_sample *sample)
{
	int count = 0;

	for (int a = 0; a < SPOKES; a++) {
		const double angle = 2 * M_PI * a / SPOKES;
		double before = 0;

		for (int k = 1; k <= STEPS; k++) {
			struct omni_sample *s = &sample[count];
			const double theta = MOST_RAD * k / STEPS;
			const double m = sin(theta) / (cos(theta) + lens->xi);
			const double straight[2] = {m * cos(angle), m * sin(angle)};
			double px[2];

			*s = (struct omni_sample){.theta = theta,
						  .spoke = {cos(angle), sin(angle)}};
			if (!isfinite(m))
				break;
			lens_bend(lens, straight, s->place);
			for (int i = 0; i < 2; i++)
				px[i] = lens->centre_px[i] + lens->focal_px[i] * s->place[i];
			if (!(hypot(s->place[0], s->place[1]) > before) || px[0] < 0 || px[1] < 0 ||
			    px[0] > lens->width || px[1] > lens->height)
				break;
			before = hypot(s->place[0], s->place[1]);
			count++;
		}
	}
	return count;
}

/* Least squares of place = centre + spoke (a0 theta + a1 theta^3 + ...), linear in all of them.
 * Returns the largest error, px. */
static double fit_samples(const struct lens *lens, const struct omni_sample *sample, int count,
			  double room[], double found[OMNI_UNKNOWNS])
{
	double worst = 0;

	memset(room, 0, (OMNI_UNKNOWNS + 1) * ROWS * sizeof(*room));
	for (int n = 0; n < 2 * count; n++) {
		const struct omni_sample *s = &sample[n / 2];

		for (int t = 0; t < OMNI_RADIAL; t++)
			room[t * ROWS + n] = s->spoke[n % 2] * pow(s->theta, 1 + 2 * t);
		room[(OMNI_RADIAL + n % 2) * ROWS + n] = 1;
		room[OMNI_UNKNOWNS * ROWS + n] = s->place[n % 2];
	}
	linear_solve(room, ROWS, OMNI_UNKNOWNS, found);
	for (int n = 0; n < count; n++) {
		double r = 0, off[2];

		for (int t = 0; t < OMNI_RADIAL; t++)
			r += found[t] * pow(sample[n].theta, 1 + 2 * t);
		for (int i = 0; i < 2; i++)
			off[i] = lens->focal_px[i] * (found[OMNI_RADIAL + i] +
						      sample[n].spoke[i] * r - sample[n].place[i]);
		worst = fmax(worst, hypot(off[0], off[1]));
	}
	return worst;
}

int lens_of_omni(struct lens *lens, double tolerance_px, double *error_px, struct fault *fault)
{
	struct omni_sample *sample = malloc((size_t)SPOKES * STEPS * sizeof(*sample));
	double *room = malloc((size_t)(OMNI_UNKNOWNS + 1) * ROWS * sizeof(*room));
	double found[OMNI_UNKNOWNS];
	int count, err = -ENOMEM;

	*error_px = INFINITY;
	if (sample && room) {
		count = take_samples(lens, sample);
		if (count > OMNI_UNKNOWNS)
			*error_px = fit_samples(lens, sample, count, room, found);
		err = 0;
	}
	free(sample);
	free(room);
	if (err)
		return fault_say(fault, err, "not enough memory");
	if (!(*error_px <= tolerance_px) || !(found[0] > 0))
		return fault_say(
			fault, -ERANGE,
			"the polynomial meets this omni camera to %.3g px only, expected at most %.3g; allow more by --tolerance",
			*error_px, tolerance_px);
	lens->fisheye = true;
	lens->omni = false;
	memset(lens->term, 0, sizeof(lens->term));
	for (int t = 0; t < FISHEYE_TERMS; t++)
		lens->term[t] = found[1 + t] / found[0];
	for (int i = 0; i < 2; i++) {
		lens->centre_px[i] += lens->focal_px[i] * found[OMNI_RADIAL + i];
		lens->focal_px[i] *= found[0];
	}
	return 0;
}
