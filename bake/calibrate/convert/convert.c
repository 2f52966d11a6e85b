/* SPDX-License-Identifier: MIT */
/* Conversion of our lenses to those of OpenCV and ROS, and of theirs to ours. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/convert/convert.h"
#include "bake/calibrate/estimate/linear.h"

#define ACROSS 41 /* nodes a side of the grid on which radii are compared */
#define RADII (ACROSS * ACROSS)
#define SENSOR_MM 36.0 /* width, as in tsai_look_at() */
#define FAR 20.0       /* tangent of the largest angle that is looked at */
#define FINE_PX 0.01   /* error above which three more terms are used */

/* ---- their pinhole ---- */

void lens_bend(const struct lens *lens, const double straight[2], double bent[2])
{
	const double *k = lens->term, x = straight[0], y = straight[1], r2 = x * x + y * y;
	const double radial = (1 + r2 * (k[LENS_K1] + r2 * (k[LENS_K2] + r2 * k[LENS_K3]))) /
			      (1 + r2 * (k[LENS_K4] + r2 * (k[LENS_K5] + r2 * k[LENS_K6])));

	bent[0] = x * radial + 2 * k[LENS_P1] * x * y + k[LENS_P2] * (r2 + 2 * x * x);
	bent[1] = y * radial + k[LENS_P1] * (r2 + 2 * y * y) + 2 * k[LENS_P2] * x * y;
}

/* ---- from Tsai's camera ---- */

/* A direction before and after distortion, in units of the focal length. */
struct bend_sample {
	double straight[2], bent[2];
};

/* Samples the picture of Tsai's camera. Returns how many. */
static int sample_bends(const struct lens *lens, const struct tsai_camera *camera,
			struct bend_sample *sample)
{
	struct tsai_camera plain = *camera;
	int count = 0;

	memcpy(plain.rotation, (const double[9]){1, 0, 0, 0, 1, 0, 0, 0, 1},
	       sizeof(plain.rotation));
	for (int n = 0; n < RADII; n++) {
		const double px[2] = {lens->width * (n % ACROSS) / (ACROSS - 1.0),
				      lens->height * (n / ACROSS) / (ACROSS - 1.0)};
		double origin[3], dir[3];

		if (tsai_ray(&plain, px, origin, dir) || !(dir[2] > 0))
			continue;
		for (int i = 0; i < 2; i++) {
			sample[count].straight[i] = dir[i] / dir[2];
			sample[count].bent[i] = (px[i] - lens->centre_px[i]) / lens->focal_px[i];
		}
		count++;
	}
	return count;
}

static double worst_of_bends(const struct lens *lens, const struct bend_sample *sample, int count)
{
	double worst = 0;

	for (int n = 0; n < count; n++) {
		double bent[2];

		lens_bend(lens, sample[n].straight, bent);
		worst = fmax(worst, hypot((bent[0] - sample[n].bent[0]) * lens->focal_px[0],
					  (bent[1] - sample[n].bent[1]) * lens->focal_px[1]));
	}
	return worst;
}

/*
 * Fits k1, k2, k3 and, with terms 6, k4, k5, k6 to the samples' radii. With R after and r before
 * distortion, this equation is linear in all of them:
 *     R (1 + k4 r^2 + ...) = r (1 + k1 r^2 + ...)
 */
static void fit_radial(struct lens *lens, const struct bend_sample *sample, int count, int terms,
		       double room[])
{
	static const int place[] = {LENS_K1, LENS_K2, LENS_K3, LENS_K4, LENS_K5, LENS_K6};
	double k[LENS_TERMS];

	memset(room, 0, (size_t)(terms + 1) * RADII * sizeof(*room));
	for (int n = 0; n < count; n++) {
		const double r = hypot(sample[n].straight[0], sample[n].straight[1]);
		const double bent = hypot(sample[n].bent[0], sample[n].bent[1]);

		for (int t = 0; t < terms; t++)
			room[t * RADII + n] = t < 3 ? pow(r, 3 + 2 * t)
						    : -bent * pow(r, 2 * (t - 2));
		room[terms * RADII + n] = bent - r;
	}
	linear_solve(room, RADII, terms, k);
	for (int t = 0; t < terms; t++)
		lens->term[place[t]] = k[t];
}

