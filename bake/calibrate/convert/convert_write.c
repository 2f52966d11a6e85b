/* SPDX-License-Identifier: MIT */
/* Writes lenses as OpenCV's FileStorage, ROS's camera_info and our INI files. */
#include <math.h>

#include "bake/calibrate/convert/convert.h"

const char *const lens_file_names[] = {"ini", "opencv", "ros", NULL};

/* Writes a number with a point: OpenCV reads one without as an integer. */
static void write_number(FILE *to, double value)
{
	if (value == rint(value) && fabs(value) < 1e15)
		fprintf(to, "%.1f", value);
	else
		fprintf(to, "%.17g", value);
}

static void write_matrix(FILE *to, const char *name, bool opencv, int rows, int columns,
			 const double *data)
{
	const char *indent = opencv ? "   " : "  ";

	fprintf(to, "%s:%s\n%srows: %d\n%scols: %d\n", name, opencv ? " !!opencv-matrix" : "",
		indent, rows, indent, columns);
	if (opencv)
		fprintf(to, "%sdt: d\n", indent);
	fprintf(to, "%sdata: [", indent);
	for (int k = 0; k < rows * columns; k++) {
		fputs(k ? ", " : " ", to);
		write_number(to, data[k]);
	}
	fputs(" ]\n", to);
}

static void write_yaml_comment(FILE *to, const struct lens *lens, double error_px)
{
	fputs("# The lens alone: where the camera is, is no part of this format.\n", to);
	if (error_px > 0)
		fprintf(to, "# Fitted: it is off from the %s it was made of by at most %.3g px.\n",
			lens->fisheye ? "fisheye" : "camera", error_px);
}

static void camera_matrix(const struct lens *lens, double k[9])
{
	const double all[9] = {lens->focal_px[0],
			       0,
			       lens->centre_px[0] - 0.5,
			       0,
			       lens->focal_px[1],
			       lens->centre_px[1] - 0.5,
			       0,
			       0,
			       1};

	for (int i = 0; i < 9; i++)
		k[i] = all[i];
}

/* Number of distortion terms: 4 for a fisheye; else 5, or 8 if they are in use. */
static int terms_of(const struct lens *lens)
{
	if (lens->fisheye)
		return FISHEYE_TERMS;
	return lens->term[LENS_K4] != 0 || lens->term[LENS_K5] != 0 || lens->term[LENS_K6] != 0
		       ? LENS_TERMS
		       : LENS_K3 + 1;
}

void lens_write_opencv(FILE *to, const struct lens *lens, double error_px)
{
	double k[9];

	camera_matrix(lens, k);
	fputs("%YAML:1.0\n---\n", to);
	write_yaml_comment(to, lens, error_px);
	fprintf(to, "image_width: %d\nimage_height: %d\n", lens->width, lens->height);
	fprintf(to, "fisheye_model: %d\n", lens->fisheye);
	write_matrix(to, "camera_matrix", true, 3, 3, k);
	write_matrix(to, "distortion_coefficients", true, terms_of(lens), 1, lens->term);
}

void lens_write_ros(FILE *to, const struct lens *lens, const char *name, double error_px)
{
	static const double unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
	const int terms = terms_of(lens);
	double k[9];

	camera_matrix(lens, k);
	write_yaml_comment(to, lens, error_px);
	fprintf(to, "image_width: %d\nimage_height: %d\ncamera_name: %s\n", lens->width,
		lens->height, name);
	write_matrix(to, "camera_matrix", false, 3, 3, k);
	fprintf(to, "distortion_model: %s\n",
		lens->fisheye	      ? "equidistant"
		: terms == LENS_TERMS ? "rational_polynomial"
				      : "plumb_bob");
	write_matrix(to, "distortion_coefficients", false, 1, terms, lens->term);
	write_matrix(to, "rectification_matrix", false, 3, 3, unit);
	write_matrix(to, "projection_matrix", false, 3, 4,
		     (const double[12]){k[0], 0, k[2], 0, 0, k[4], k[5], 0, 0, 0, 1, 0});
}

void lens_write_ini(FILE *to, const struct lens_ini *ini, const char *from, double error_px)
{
	fprintf(to, "; From %s, which knows the lens alone.\n", from);
	if (ini->camera_given)
		fputs("; Where the camera is stands here as none (rotation, translation), and pixel is that of\n"
		      "; a sensor of 36 mm: use it as inlay-calibrate camera --intrinsics.\n",
		      to);
	else
		fputs("; How the camera is turned stands here as not at all (rotation), and what the lens loses\n"
		      "; to the rim as nothing (falloff).\n",
		      to);
	if (error_px > 0)
		fprintf(to, "; Fitted: it is off from what it was made of by at most %.3g px.\n",
			error_px);
	if (ini->camera_given)
		lens_write_keys(to, "camera", tsai_keys, &ini->camera);
	else
		lens_write_keys(to, "fisheye", fisheye_keys, &ini->fisheye);
}
