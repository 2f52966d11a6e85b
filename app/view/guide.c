/* SPDX-License-Identifier: MIT */
#include "app/view/show.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/view/panel.h"
#include "hal/lights/lamp/lamp_light.h"

#define STEPS 96     /* points of a line: lenses bend it */
#define GRID_HALF 10 /* lines on each side of the middle */
#define FAR 1e7	     /* as good as infinitely far, in the scene's units */
#define APART_DEG 20 /* least angle between two lights that are named */
#define STANDS_OUT 3 /* times the mean radiance */
#define DEG (M_PI / 180)

static const double grid_rgb[3] = {0.85, 0.85, 0.80};
static const double horizon_rgb[3] = {0.45, 0.75, 1.00};
static const double axis_rgb[3][3] = {{1.00, 0.35, 0.30}, {0.35, 0.90, 0.35}, {0.50, 0.60, 1.00}};
static const double light_rgb[3] = {1.00, 0.85, 0.25};
static const double lamp_rgb[3] = {0.35, 1.00, 0.85};
static const double outline_rgb[3] = {1.00, 0.55, 0.95};

/* ---- the ground ---- */

/* Point of the ground that a pixel shows. */
static bool ground_at(const struct tsai_camera *camera, double x, double y, double ground[2])
{
	const double px[2] = {x, y};
	double origin[3], dir[3], far;

	if (tsai_ray(camera, px, origin, dir) || !(dir[2] * origin[2] < 0))
		return false;
	far = -origin[2] / dir[2];
	ground[0] = origin[0] + far * dir[0];
	ground[1] = origin[1] + far * dir[1];
	return true;
}

/* The ground in the middle of the picture, or below it where the middle shows the sky; and how wide
 * a row of the picture is there. */
static bool find_middle(const struct tsai_camera *camera, double middle[2], double *across)
{
	for (int eighth = 4; eighth < 8; eighth++) {
		const double y = camera->height * eighth / 8.0;
		double left[2], right[2];

		if (!ground_at(camera, camera->width / 2.0, y, middle) ||
		    !ground_at(camera, 0.5, y, left) ||
		    !ground_at(camera, camera->width - 0.5, y, right))
			continue;
		*across = hypot(right[0] - left[0], right[1] - left[1]);
		return *across > 0;
	}
	return false;
}

