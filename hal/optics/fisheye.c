#include "hal/optics/fisheye.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>

#include "hal/optics/vec.h"

/* A direction on the rim (a light on the horizon under a lens of 90 degrees) must not be lost to
 * the rounding of its angle. */
#define FIELD_SLACK_RAD 1e-12

#define FIELD(f) offsetof(struct fisheye_settings, f)

const struct ini_key fisheye_keys[] = {
	{.name = "focal",
	 .type = INI_REALS,
	 .offset = FIELD(focal_px),
	 .count = 2,
	 .min = 0,
	 .max = 1e6,
	 .fallback = "0 0",
	 .unit = "px/rad",
	 .help = "horizontal and vertical focal length, r = focal * angle; 0 0: the field fills "
		 "the smaller side"},
	{.name = "centre",
	 .type = INI_REALS,
	 .offset = FIELD(centre_px),
	 .count = 2,
	 .min = -1e6,
	 .max = 1e6,
	 .fallback = "0 0",
	 .unit = "px",
	 .help = "the lens's axis in the upright picture, from its upper left corner; 0 0: the "
		 "middle"},
	{.name = "rotation",
	 .type = INI_REALS,
	 .offset = FIELD(rotation_deg),
	 .count = 3,
	 .min = -360,
	 .max = 360,
	 .fallback = "0 0 0",
	 .unit = "deg",
	 .help = "turn of the world into the camera, about X, then Y, then Z; 0 0 0: it lies on "
		 "its back, picture right is world X, picture down is world Y"},
	{.name = "field",
	 .type = INI_REAL,
	 .offset = FIELD(field_deg),
	 .min = 1,
	 .max = 180,
	 .fallback = "90",
	 .unit = "deg",
	 .help = "half the field of view: 90 sees a hemisphere"},
	INI_KEYS_END,
};

/* Rz Ry Rx */
static void rotation_from_degrees(const double deg[3], double r[9])
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

static int check_settings(const struct fisheye_settings *s, struct fault *fault)
{
	if (!(s->field_deg > 0 && s->field_deg <= 180))
		return fault_say(fault, -EINVAL,
				 "fisheye: field is %g, expected above 0 and at most 180 degrees",
				 s->field_deg);
	for (int i = 0; i < 2; i++) {
		if (!(s->focal_px[i] >= 0) || !isfinite(s->focal_px[i]) ||
		    (s->focal_px[i] == 0) != (s->focal_px[1 - i] == 0))
			return fault_say(fault, -EINVAL,
					 "fisheye: focal is %g %g, expected two numbers above 0 "
					 "(or 0 0: from the size of the picture)",
					 s->focal_px[0], s->focal_px[1]);
		if (!isfinite(s->centre_px[i]))
			return fault_say(fault, -EINVAL,
					 "fisheye: centre is %g %g, expected finite numbers",
					 s->centre_px[0], s->centre_px[1]);
	}
	for (int i = 0; i < 3; i++)
		if (!isfinite(s->rotation_deg[i]))
			return fault_say(fault, -EINVAL,
					 "fisheye: rotation is %g %g %g, expected finite numbers",
					 s->rotation_deg[0], s->rotation_deg[1],
					 s->rotation_deg[2]);
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
	ret = check_settings(settings, fault);
	if (ret < 0)
		return ret;
	lens->field_rad = settings->field_deg * (M_PI / 180);
	for (int i = 0; i < 2; i++) {
		lens->focal_px[i] = whole ? 0.5 * side / lens->field_rad : settings->focal_px[i];
		lens->centre_px[i] = middle ? 0.5 * (i ? height : width) : settings->centre_px[i];
	}
	for (int i = 0; i < 3; i++)
		lens->rotation_deg[i] = settings->rotation_deg[i];
	rotation_from_degrees(lens->rotation_deg, lens->rotation);
	return 0;
}

bool fisheye_project(const struct fisheye *lens, const double dir[3], double px[2])
{
	double c[3], across, theta;

	mat_apply(lens->rotation, dir, c);
	across = hypot(c[0], c[1]);
	if (!(across > 0) && !(fabs(c[2]) > 0))
		return false; /* no direction at all */
	theta = atan2(across, c[2]);
	if (!(theta <= lens->field_rad + FIELD_SLACK_RAD))
		return false;
	if (across > 0) {
		px[0] = lens->centre_px[0] + lens->focal_px[0] * theta * (c[0] / across);
		px[1] = lens->centre_px[1] + lens->focal_px[1] * theta * (c[1] / across);
	} else { /* on the axis; straight behind, any point of the rim is as good */
		px[0] = lens->centre_px[0] + lens->focal_px[0] * theta;
		px[1] = lens->centre_px[1];
	}
	return true;
}

/* The point in radians from the axis; false outside the field. */
static bool angle_of(const struct fisheye *lens, const double px[2], double angle[2], double *theta)
{
	for (int i = 0; i < 2; i++)
		angle[i] = (px[i] - lens->centre_px[i]) / lens->focal_px[i];
	*theta = hypot(angle[0], angle[1]);
	return *theta <= lens->field_rad + FIELD_SLACK_RAD;
}

/* sin(x) / x */
static double sinc(double x)
{
	return x > 1e-8 ? sin(x) / x : 1;
}

bool fisheye_ray(const struct fisheye *lens, const double px[2], double dir[3])
{
	double angle[2], theta, c[3];

	if (!angle_of(lens, px, angle, &theta))
		return false;
	c[0] = angle[0] * sinc(theta);
	c[1] = angle[1] * sinc(theta);
	c[2] = cos(theta);
	mat_apply_transposed(lens->rotation, c, dir);
	vec_normalize(dir);
	return true;
}

double fisheye_pixel_sr(const struct fisheye *lens, const double px[2])
{
	double angle[2], theta;

	if (!angle_of(lens, px, angle, &theta))
		return 0;
	return fmax(sinc(theta), 0) / (lens->focal_px[0] * lens->focal_px[1]);
}
