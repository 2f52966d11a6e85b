/* SPDX-License-Identifier: MIT */
#include "hal/optics/tsai.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "hal/optics/vec.h"

#define FIELD(f) offsetof(struct tsai_camera, f)

const char *const tsai_distortion_names[] = {"distorts", "undistorts", NULL};

const struct ini_key tsai_keys[] = {
	{"width", INI_INT, FIELD(width), .min = 1, .max = TSAI_SIDE_MAX, .unit = "px",
	 .help = "width of the picture"},
	{"height", INI_INT, FIELD(height), .min = 1, .max = TSAI_SIDE_MAX, .unit = "px",
	 .help = "height of the picture"},
	{"rotation", INI_REALS, FIELD(rotation), 9, .min = -1.001, .max = 1.001,
	 .help = "R, world to camera, row by row; a rotation to 1e-6"},
	{"translation", INI_REALS, FIELD(translation), 3, .min = -1e9, .max = 1e9,
	 .unit = "world units",
	 .help = "T: the world's origin in camera axes (x right, y down, z along the view)"},
	{"focal", INI_REAL, FIELD(focal), .min = 1e-6, .max = 1e6, .unit = "mm",
	 .help = "f: distance from the pinhole to the sensor"},
	{"kappa1", INI_REAL, FIELD(kappa1), .min = -1e6, .max = 1e6, .fallback = "0",
	 .unit = "1/mm^2", .help = "radial distortion, r the radius on the sensor"},
	{"kappa2", INI_REAL, FIELD(kappa2), .min = -1e6, .max = 1e6, .fallback = "0",
	 .unit = "1/mm^4", .rare = true, .help = "second radial term: kappa1 r^2 + kappa2 r^4"},
	{"kappa3", INI_REAL, FIELD(kappa3), .min = -1e6, .max = 1e6, .fallback = "0",
	 .unit = "1/mm^6", .rare = true, .help = "third radial term: ... + kappa3 r^6"},
	{"tangential", INI_REALS, FIELD(tangential), 2, .min = -1e6, .max = 1e6, .fallback = "0 0",
	 .unit = "1/mm", .rare = true,
	 .help = "q: moves a point P by q r^2 + 2 P (q . P), y down; OpenCV's p2 and p1, divided by the focal length"},
	{"distortion", INI_CHOICE, FIELD(distortion), .choices = tsai_distortion_names,
	 .fallback = "distorts",
	 .help = "what kappa1 (and kappa2 ...) means; distorts: distorted = undistorted (1 + "
		 "kappa1 r^2), r undistorted; undistorts (Tsai's papers): undistorted = distorted (1 + kappa1 r^2), r distorted"},
	{"centre", INI_REALS, FIELD(centre_px), 2, .min = -1e6, .max = 1e6, .unit = "px",
	 .help = "C: the axis in the picture, from the lower left corner, x right, y up"},
	{"pixel", INI_REALS, FIELD(pixel), 2, .min = 1e-9, .max = 1e6, .unit = "mm",
	 .help = "D: width and height of a pixel on the sensor"},
	{"aspect", INI_REAL, FIELD(aspect), .min = 1e-3, .max = 1e3, .fallback = "1",
	 .help = "s: horizontal stretch between sensor and frame grabber"},
	{"edge_spread", INI_REAL, FIELD(edge_spread_px), .max = TSAI_EDGE_SPREAD_MAX,
	 .fallback = "0", .unit = "px", .rare = true,
	 .help = "sigma of the Gaussian by which edges are blurred beyond a pixel's square; the bake blurs the object's alike"},
	INI_KEYS_END,
};

/* Makes a nearly orthogonal matrix orthogonal. The iteration
 *     R <- R (3 - R^T R) / 2
 * squares the error in each step: from 1e-6 to below rounding in two. */
static void make_orthogonal(double r[9])
{
	for (int step = 0; step < 3; step++) {
		double gram[9], next[9];

		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				gram[3 * i + j] = r[i] * r[j] + r[3 + i] * r[3 + j] +
						  r[6 + i] * r[6 + j];
		for (int i = 0; i < 3; i++)
			for (int j = 0; j < 3; j++)
				next[3 * i + j] = 1.5 * r[3 * i + j] -
						  0.5 * (r[3 * i] * gram[j] +
							 r[3 * i + 1] * gram[3 + j] +
							 r[3 * i + 2] * gram[6 + j]);
		memcpy(r, next, sizeof(next));
	}
}