double guide_spacing(const struct tsai_camera *camera)
{
	double middle[2], across, power, lead;

	if (!find_middle(camera, middle, &across))
		return 0;
	power = pow(10, floor(log10(across / 8)));
	lead = across / 8 / power;
	return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

/* ---- the ground ---- */

static void project_into(const struct tsai_camera *camera, const double world[3], double px[2])
{
	if (tsai_project(camera, world, px))
		px[0] = px[1] = NAN;
}

static void draw_segment(struct pen *pen, const struct tsai_camera *camera, const double from[3],
			 const double to[3], const double rgb[3], double width)
{
	double points[STEPS + 1][2];

	for (int i = 0; i <= STEPS; i++) {
		const double t = (double)i / STEPS;
		double world[3];

		for (int c = 0; c < 3; c++)
			world[c] = from[c] + t * (to[c] - from[c]);
		project_into(camera, world, points[i]);
	}
	pen_line(pen, (const double(*)[2])points, STEPS + 1, rgb, width);
}

static void draw_grid(struct pen *pen, const struct tsai_camera *camera, double spacing)
{
	double middle[2], across, reach = GRID_HALF * spacing, first[2];

	if (!find_middle(camera, middle, &across))
		return;
	for (int c = 0; c < 2; c++)
		first[c] = (round(middle[c] / spacing) - GRID_HALF) * spacing;
	for (int i = 0; i <= 2 * GRID_HALF; i++)
		for (int c = 0; c < 2; c++) { /* c: the axis that the line runs along */
			double from[3] = {0}, to[3] = {0};

			from[c] = first[c];
			to[c] = first[c] + 2 * reach;
			from[1 - c] = to[1 - c] = first[1 - c] + i * spacing;
			draw_segment(pen, camera, from, to, grid_rgb, 0.5);
		}
}

static void draw_axes(struct pen *pen, const struct tsai_camera *camera, double length)
{
	static const char *const names[] = {"X", "Y", "Z"};

	for (int c = 0; c < 3; c++) {
		const double origin[3] = {0};
		double end[3] = {0}, at[3] = {0}, px[2];

		end[c] = length;
		at[c] = 1.08 * length;
		draw_segment(pen, camera, origin, end, axis_rgb[c], 1.5);
		project_into(camera, at, px);
		pen_text(pen, px, names[c], axis_rgb[c]);
	}
}

static void draw_horizon(struct pen *pen, const struct tsai_camera *camera)
{
	double points[4 * STEPS + 1][2];

	for (int i = 0; i <= 4 * STEPS; i++) {
		const double azimuth = 2 * M_PI * i / (4 * STEPS);
		const double world[3] = {FAR * cos(azimuth), FAR * sin(azimuth), 0};

		project_into(camera, world, points[i]);
	}
	pen_line(pen, (const double(*)[2])points, 4 * STEPS + 1, horizon_rgb, 1);
}

/* Marks pixels of the object that have one of the ground beside them. */
static void draw_outline(struct canvas *canvas, const uint16_t *coverage)
{
	const int width = canvas->width, height = canvas->height;

	for (int y = 1; y + 1 < height; y++)
		for (int x = 1; x + 1 < width; x++) {
			const uint16_t *at = coverage + (size_t)y * (size_t)width + x;
			uint8_t *pixel = canvas->pixels + (size_t)y * canvas->stride +
					 4 * (size_t)x;

			if (at[0] < 32768 || (at[-1] >= 32768 && at[1] >= 32768 &&
					      at[-width] >= 32768 && at[width] >= 32768))
				continue;
			for (int c = 0; c < 3; c++)
				pixel[2 - c] = (uint8_t)lrint(255 * outline_rgb[c]);
		}
}

static void draw_feet(struct pen *pen, const struct tsai_camera *camera,
		      const struct guide_lamps *lamps, double letter_px)
{
	for (int l = 0; lamps->lamps && l < lamps->lamps->count; l++) {
		const double *at = lamps->lamps->lamp[l].position;
		const double foot[3] = {at[0], at[1], 0};
		double px[2];

		draw_segment(pen, camera, foot, at, lamp_rgb, 1);
		project_into(camera, foot, px);
		if (!(px[0] >= 0 && px[0] < camera->width && px[1] >= 0 && px[1] < camera->height))
			continue;
		pen_ring(pen, px, letter_px / 4, lamp_rgb);
		px[1] += letter_px;
		pen_text(pen, px, lamps->name[l], lamp_rgb);
	}
}

void guide_draw_ground(struct canvas *canvas, const struct tsai_camera *camera,
		       const uint16_t *coverage, const struct guide_lamps *lamps, double letter_px)
{
	const double spacing = guide_spacing(camera);
	const double corner[2] = {canvas->width, canvas->height};
	struct pen *pen;
	char text[64];

	if (coverage)
		draw_outline(canvas, coverage);
	pen = pen_take(canvas, letter_px);
	draw_horizon(pen, camera);
	if (spacing > 0) {
		draw_grid(pen, camera, spacing);
		draw_axes(pen, camera, 2 * spacing);
		snprintf(text, sizeof(text), "a square is %.4g units", spacing);
		pen_text(pen, corner, text, grid_rgb);
	}
	draw_feet(pen, camera, lamps, letter_px);
	pen_drop(pen);
}

/* ---- the sky ---- */

static void direction_of(double azimuth, double height, double dir[3])
{
	dir[0] = cos(height) * cos(azimuth);
	dir[1] = cos(height) * sin(azimuth);
	dir[2] = sin(height);
}

static void project_sky(const struct fisheye *lens, const double dir[3], double px[2])
{
	if (!fisheye_project(lens, dir, px))
		px[0] = px[1] = NAN;
}

/* The edge of the field, a circle about the lens's own axis. */
static void draw_field(struct pen *pen, const struct fisheye *lens)
{
	const double theta = lens->field_rad * (1 - 1e-6);
	double points[STEPS + 1][2];

	for (int i = 0; i <= STEPS; i++) {
		const double phi = 2 * M_PI * i / STEPS;
		const double camera[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
		double dir[3];

		for (int c = 0; c < 3; c++) /* camera = R dir, so dir = R^T camera */
			dir[c] = lens->rotation[c] * camera[0] + lens->rotation[3 + c] * camera[1] +
				 lens->rotation[6 + c] * camera[2];
		project_sky(lens, dir, points[i]);
	}
	pen_line(pen, (const double(*)[2])points, STEPS + 1, grid_rgb, 1);
}

static void draw_height(struct pen *pen, const struct fisheye *lens, double height_deg,
			const double rgb[3], double width)
{
	double points[STEPS + 1][2], dir[3];

	for (int i = 0; i <= STEPS; i++) {
		direction_of(2 * M_PI * i / STEPS, height_deg * DEG, dir);
		project_sky(lens, dir, points[i]);
	}
	pen_line(pen, (const double(*)[2])points, STEPS + 1, rgb, width);
}

/* From the zenith towards the horizon, with the axis's name at the end. */
static void draw_compass(struct pen *pen, const struct fisheye *lens, int axis)
{
	static const char *const names[] = {"X", "Y"};
	double points[STEPS + 1][2], dir[3], at[2];

	for (int i = 0; i <= STEPS; i++) {
		direction_of(axis * M_PI / 2, (90 - 80.0 * i / STEPS) * DEG, dir);
		project_sky(lens, dir, points[i]);
	}
	pen_line(pen, (const double(*)[2])points, STEPS + 1, axis_rgb[axis], 1.5);
	direction_of(axis * M_PI / 2, 5 * DEG, dir);
	project_sky(lens, dir, at);
	pen_text(pen, at, names[axis], axis_rgb[axis]);
}

static double brightness(const float rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; /* luminance of BT.709 */
}

/* Whether a light is within APART_DEG of one that was found. */
static bool is_beside(const struct dome *dome, int light, const struct guide_light *found,
		      int count)
{
	for (int i = 0; i < count; i++) {
		const double *a = dome->direction[light], *b = dome->direction[found[i].light];

		if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > cos(APART_DEG * DEG))
			return true;
	}
	return false;
}

int guide_find_lights(const struct dome *dome, const float (*radiance)[3],
		      struct guide_light found[GUIDE_LIGHTS])
{
	double mean = 0;
	int count = 0;

	for (int i = 0; i < dome->count; i++)
		mean += brightness(radiance[i]) * dome->solid_angle_sr[i] / (2 * M_PI);
	while (count < GUIDE_LIGHTS) {
		double most = STANDS_OUT * mean, azimuth;
		int best = -1;

		for (int i = 0; i < dome->count; i++) {
			if (brightness(radiance[i]) > most && !is_beside(dome, i, found, count)) {
				most = brightness(radiance[i]);
				best = i;
			}
		}
		if (best < 0)
			break;
		azimuth = atan2(dome->direction[best][1], dome->direction[best][0]) / DEG;
		found[count++] =
			(struct guide_light){best, azimuth < 0 ? azimuth + 360 : azimuth,
					     asin(fmin(1, dome->direction[best][2])) / DEG};
	}
	return count;
}

static void draw_lights(struct pen *pen, const struct fisheye *lens, const struct dome *dome,
			const float (*radiance)[3], double letter_px)
{
	struct guide_light found[GUIDE_LIGHTS];
	const int count = guide_find_lights(dome, radiance, found);

	for (int i = 0; i < count; i++) {
		double at[2];
		char text[48];

		project_sky(lens, dome->direction[found[i].light], at);
		pen_ring(pen, at, letter_px / 2, light_rgb);
		at[1] += 1.3 * letter_px;
		snprintf(text, sizeof(text), "%.0f\u00b0, %.0f\u00b0 high", found[i].azimuth_deg,
			 found[i].height_deg);
		pen_text(pen, at, text, light_rgb);
	}
}

static void draw_lamps(struct pen *pen, const struct fisheye *lens, const struct guide_lamps *lamps,
		       double letter_px)
{
	for (int l = 0; lamps->lamps && l < lamps->lamps->count; l++) {
		double dir[3], px[2], radius;
		char text[CONFIG_NAME_MAX + 16];

		if (!lamp_light_seen(lamps->lamps, l, dir, &radius) ||
		    !fisheye_project(lens, dir, px))
			continue;
		radius /= sqrt(fisheye_pixel_sr(lens, px));
		pen_ring(pen, px, fmax(radius, letter_px / 4), lamp_rgb);
		px[1] -= radius + letter_px;
		snprintf(text, sizeof(text), "%s%s", lamps->name[l],
			 lamps->missing[l] ? ": no light" : "");
		pen_text(pen, px, text, lamp_rgb);
	}
}

void guide_draw_sky(struct canvas *canvas, const struct fisheye *lens, const struct dome *dome,
		    const float (*radiance)[3], const struct guide_lamps *lamps, double letter_px)
{
	struct pen *pen = pen_take(canvas, letter_px);

	draw_field(pen, lens);
	draw_height(pen, lens, 0.01, horizon_rgb, 1);
	draw_height(pen, lens, 30, grid_rgb, 0.5);
	draw_height(pen, lens, 60, grid_rgb, 0.5);
	for (int axis = 0; axis < 2; axis++)
		draw_compass(pen, lens, axis);
	if (radiance)
		draw_lights(pen, lens, dome, radiance, letter_px);
	draw_lamps(pen, lens, lamps, letter_px);
	pen_drop(pen);
}
