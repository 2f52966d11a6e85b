/* SPDX-License-Identifier: MIT */
#include "hal/optics/fisheye.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "hal/optics/vec.h"

/* Tolerance of the field: rounding must not lose a direction on the rim, such as a light on the
 * horizon under a lens of 90 degrees. */
#define FIELD_SLACK_RAD 1e-12

/* Slopes of a lens's curve are looked at in steps, between which they change by far less. */
#define SLOPE_STEPS 1000
#define SLOPE_SAFETY 1.1

#define FIELD(f) offsetof(struct fisheye_settings, f)

const struct ini_key fisheye_keys[] = {
	{"focal", INI_REALS, FIELD(focal_px), 2, .max = 1e6, .fallback = "0 0", .unit = "px/rad",
	 .help = "Horizontal and vertical focal length; 0 0: the field fills the smaller side."},
	{"centre", INI_REALS, FIELD(centre_px), 2, .min = -1e6, .max = 1e6, .fallback = "0 0",
	 .unit = "px",
	 .help = "The lens's axis in the upright picture, from its upper left corner; 0 0: the middle."},
	{"rotation", INI_REALS, FIELD(rotation_deg), 3, .min = -360, .max = 360,
	 .fallback = "0 0 0", .unit = "deg",
	 .help = "Turn of the world into the camera, about X, then Y, then Z; 0 0 0: it lies on its back, picture right is world X, picture down is world Y."},
	{"field", INI_REAL, FIELD(field_deg), .min = 1, .max = 180, .fallback = "90", .unit = "deg",
	 .help = "Half the field of view: 90 sees a hemisphere."},
	{"model", INI_CHOICE, FIELD(model), .choices = fisheye_model_names,
	 .fallback = "equidistant",
	 .help = "How far from the axis the angle t from it is seen, in focal lengths: t; 2 sin(t/2); 2 tan(t/2); sin(t); the polynomial below."},
	{"polynomial", INI_REALS, FIELD(polynomial), FISHEYE_TERMS, .min = -1e3, .max = 1e3,
	 .fallback = "0 0 0 0",
	 .help = "k1 k2 k3 k4 of that model: t + k1 t^3 + k2 t^5 + k3 t^7 + k4 t^9, t in radians."},
	{"falloff", INI_REALS, FIELD(falloff), FISHEYE_FALLOFF_TERMS, .min = -1e3, .max = 1e3,
	 .fallback = "0 0 0",
	 .help = "v1 v2 v3: of the light on its axis the lens passes 1 + v1 t^2 + v2 t^4 + v3 t^6 at the angle t; what is measured is divided by it."},
	INI_KEYS_END,
};

void fisheye_rotation(const double deg[3], double r[9])
{
	const double cx = cos(deg[0] * (M_PI / 180)), sx = sin(deg[0] * (M_PI / 180));
	const double cy = cos(deg[1] * (M_PI / 180)), sy = sin(deg[1] * (M_PI / 180));
	const double cz = cos(deg[2] * (M_PI / 180)), sz = sin(deg[2] * (M_PI / 180));

	r[0] = cz * cy;
	r[1] = cz * sy * sx - sz * cx;
	r[2] = cz * sy * cx + sz * sx;
	r[3] = sz * cy;
	r[4] = sz * sy * sx + cz * cx;
	r[5] = sz * sy * cx - cz * sx;
	r[6] = -sy;
	r[7] = cy * sx;
	r[8] = cy * cx;
}