/* Fits three terms if they suffice, else six; tangential terms are undone to first order. */
static int bend_as(struct lens *lens, const struct tsai_camera *camera, double tolerance_px,
		   double *error_px)
{
	struct bend_sample *sample = malloc(2 * RADII * sizeof(*sample));
	double *room = malloc((LENS_TERMS + 1) * RADII * sizeof(*room));
	struct tsai_camera round = *camera; /* radii alone determine the radial terms */
	int count, radii, err = -ENOMEM;

	round.tangential[0] = round.tangential[1] = 0;
	if (sample && room) {
		err = 0;
		count = sample_bends(lens, camera, sample);
		radii = sample_bends(lens, &round, sample + RADII);
		lens->term[LENS_P1] = -camera->tangential[1] * camera->focal;
		lens->term[LENS_P2] = -camera->tangential[0] * camera->focal;
		for (int terms = 3; terms <= 6; terms += 3) {
			fit_radial(lens, sample + RADII, radii, terms, room);
			*error_px = worst_of_bends(lens, sample, count);
			if (*error_px <= fmin(tolerance_px, FINE_PX))
				break;
		}
	}
	free(sample);
	free(room);
	return err;
}

static void terms_of_tsai(struct lens *lens, const struct tsai_camera *camera)
{
	lens->term[LENS_K1] = camera->kappa1 * camera->focal * camera->focal;
	lens->term[LENS_K2] = camera->kappa2 * pow(camera->focal, 4);
	lens->term[LENS_K3] = camera->kappa3 * pow(camera->focal, 6);
	lens->term[LENS_P1] = camera->tangential[1] * camera->focal;
	lens->term[LENS_P2] = camera->tangential[0] * camera->focal;
}

int lens_of_tsai(struct lens *lens, const struct tsai_camera *camera, double tolerance_px,
		 double *error_px, struct fault *fault)
{
	struct tsai_camera checked = *camera;
	int err = tsai_check(&checked, fault);

	if (err)
		return err;
	*lens = (struct lens){
		.width = checked.width,
		.height = checked.height,
		.focal_px = {checked.aspect * checked.focal / checked.pixel[0],
			     checked.focal / checked.pixel[1]},
		.centre_px = {checked.centre_px[0], checked.height - checked.centre_px[1]},
	};
	*error_px = 0;
	if (checked.distortion == TSAI_DISTORTS || (checked.kappa1 == 0 && tsai_is_plain(&checked)))
		terms_of_tsai(lens, &checked);
	else
		err = bend_as(lens, &checked, tolerance_px, error_px);
	if (err)
		return fault_say(fault, err, "not enough memory");
	if (!(*error_px <= tolerance_px))
		return fault_say(
			fault, -ERANGE,
			"the distortion undistorts, which k1 to k6 meet to %.3g px only, expected at most %.3g; calibrate with --distortion distorts, or allow more by --tolerance",
			*error_px, tolerance_px);
	return 0;
}

/* Makes the camera at the world's origin that looks along Z, with a sensor 36 mm wide. */
static void put_camera(const struct lens *lens, enum tsai_distortion direction,
		       struct tsai_camera *camera)
{
	*camera = (struct tsai_camera){
		.width = lens->width,
		.height = lens->height,
		.distortion = (int)direction,
		.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
		.centre_px = {lens->centre_px[0], lens->height - lens->centre_px[1]},
		.aspect = lens->focal_px[0] / lens->focal_px[1]};
	camera->pixel[0] = camera->pixel[1] = SENSOR_MM / lens->width;
	camera->focal = lens->focal_px[1] * camera->pixel[1];
	camera->kappa1 = lens->term[LENS_K1] / pow(camera->focal, 2);
	camera->kappa2 = lens->term[LENS_K2] / pow(camera->focal, 4);
	camera->kappa3 = lens->term[LENS_K3] / pow(camera->focal, 6);
	camera->tangential[0] = lens->term[LENS_P2] / camera->focal;
	camera->tangential[1] = lens->term[LENS_P1] / camera->focal;
}

/* The radius before distortion of the farthest corner, or where the lens folds over before. */
static double reach_of(const struct lens *lens)
{
	const double corner[2] = {
		fmax(lens->centre_px[0], lens->width - lens->centre_px[0]) / lens->focal_px[0],
		fmax(lens->centre_px[1], lens->height - lens->centre_px[1]) / lens->focal_px[1]};
	const double farthest = hypot(corner[0], corner[1]);
	double before = 0, r = 0;

	for (double bent[2] = {0, 0}; r < FAR && bent[0] >= before && bent[0] < farthest;
	     r += FAR / RADII) {
		before = bent[0];
		lens_bend(lens, (double[]){r, 0}, bent);
	}
	return r;
}

