/* SPDX-License-Identifier: MIT */
/* Conversion of the pinhole camera of OpenCV and ROS to Tsai's camera. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/convert/convert.h"
#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

#define SENSOR_MM 36.0 /* width, as in tsai_look_at() */
#define SPOKES 32      /* lines from the centre outwards along which a lens is sampled */
#define STEPS 120
#define EDGE_HALVINGS 20
#define FAR 20.0 /* tangent of the largest angle sampled */

/* A direction, in focal lengths from the axis, and its place in the picture. */
struct tsai_sample {
	double straight[2], px[2];
};

static bool in_picture(const struct lens *lens, const double px[2])
{
	return px[0] >= 0 && px[1] >= 0 && px[0] <= lens->width && px[1] <= lens->height;
}

/* Samples one direction. False: it is not in the picture, or folds over: it is no farther out than
 * *before. */
static bool take_sample(const struct lens *lens, double angle, double r, double *before,
			struct tsai_sample *s)
{
	double bent[2], length;

	s->straight[0] = r * cos(angle);
	s->straight[1] = r * sin(angle);
	lens_bend(lens, s->straight, bent);
	for (int i = 0; i < 2; i++)
		s->px[i] = lens->centre_px[i] + lens->focal_px[i] * bent[i];
	length = hypot(bent[0], bent[1]);
	if (!(length > *before) || !in_picture(lens, s->px))
		return false;
	*before = length;
	return true;
}

/* Angle of a spoke; the last four go to the corners, where a fit is worst. */
static double spoke_angle(const struct lens *lens, int spoke)
{
	const int corner = spoke - SPOKES;

	if (corner < 0)
		return 2 * M_PI * spoke / SPOKES;
	return atan2((corner / 2 * lens->height - lens->centre_px[1]) / lens->focal_px[1],
		     (corner % 2 * lens->width - lens->centre_px[0]) / lens->focal_px[0]);
}

/* Samples the lens along each spoke, as far as the picture goes and the lens does not fold over.
 * Returns how many. */
static int take_samples(const struct lens *lens, struct tsai_sample *sample)
{
	const double reach = fmin(2 * hypot(lens->width, lens->height) /
					  fmin(lens->focal_px[0], lens->focal_px[1]),
				  FAR);
	int count = 0;

	for (int spoke = 0; spoke < SPOKES + 4; spoke++) {
		const double angle = spoke_angle(lens, spoke);
		double before = 0, low = 0, step = reach / STEPS;

		while (low < reach &&
		       take_sample(lens, angle, low + step, &before, &sample[count])) {
			low += step;
			count++;
		}
		/* the last sample lies at the edge */
		for (int k = 0; k < EDGE_HALVINGS; k++) {
			step /= 2;
			if (take_sample(lens, angle, low + step, &before, &sample[count]))
				low += step;
		}
		before = 0;
		count += low > 0 && take_sample(lens, angle, low, &before, &sample[count]);
	}
	return count;
}

/* ---- the fit ---- */

enum {
	FIT_FOCAL_X, /* px */
	FIT_FOCAL_Y,
	FIT_CENTRE_X,
	FIT_CENTRE_Y,
	FIT_KAPPA, /* in units of the focal length, as are the next two and q */
	FIT_TANGENTIAL = FIT_KAPPA + DISTORTION_RADIAL,
	FIT_TURN = FIT_TANGENTIAL + 2,
	FIT_UNKNOWNS = FIT_TURN + 3
};

struct tsai_fit {
	const struct lens *lens;
	const struct tsai_sample *sample;
	int count;
	enum tsai_distortion direction;
};

static void put_camera(const struct tsai_fit *fit, const double *x, struct tsai_camera *camera)
{
	const struct lens *lens = fit->lens;
	double slope[3][9];

	*camera = (struct tsai_camera){
		.width = lens->width,
		.height = lens->height,
		.distortion = (int)fit->direction,
		.centre_px = {x[FIT_CENTRE_X], lens->height - x[FIT_CENTRE_Y]},
		.aspect = x[FIT_FOCAL_X] / x[FIT_FOCAL_Y],
	};
	camera->pixel[0] = camera->pixel[1] = SENSOR_MM / lens->width;
	camera->focal = x[FIT_FOCAL_Y] * camera->pixel[1];
	camera->kappa1 = x[FIT_KAPPA] / (camera->focal * camera->focal);
	camera->kappa2 = x[FIT_KAPPA + 1] / pow(camera->focal, 4);
	camera->kappa3 = x[FIT_KAPPA + 2] / pow(camera->focal, 6);
	for (int i = 0; i < 2; i++)
		camera->tangential[i] = x[FIT_TANGENTIAL + i] / camera->focal;
	rotation_from_vector(x + FIT_TURN, camera->rotation, slope);
}