static int fisheye_check_settings(const struct fisheye_settings *s, struct fault *fault)
{
	if (!(s->field_deg > 0 && s->field_deg <= 180))
		return fault_say(fault, -EINVAL,
				 "fisheye: field is %g, expected above 0 and at most 180 degrees",
				 s->field_deg);
	for (int i = 0; i < 2; i++) {
		if (!(s->focal_px[i] >= 0) || !isfinite(s->focal_px[i]) ||
		    (s->focal_px[i] == 0) != (s->focal_px[1 - i] == 0))
			return fault_say(
				fault, -EINVAL,
				"fisheye: focal is %g %g, expected two numbers above 0 (or 0 0: from the size of the picture)",
				s->focal_px[0], s->focal_px[1]);
		if (!isfinite(s->centre_px[i]))
			return fault_say(fault, -EINVAL,
					 "fisheye: centre is %g %g, expected finite numbers",
					 s->centre_px[0], s->centre_px[1]);
	}
	if (s->model < 0 || s->model >= FISHEYE_MODEL_COUNT)
		return fault_say(fault, -EINVAL,
				 "fisheye: model %d is unknown, expected one of 0..%d", s->model,
				 FISHEYE_MODEL_COUNT - 1);
	for (int i = 0; i < FISHEYE_TERMS; i++)
		if (!isfinite(s->polynomial[i]))
			return fault_say(
				fault, -EINVAL,
				"fisheye: polynomial is %g %g %g %g, expected finite numbers",
				s->polynomial[0], s->polynomial[1], s->polynomial[2],
				s->polynomial[3]);
	for (int i = 0; i < FISHEYE_FALLOFF_TERMS; i++)
		if (!isfinite(s->falloff[i]))
			return fault_say(fault, -EINVAL,
					 "fisheye: falloff is %g %g %g, expected finite numbers",
					 s->falloff[0], s->falloff[1], s->falloff[2]);
	for (int i = 0; i < 3; i++)
		if (!isfinite(s->rotation_deg[i]))
			return fault_say(fault, -EINVAL,
					 "fisheye: rotation is %g %g %g, expected finite numbers",
					 s->rotation_deg[0], s->rotation_deg[1],
					 s->rotation_deg[2]);
	return 0;
}

/* Checks that the model does not fold over, and that the falloff stays above 0, inside the
 * field. */
static int fisheye_check_curve(const struct fisheye *lens, double field_deg, struct fault *fault)
{
	const double *v = lens->falloff, passed[4] = {1, v[0], v[1], v[2]};
	const double fold = fisheye_curve_fold(&lens->curve, lens->field_rad);
	const double dark = sqrt(fisheye_first_root(passed, 3, lens->field_rad * lens->field_rad));

	if (fold < INFINITY)
		return fault_say(
			fault, -EINVAL,
			"fisheye: field is %g degrees, but the %s model folds over at %.4g; expected a smaller field or another polynomial",
			field_deg, fisheye_model_names[lens->curve.model], fold * (180 / M_PI));
	if (!(lens->rim < INFINITY))
		return fault_say(fault, -EINVAL, "fisheye: the rim of the field has no place");
	if (dark < INFINITY)
		return fault_say(
			fault, -EINVAL,
			"fisheye: falloff is %g %g %g, which leaves no light %.4g degrees from the axis; expected some in all of the field of %g",
			v[0], v[1], v[2], dark * (180 / M_PI), field_deg);
	return 0;
}

int fisheye_prepare(struct fisheye *lens, const struct fisheye_settings *settings, int width,
		    int height, struct fault *fault)
{
	const bool whole = settings->focal_px[0] == 0;
	const bool middle = settings->centre_px[0] == 0 && settings->centre_px[1] == 0;
	const int side = width < height ? width : height;
	int ret;

	if (side < 1)
		return fault_say(fault, -EINVAL,
				 "fisheye: the picture is %d x %d, expected at least 1 x 1", width,
				 height);
	ret = fisheye_check_settings(settings, fault);
	if (ret < 0)
		return ret;
	lens->curve.model = (enum fisheye_model)settings->model;
	memcpy(lens->curve.k, settings->polynomial, sizeof(lens->curve.k));
	memcpy(lens->falloff, settings->falloff, sizeof(lens->falloff));
	lens->field_rad = settings->field_deg * (M_PI / 180);
	lens->rim = fisheye_curve_radius(&lens->curve, lens->field_rad);
	for (int i = 0; i < 2; i++) {
		lens->focal_px[i] = whole ? 0.5 * side / lens->rim : settings->focal_px[i];
		lens->centre_px[i] = middle ? 0.5 * (i ? height : width) : settings->centre_px[i];
	}
	for (int i = 0; i < 3; i++)
		lens->rotation_deg[i] = settings->rotation_deg[i];
	fisheye_rotation(lens->rotation_deg, lens->rotation);
	return fisheye_check_curve(lens, settings->field_deg, fault);
}

