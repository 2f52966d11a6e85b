/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/panorama.h"

enum { SIDE_MAX = 4, RIM_SIDE = 8 };

struct panorama_view {
	int width, height;
	struct image image;
	int side; /* a pixel has side x side samples */
	/* Positions of the samples in the unturned panorama, [height][width][side * side][2], in
	 * its pixels, whose centres are whole numbers; NAN: nothing is seen. */
	float *places;
	float *share; /* [height][width]: part of the pixel that lies in the field of view, 0..1 */
};

static int samples_per_side(const struct sim_eye *eye, const struct image *image)
{
	const double middle[2] = {eye->width / 2.0, eye->height / 2.0};
	const double pixel_rad = eye_pixel_rad(eye, middle);
	const int side = (int)ceil(pixel_rad * image->width / (2 * M_PI));

	return side < 2 ? 2 : side > SIDE_MAX ? SIDE_MAX : side;
}

static void view_place(const struct panorama_view *view, const struct sim_eye *eye,
		       const double px[2], float at[2])
{
	double origin[3], dir[3];

	at[0] = at[1] = NAN;
	if (!eye_ray(eye, px, origin, dir))
		return;
	at[0] = (float)(view->image.width * (0.5 - atan2(dir[1], dir[0]) / (2 * M_PI)) - 0.5);
	at[1] = (float)(view->image.height * atan2(hypot(dir[0], dir[1]), dir[2]) / M_PI - 0.5);
}

/* Handles a pixel on the rim: takes samples from the part in the field of view, and returns the
 * share of that part. */
static float place_rim(const struct panorama_view *view, const struct sim_eye *eye, int x, int y,
		       float *at)
{
	float seen[RIM_SIDE * RIM_SIDE][2];
	int count = 0;

	for (int i = 0; i < RIM_SIDE * RIM_SIDE; i++) {
		const double px[2] = {x + (i % RIM_SIDE + 0.5) / RIM_SIDE,
				      y + (i / RIM_SIDE + 0.5) / RIM_SIDE};

		view_place(view, eye, px, seen[count]);
		count += !isnan(seen[count][0]);
	}
	for (int i = 0; i < view->side * view->side; i++)
		for (int k = 0; k < 2; k++)
			at[2 * i + k] = count ? seen[i * count / (view->side * view->side)][k]
					      : NAN;
	return (float)count / (RIM_SIDE * RIM_SIDE);
}

static float place_pixel(const struct panorama_view *view, const struct sim_eye *eye, int x, int y,
			 float *at)
{
	const int side = view->side;

	if (eye_on_rim(eye, x, y))
		return place_rim(view, eye, x, y, at);
	for (int i = 0; i < side * side; i++, at += 2) {
		const double px[2] = {x + (i % side + 0.5) / side, y + (i / side + 0.5) / side};

		view_place(view, eye, px, at);
	}
	return 1;
}

static void place_all(struct panorama_view *view, const struct sim_eye *eye)
{
	float *at = view->places, *share = view->share;

	for (int y = 0; y < view->height; y++)
		for (int x = 0; x < view->width; x++, at += 2 * view->side * view->side)
			*share++ = place_pixel(view, eye, x, y, at);
}

int panorama_view_create(struct panorama_view **view, const char *path, const struct sim_eye *eye,
			 struct fault *fault)
{
	struct panorama_view *v = calloc(1, sizeof(*v));
	int err;

	*view = NULL;
	if (!v)
		return fault_say(fault, -ENOMEM, "%s: no memory for the panorama", path);
	v->width = eye->width;
	v->height = eye->height;
	err = panorama_read(&v->image, path, fault);
	if (err)
		goto fail;
	v->side = samples_per_side(eye, &v->image);
	v->places = malloc((size_t)v->width * (size_t)v->height * (size_t)(v->side * v->side) * 2 *
			   sizeof(float));
	v->share = malloc((size_t)v->width * (size_t)v->height * sizeof(float));
	if (!v->places || !v->share) {
		err = fault_say(fault, -ENOMEM, "%s: no memory for the view", path);
		goto fail;
	}
	place_all(v, eye);
	*view = v;
	return 0;
fail:
	panorama_view_destroy(v);
	return err;
}

void panorama_view_destroy(struct panorama_view *view)
{
	if (!view)
		return;
	image_free(&view->image);
	free(view->places);
	free(view->share);
	free(view);
}

/* x lies in [0, 2 * width): wrapping is one subtraction. */
static void panorama_add_sample(const struct image *image, float x, float y, float sum[3])
{
	const float fy = floorf(y);
	const int column = (int)x, row = (int)fy;
	const float u = x - (float)column, v = y - fy;
	const int left = column < image->width ? column : column - image->width;
	const int right = left + 1 < image->width ? left + 1 : 0;
	const int above = row < 0 ? 0 : row;
	const int below = row + 1 < image->height ? row + 1 : image->height - 1;
	const size_t width = (size_t)image->width;
	const float *a = image->f32 + 3 * ((size_t)above * width + (size_t)left);
	const float *b = image->f32 + 3 * ((size_t)above * width + (size_t)right);
	const float *c = image->f32 + 3 * ((size_t)below * width + (size_t)left);
	const float *d = image->f32 + 3 * ((size_t)below * width + (size_t)right);

	for (int i = 0; i < 3; i++) {
		const float top = a[i] + u * (b[i] - a[i]), bottom = c[i] + u * (d[i] - c[i]);

		sum[i] += top + v * (bottom - top);
	}
}

void panorama_view_render(const struct panorama_view *view, double turn_rad, float *rgb)
{
	const size_t pixels = (size_t)view->width * (size_t)view->height;
	const int samples = view->side * view->side;
	const double turns = turn_rad / (2 * M_PI);
	/* x is at least -0.5 before the shift, so one width more makes it positive. By rounding, x
	 * may be exactly 2 widths. */
	const float shift = (float)((turns - floor(turns)) * view->image.width);
	const float *at = view->places;

	for (size_t p = 0; p < pixels; p++, rgb += 3) {
		float sum[3] = {0, 0, 0};
		int seen = 0;

		for (int i = 0; i < samples; i++, at += 2) {
			float x = at[0] + shift;

			if (isnan(x))
				continue;
			if (x < 0)
				x += (float)view->image.width;
			if (x >= 2 * (float)view->image.width)
				x = 0;
			panorama_add_sample(&view->image, x, at[1], sum);
			seen++;
		}
		for (int c = 0; c < 3; c++)
			rgb[c] = seen ? view->share[p] * sum[c] / (float)seen : 0;
	}
}