/*
 * Fits a focal length and three terms to radii r before and R after the distortion of a lens of
 * six, which is linear in either direction of Tsai's camera, up to the farthest corner:
 *     R = a0 (r + k1 r^3 + k2 r^5 + k3 r^7)      or the same of R for r
 * Tangential terms are taken over, in the other direction to first order. room: 5 RADII numbers.
 */
static struct lens fit_three(const struct lens *lens, enum tsai_distortion direction, double room[])
{
	enum { TERMS = 4 };
	const bool forward = direction == TSAI_DISTORTS;
	struct lens round = *lens, three = {.width = lens->width, .height = lens->height};
	double a[TERMS], reach, scale, unit;

	round.term[LENS_P1] = round.term[LENS_P2] = 0;
	reach = reach_of(&round);
	for (int n = 0; n < RADII; n++) {
		const double r = reach * (n + 1) / RADII;
		double bent[2];

		lens_bend(&round, (double[]){r, 0}, bent);
		for (int t = 0; t < TERMS; t++)
			room[t * RADII + n] = pow(forward ? r : bent[0], 1 + 2 * t);
		room[TERMS * RADII + n] = forward ? bent[0] : r;
	}
	linear_solve(room, RADII, TERMS, a);
	scale = forward ? a[0] : 1 / a[0];
	unit = forward ? 1 : scale * scale; /* kappas count on the sensor */
	for (int i = 0; i < 2; i++) {
		three.focal_px[i] = lens->focal_px[i] * scale;
		three.centre_px[i] = lens->centre_px[i];
	}
	three.term[LENS_K1] = a[1] / a[0] * unit;
	three.term[LENS_K2] = a[2] / a[0] * unit * unit;
	three.term[LENS_K3] = a[3] / a[0] * unit * unit * unit;
	three.term[LENS_P1] = lens->term[LENS_P1] / (forward ? scale : -1);
	three.term[LENS_P2] = lens->term[LENS_P2] / (forward ? scale : -1);
	return three;
}

/* Takes the direction in which the camera is nearer to a lens of six terms. */
static int camera_of_six(const struct lens *lens, struct tsai_camera *camera, double *error_px)
{
	struct bend_sample *sample = malloc(RADII * sizeof(*sample));
	double *room = malloc(5 * RADII * sizeof(*room));
	int err = sample && room ? 0 : -ENOMEM;

	*error_px = INFINITY;
	for (int direction = TSAI_DISTORTS; !err && direction <= TSAI_UNDISTORTS; direction++) {
		const struct lens three = fit_three(lens, (enum tsai_distortion)direction, room);
		struct tsai_camera tried;
		double error;
		int count;

		put_camera(&three, (enum tsai_distortion)direction, &tried);
		count = tsai_check(&tried, NULL) ? 0 : sample_bends(lens, &tried, sample);
		error = count == RADII ? worst_of_bends(lens, sample, count) : INFINITY;
		if (error < *error_px || !direction) {
			*error_px = error;
			*camera = tried;
		}
	}
	free(sample);
	free(room);
	return err;
}

int lens_to_tsai(const struct lens *lens, struct tsai_camera *camera, double tolerance_px,
		 double *error_px, struct fault *fault)
{
	*error_px = 0;
	if (lens->fisheye)
		return fault_say(fault, -EINVAL, "a fisheye, expected a pinhole camera");
	put_camera(lens, TSAI_DISTORTS, camera);
	if ((lens->term[LENS_K4] != 0 || lens->term[LENS_K5] != 0 || lens->term[LENS_K6] != 0) &&
	    camera_of_six(lens, camera, error_px))
		return fault_say(fault, -ENOMEM, "not enough memory");
	if (!(*error_px <= tolerance_px))
		return fault_say(
			fault, -ERANGE,
			"its distortion is more than three kappas can say, which would be off by %.3g px, expected at most %.3g; allow more by --tolerance, or calibrate anew",
			*error_px, tolerance_px);
	return tsai_check(camera, fault);
}

/* ---- fisheyes ---- */