static bool fit_evaluate(void *context, const double *x, double *residual)
{
	const struct tsai_fit *fit = context;
	struct tsai_camera camera;

	if (!(x[FIT_FOCAL_X] > 0) || !(x[FIT_FOCAL_Y] > 0))
		return false;
	put_camera(fit, x, &camera);
	for (int k = 0; k < fit->count; k++) {
		const struct tsai_sample *s = &fit->sample[k];
		const double world[3] = {s->straight[0], s->straight[1], 1};
		double px[2];

		if (tsai_project(&camera, world, px))
			return false;
		residual[2 * k] = px[0] - s->px[0];
		residual[2 * k + 1] = px[1] - s->px[1];
	}
	return true;
}

/* First guess: their lens without distortion, which shows every direction. */
static void first_guess(const struct lens *lens, double *x)
{
	memset(x, 0, FIT_UNKNOWNS * sizeof(*x));
	x[FIT_FOCAL_X] = lens->focal_px[0];
	x[FIT_FOCAL_Y] = lens->focal_px[1];
	x[FIT_CENTRE_X] = lens->centre_px[0];
	x[FIT_CENTRE_Y] = lens->centre_px[1];
}

/* Largest distance between both cameras, px. */
static double worst_px(const struct least_squares_fit *found, int count)
{
	double most = 0;

	for (int k = 0; k < count; k++)
		most = fmax(most, hypot(found->residual[2 * k], found->residual[2 * k + 1]));
	return most;
}

static int fit_direction(const struct tsai_fit *fit, double *x, double *error_px)
{
	static const double scale[FIT_UNKNOWNS] = {1,	 1,    1,    1,	   0.01, 0.01,
						   0.01, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
	/* a lens without tangential terms needs none: a turn would do as well */
	const bool straight = fit->lens->term[LENS_P1] == 0 && fit->lens->term[LENS_P2] == 0;
	const bool fixed[FIT_UNKNOWNS] = {[FIT_TANGENTIAL] = straight,
					  [FIT_TANGENTIAL + 1] = straight};
	const struct least_squares problem = {.parameters = FIT_UNKNOWNS,
					      .fixed = fixed,
					      .residuals = 2 * fit->count,
					      .evaluate = fit_evaluate,
					      .context = (void *)fit,
					      .scale = scale,
					      .group = 2};
	struct least_squares_fit found = {.freedom = 0};
	int err;

	first_guess(fit->lens, x);
	err = least_squares_solve(&problem, x, &found, NULL);
	*error_px = err && err != -ETIMEDOUT ? INFINITY : worst_px(&found, fit->count);
	least_squares_free(&found);
	return err == -ENOMEM ? err : 0;
}

static int fit_camera(const struct lens *lens, struct tsai_camera *camera, double *error_px,
		      double *turn_deg)
{
	struct tsai_sample *sample = malloc((size_t)(SPOKES + 4) * (STEPS + 2) * sizeof(*sample));
	struct tsai_fit fit = {.lens = lens, .sample = sample};
	int err = sample ? 0 : -ENOMEM;

	*error_px = INFINITY;
	if (sample)
		fit.count = take_samples(lens, sample);
	for (int direction = TSAI_DISTORTS; direction <= TSAI_UNDISTORTS && !err; direction++) {
		double x[FIT_UNKNOWNS], error;

		fit.direction = (enum tsai_distortion)direction;
		err = fit_direction(&fit, x, &error);
		if (err || !(error < *error_px))
			continue;
		*error_px = error;
		*turn_deg = vec_length(x + FIT_TURN) * (180 / M_PI);
		memset(x + FIT_TURN, 0, 3 * sizeof(*x));
		put_camera(&fit, x, camera);
	}
	free(sample);
	return err;
}

/* ---- cameras ---- */

/* Whether their camera is ours in the thesis's direction. */
static bool is_polynomial(const struct lens *lens)
{
	return lens->term[LENS_K4] == 0 && lens->term[LENS_K5] == 0 && lens->term[LENS_K6] == 0;
}

int lens_to_tsai(const struct lens *lens, struct tsai_camera *camera, double tolerance_px,
		 double *error_px, double *turn_deg, struct fault *fault)
{
	const struct tsai_fit same = {.lens = lens, .direction = TSAI_DISTORTS};
	double x[FIT_UNKNOWNS];
	int err = 0;

	*error_px = *turn_deg = 0;
	if (lens->fisheye)
		return fault_say(fault, -EINVAL, "a fisheye, expected a pinhole camera");
	if (is_polynomial(lens)) {
		first_guess(lens, x);
		x[FIT_KAPPA] = lens->term[LENS_K1];
		x[FIT_KAPPA + 1] = lens->term[LENS_K2];
		x[FIT_KAPPA + 2] = lens->term[LENS_K3];
		x[FIT_TANGENTIAL] = lens->term[LENS_P2];
		x[FIT_TANGENTIAL + 1] = lens->term[LENS_P1];
		put_camera(&same, x, camera);
	} else {
		err = fit_camera(lens, camera, error_px, turn_deg);
	}
	if (err)
		return fault_say(fault, err, "not enough memory");
	if (!(*error_px <= tolerance_px))
		return fault_say(
			fault, -ERANGE,
			"its distortion is more than three kappas can say, which would be off by %.3g px, expected at most %.3g; allow more by --tolerance, or calibrate anew",
			*error_px, tolerance_px);
	return tsai_check(camera, fault);
}