/* Deviation of the rows from an orthonormal right-handed frame; infinity for NaN. */
static double rotation_error(const double r[9])
{
	double worst = 0, normal[3];

	for (int i = 0; i < 3; i++)
		for (int j = i; j < 3; j++) {
			const double e = fabs(vec_dot(r + 3 * i, r + 3 * j) - (i == j));

			worst = e <= worst ? worst : e;
			if (!isfinite(e))
				return INFINITY;
		}
	vec_cross(r, r + 3, normal);
	return fmax(worst, fabs(vec_dot(normal, r + 6) - 1));
}

static bool all_finite(const double *v, int count)
{
	for (int i = 0; i < count; i++)
		if (!isfinite(v[i]))
			return false;
	return true;
}

static bool is_positive(double x)
{
	return x > 0 && isfinite(x);
}

bool tsai_is_plain(const struct tsai_camera *c)
{
	return c->kappa2 == 0 && c->kappa3 == 0 && c->tangential[0] == 0 && c->tangential[1] == 0;
}

struct distortion tsai_distortion_of(const struct tsai_camera *c)
{
	const double across = fmax(fabs(c->centre_px[0]), fabs(c->width - c->centre_px[0]));
	const double down = fmax(fabs(c->centre_px[1]), fabs(c->height - c->centre_px[1]));

	return (struct distortion){
		.radial = {c->kappa1, c->kappa2, c->kappa3},
		.tangential = {c->tangential[0], c->tangential[1]},
		.reach = hypot(across * c->pixel[0] / c->aspect, down * c->pixel[1]),
	};
}

/* Refuses a distortion of several terms that folds over inside of the picture. With kappa1 alone
 * the corners beyond the fold see nothing. */
static int check_fold(const struct tsai_camera *c, struct fault *fault)
{
	const struct distortion d = tsai_distortion_of(c);
	double covered;

	if (tsai_is_plain(c))
		return 0;
	covered = c->distortion == TSAI_DISTORTS ? distortion_covers(&d) : distortion_fold(&d);
	if (covered >= d.reach)
		return 0;
	return fault_say(
		fault, -EINVAL,
		"camera: kappa1, kappa2, kappa3 and tangential fold the picture over at "
		"%.4g of the way from the axis to its farthest corner, expected a distortion that grows over the whole picture",
		covered / d.reach);
}

int tsai_check(struct tsai_camera *c, struct fault *fault)
{
	if (c->width < 1 || c->height < 1 || c->width > TSAI_SIDE_MAX || c->height > TSAI_SIDE_MAX)
		return fault_say(fault, -EINVAL,
				 "camera: the picture is %d x %d, expected sides of 1 to %d",
				 c->width, c->height, TSAI_SIDE_MAX);
	if (!is_positive(c->focal))
		return fault_say(fault, -EINVAL, "camera: focal is %g, expected a number above 0",
				 c->focal);
	if (!is_positive(c->pixel[0]) || !is_positive(c->pixel[1]))
		return fault_say(fault, -EINVAL,
				 "camera: pixel is %g %g, expected two numbers above 0",
				 c->pixel[0], c->pixel[1]);
	if (!is_positive(c->aspect))
		return fault_say(fault, -EINVAL, "camera: aspect is %g, expected a number above 0",
				 c->aspect);
	if (!isfinite(c->kappa1))
		return fault_say(fault, -EINVAL, "camera: kappa1 is %g, expected a finite number",
				 c->kappa1);
	if (!isfinite(c->kappa2) || !isfinite(c->kappa3) || !all_finite(c->tangential, 2))
		return fault_say(fault, -EINVAL,
				 "camera: kappa2, kappa3 and tangential must be finite numbers");
	if (c->distortion != TSAI_DISTORTS && c->distortion != TSAI_UNDISTORTS)
		return fault_say(
			fault, -EINVAL,
			"camera: distortion is %d, expected %d (distorts) or %d (undistorts)",
			c->distortion, TSAI_DISTORTS, TSAI_UNDISTORTS);
	if (!all_finite(c->translation, 3) || !all_finite(c->centre_px, 2))
		return fault_say(fault, -EINVAL,
				 "camera: translation and centre must be finite numbers");
	if (!(rotation_error(c->rotation) <= 1e-6))
		return fault_say(
			fault, -EINVAL,
			"camera: rotation is off by %.3g from a right-handed rotation, expected at most 1e-6",
			rotation_error(c->rotation));
	make_orthogonal(c->rotation);
	return check_fold(c, fault);
}