bool fisheye_project(const struct fisheye *lens, const double dir[3], double px[2])
{
	double c[3], across, theta, radius;

	mat_apply(lens->rotation, dir, c);
	across = hypot(c[0], c[1]);
	if (!(across > 0) && !(fabs(c[2]) > 0))
		return false; /* not a direction */
	theta = atan2(across, c[2]);
	if (!(theta <= lens->field_rad + FIELD_SLACK_RAD))
		return false;
	radius = fisheye_curve_radius(&lens->curve, theta);
	if (across > 0) {
		px[0] = lens->centre_px[0] + lens->focal_px[0] * radius * (c[0] / across);
		px[1] = lens->centre_px[1] + lens->focal_px[1] * radius * (c[1] / across);
	} else { /* on the axis: the centre; straight behind: any point of the rim */
		px[0] = lens->centre_px[0] + lens->focal_px[0] * radius;
		px[1] = lens->centre_px[1];
	}
	return true;
}

/* Position of px relative to the axis in focal lengths, its radius, and the angle theta. False:
 * outside the field. */
static bool angle_of(const struct fisheye *lens, const double px[2], double at[2], double *radius,
		     double *theta)
{
	for (int i = 0; i < 2; i++)
		at[i] = (px[i] - lens->centre_px[i]) / lens->focal_px[i];
	*radius = sqrt(at[0] * at[0] + at[1] * at[1]);
	if (!(*radius <= lens->rim + FIELD_SLACK_RAD * (1 + lens->rim)))
		return false;
	*theta = fisheye_curve_angle(&lens->curve, *radius, lens->field_rad);
	return true;
}

static void ray_of(const struct fisheye *lens, const double at[2], double radius, double sine,
		   double cosine, double dir[3])
{
	const double across = radius > 1e-8 ? sine / radius : 1;
	const double c[3] = {at[0] * across, at[1] * across, cosine};

	mat_apply_transposed(lens->rotation, c, dir);
}

static double pixel_sr_of(const struct fisheye *lens, double theta, double sine)
{
	const double focal2 = lens->focal_px[0] * lens->focal_px[1];
	double sr = fmax(fisheye_curve_patch_sr(&lens->curve, theta, sine), 0);

	/* Half a pixel inside the rim cos(theta) = 1 / sqrt(focal): limit sr to sqrt(focal). */
	if (lens->curve.model == FISHEYE_ORTHOGRAPHIC && !(sr * sr * sr * sr < focal2))
		sr = sqrt(sqrt(focal2));
	return sr / focal2;
}

static double falloff_of(const struct fisheye *lens, double theta)
{
	const double *v = lens->falloff, u = theta * theta;

	return 1 + u * (v[0] + u * (v[1] + u * v[2]));
}

bool fisheye_ray(const struct fisheye *lens, const double px[2], double dir[3])
{
	double at[2], radius, theta;

	if (!angle_of(lens, px, at, &radius, &theta))
		return false;
	ray_of(lens, at, radius, sin(theta), cos(theta), dir);
	return true;
}

bool fisheye_pixel_of(const struct fisheye *lens, const double px[2], struct fisheye_pixel *pixel)
{
	double at[2], radius, theta, sine, cosine;

	if (!angle_of(lens, px, at, &radius, &theta))
		return false;
	sincos(theta, &sine, &cosine);
	ray_of(lens, at, radius, sine, cosine, pixel->dir);
	pixel->sr = pixel_sr_of(lens, theta, sine);
	pixel->falloff = falloff_of(lens, theta);
	return true;
}

double fisheye_pixel_sr(const struct fisheye *lens, const double px[2])
{
	double at[2], radius, theta;

	return angle_of(lens, px, at, &radius, &theta) ? pixel_sr_of(lens, theta, sin(theta)) : 0;
}

double fisheye_falloff(const struct fisheye *lens, const double px[2])
{
	const double *v = lens->falloff;
	double at[2], radius, theta;

	if ((v[0] == 0 && v[1] == 0 && v[2] == 0) || !angle_of(lens, px, at, &radius, &theta))
		return 1;
	return falloff_of(lens, theta);
}

double fisheye_turn_per_pixel(const struct fisheye *lens)
{
	double least = 1, turn = 1;

	for (int k = 0; k <= SLOPE_STEPS; k++) {
		const double theta = lens->field_rad * k / SLOPE_STEPS;
		const double radius = fisheye_curve_radius(&lens->curve, theta);

		least = fmin(least, fisheye_curve_slope(&lens->curve, theta));
		if (theta > 0)
			turn = fmax(turn, sin(theta) / radius);
	}
	return SLOPE_SAFETY * fmax(turn, 1 / least) / fmin(lens->focal_px[0], lens->focal_px[1]);
}