/* Fits k1..k4 of the polynomial to another curve up to the rim. */
static void fit_polynomial(struct lens *lens, const struct fisheye *ours, double *error_px)
{
	enum { ROWS = 512 };
	static const struct fisheye_curve none = {.model = FISHEYE_EQUIDISTANT};
	struct fisheye_curve curve = {.model = FISHEYE_POLYNOMIAL};
	double a[(FISHEYE_TERMS + 1) * ROWS];

	for (int n = 0; n < ROWS; n++) {
		const double theta = ours->field_rad * (n + 1) / ROWS;

		for (int t = 0; t < FISHEYE_TERMS; t++)
			a[t * ROWS + n] = pow(theta, 3 + 2 * t);
		a[FISHEYE_TERMS * ROWS + n] = fisheye_curve_radius(&ours->curve, theta) -
					      fisheye_curve_radius(&none, theta);
	}
	linear_solve(a, ROWS, FISHEYE_TERMS, curve.k);
	memcpy(lens->term, curve.k, sizeof(curve.k));
	*error_px = 0;
	for (int n = 0; n < ROWS; n++) {
		const double theta = ours->field_rad * (n + 1) / ROWS;
		const double off = fisheye_curve_radius(&ours->curve, theta) -
				   fisheye_curve_radius(&curve, theta);

		*error_px = fmax(*error_px, fabs(off) * fmax(ours->focal_px[0], ours->focal_px[1]));
	}
}

int lens_of_fisheye(struct lens *lens, const struct fisheye_settings *settings, int width,
		    int height, double tolerance_px, double *error_px, struct fault *fault)
{
	struct fisheye ours;
	const int err = fisheye_prepare(&ours, settings, width, height, fault);

	if (err)
		return err;
	*lens = (struct lens){.fisheye = true, .width = width, .height = height};
	memcpy(lens->focal_px, ours.focal_px, sizeof(lens->focal_px));
	memcpy(lens->centre_px, ours.centre_px, sizeof(lens->centre_px));
	*error_px = 0;
	if (ours.curve.model == FISHEYE_POLYNOMIAL)
		memcpy(lens->term, ours.curve.k, sizeof(ours.curve.k));
	else if (ours.curve.model != FISHEYE_EQUIDISTANT)
		fit_polynomial(lens, &ours, error_px);
	if (!(*error_px <= tolerance_px))
		return fault_say(
			fault, -ERANGE,
			"the polynomial meets this %s lens to %.3g px only, expected at most %.3g; allow more by --tolerance, or take a smaller field",
			fisheye_model_names[ours.curve.model], *error_px, tolerance_px);
	return 0;
}

/* Returns the angle of the farthest corner, or where the polynomial folds over, rad. */
static double widest_rad(const struct lens *lens, const struct fisheye_curve *curve)
{
	const double most = fmin(M_PI / 2, (1 - 1e-6) * fisheye_curve_fold(curve, M_PI / 2));
	double corner = 0;

	for (int k = 0; k < 4; k++)
		corner = fmax(
			corner,
			hypot(((k & 1) * lens->width - lens->centre_px[0]) / lens->focal_px[0],
			      ((k >> 1) * lens->height - lens->centre_px[1]) / lens->focal_px[1]));
	return fisheye_curve_angle(curve, corner, most);
}

int lens_to_fisheye(const struct lens *lens, struct fisheye_settings *settings, struct fault *fault)
{
	struct fisheye_curve curve = {.model = FISHEYE_POLYNOMIAL};
	struct fisheye prepared;
	bool plain = true;

	if (!lens->fisheye)
		return fault_say(fault, -EINVAL, "a pinhole camera, expected a fisheye");
	memcpy(curve.k, lens->term, sizeof(curve.k));
	for (int k = 0; k < FISHEYE_TERMS; k++)
		plain &= curve.k[k] == 0;
	if (plain)
		curve.model = FISHEYE_EQUIDISTANT;
	*settings = (struct fisheye_settings){.model = (int)curve.model};
	memcpy(settings->focal_px, lens->focal_px, sizeof(settings->focal_px));
	memcpy(settings->centre_px, lens->centre_px, sizeof(settings->centre_px));
	memcpy(settings->polynomial, curve.k, sizeof(settings->polynomial));
	/* rounding must not lose the horizon; a field below a degree is refused as no fisheye */
	settings->field_deg = fmax(widest_rad(lens, &curve) * (180 / M_PI), 1);
	if (settings->field_deg > 90 - 1e-9)
		settings->field_deg = 90;
	return fisheye_prepare(&prepared, settings, lens->width, lens->height, fault);
}