int tsai_look_at(struct tsai_camera *c, int width, int height, const double eye[3],
		 const double target[3], double field_deg, struct fault *fault)
{
	const double sensor_mm = 36; /* width of 35 mm film, so that focal has a familiar value */
	const double up[3] = {0, 0, 1};
	double *right = c->rotation, *down = c->rotation + 3, *view = c->rotation + 6;
	double away[3];

	if (!(field_deg > 0 && field_deg < 180))
		return fault_say(
			fault, -EINVAL,
			"camera: field of view is %g, expected above 0 and below 180 degrees",
			field_deg);
	if (!all_finite(eye, 3) || !all_finite(target, 3))
		return fault_say(fault, -EINVAL, "camera: eye and target must be finite numbers");
	*c = (struct tsai_camera){.width = width, .height = height, .aspect = 1};
	for (int i = 0; i < 3; i++)
		view[i] = target[i] - eye[i];
	if (!(vec_normalize(view) > 0))
		return fault_say(fault, -EINVAL, "camera: eye and target coincide");
	vec_cross(view, up, right);
	if (!(vec_normalize(right) > 1e-9))
		return fault_say(
			fault, -EINVAL,
			"camera: the view is straight up or down, so that no side of the picture is up; move eye or target a little");
	vec_cross(view, right, down);
	mat_apply(c->rotation, eye, away);
	for (int i = 0; i < 3; i++)
		c->translation[i] = -away[i];
	c->pixel[0] = c->pixel[1] = sensor_mm / width;
	c->focal = 0.5 * sensor_mm / tan(field_deg * (M_PI / 360));
	c->centre_px[0] = 0.5 * width;
	c->centre_px[1] = 0.5 * height;
	return tsai_check(c, fault);
}

double tsai_fold_radius(double kappa1)
{
	return kappa1 < 0 ? 1 / sqrt(-3 * kappa1) : INFINITY;
}

/*
 * Solves r (1 + kappa1 r^2) = d. With r = 3 d t / q and q = 1.5 d sqrt(3 |kappa1|) the cubic
 * becomes
 *     4 t^3 + 3 t = q,   t = sinh(asinh(q) / 3)         kappa1 > 0
 *     3 t - 4 t^3 = q,   t = sin(asin(q) / 3)           kappa1 < 0, the branch through 0
 * q = 1 is the fold.
 */
static double closed_form(double kappa1, double d)
{
	const double q = 1.5 * sqrt(3) * sqrt(fabs(kappa1)) * d;

	if (q < 1e-9) /* r = d to double precision, and t / q may be 0 / 0 */
		return d;
	if (kappa1 < 0) {
		if (q > 1 + 8 * DBL_EPSILON)
			return NAN;
		return 3 * d * (sin(asin(fmin(q, 1)) / 3) / q);
	}
	if (q > 1e30) /* the linear term is below rounding, and q may be infinite */
		return cbrt(d) / cbrt(kappa1);
	return 3 * d * (sinh(asinh(q) / 3) / q);
}

int tsai_straight_radius(double kappa1, double bent, double *straight)
{
	const double fold = tsai_fold_radius(kappa1);
	double r;

	if (!isfinite(kappa1) || !isfinite(bent) || bent < 0)
		return -ERANGE;
	r = closed_form(kappa1, bent);
	if (!isfinite(r))
		return -ERANGE;
	for (int step = 0; step < 2; step++) {
		const double bend = kappa1 * r * r;
		const double next = r - (r * (1 + bend) - bent) / (1 + 3 * bend);

		/* The closed form is exact to 1e-15, but only to 1e-8 at the fold, where the slope
		 * is 0 and a step could lead anywhere. */
		if (fabs(next - r) <= 1e-8 * r && next <= fold)
			r = next;
	}
	*straight = r;
	return 0;
}

/* The factor 1 + kappa1 r^2. 0; -ERANGE: radius beyond the fold. */
static int radius_bend(double kappa1, double radius, double *factor)
{
	if (!(radius <= tsai_fold_radius(kappa1)))
		return -ERANGE;
	*factor = 1 + kappa1 * radius * radius;
	return 0;
}

/* The factor that undoes 1 + kappa1 r^2. 0; -ERANGE: no solution. */
static int radius_straighten(double kappa1, double radius, double *factor)
{
	double r;
	const int ret = tsai_straight_radius(kappa1, radius, &r);

	if (ret < 0)
		return ret;
	*factor = radius > 0 ? r / radius : 1;
	return 0;
}

/* Distorts a point of the sensor, or undistorts it. 0; -ERANGE: no such point. */
static int sensor_turn(const struct tsai_camera *c, bool distort, double point[2])
{
	const bool bends = distort == (c->distortion == TSAI_DISTORTS);
	double factor = 1;
	int ret;

	if (!tsai_is_plain(c)) {
		const struct distortion d = tsai_distortion_of(c);
		const double from[2] = {point[0], point[1]};

		return bends ? distortion_bend(&d, from, point, NULL)
			     : distortion_straighten(&d, from, point);
	}
	ret = (bends ? radius_bend : radius_straighten)(c->kappa1, hypot(point[0], point[1]),
							&factor);
	point[0] *= factor;
	point[1] *= factor;
	return ret;
}

int tsai_project(const struct tsai_camera *c, const double world[3], double px[2])
{
	double p[3], sensor[2], x, y;
	int ret;

	mat_apply(c->rotation, world, p);
	for (int i = 0; i < 3; i++)
		p[i] += c->translation[i];
	if (!(p[2] > 0))
		return -ERANGE;
	sensor[0] = c->focal * p[0] / p[2];
	sensor[1] = c->focal * p[1] / p[2];
	ret = sensor_turn(c, true, sensor);
	if (ret < 0)
		return ret;
	x = c->centre_px[0] + c->aspect * sensor[0] / c->pixel[0];
	y = c->height - c->centre_px[1] + sensor[1] / c->pixel[1];
	if (!isfinite(x) || !isfinite(y))
		return -ERANGE;
	px[0] = x;
	px[1] = y;
	return 0;
}

int tsai_ray(const struct tsai_camera *c, const double px[2], double origin[3], double dir[3])
{
	double camera[3] = {(px[0] - c->centre_px[0]) * c->pixel[0] / c->aspect,
			    (px[1] - (c->height - c->centre_px[1])) * c->pixel[1], c->focal};
	const int ret = sensor_turn(c, false, camera);

	if (ret < 0)
		return ret;
	if (!(vec_normalize(camera) <= DBL_MAX))
		return -ERANGE;
	mat_apply_transposed(c->rotation, camera, dir);
	mat_apply_transposed(c->rotation, c->translation, origin);
	for (int i = 0; i < 3; i++)
		origin[i] = -origin[i];
	return 0;
}

static void *tsai_place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

int tsai_read_text(const char *text, struct tsai_camera *camera, struct fault *fault)
{
	static const struct ini_table tables[] = {
		{"camera", .keys = tsai_keys, .place = tsai_place}, INI_TABLES_END};
	struct ini_report report = {.count = 0};
	int err;

	memset(camera, 0, sizeof(*camera));
	ini_defaults(tsai_keys, camera);
	err = *text ? ini_read_memory(text, strlen(text), "camera", NULL, tables, camera, &report)
		    : fault_say(&report.first, -EINVAL, "no camera");
	if (err)
		fault_say(fault, err, "%s", report.first.text);
	else
		err = tsai_check(camera, fault);
	if (err)
		memset(camera, 0, sizeof(*camera));
	return err;
}
