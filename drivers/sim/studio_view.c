/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

/* The values kept for each pixel, one float each. A row of pixels holds LANES runs of width
 * floats. */
enum lane {
	POINT_X,
	POINT_Y,
	POINT_Z,
	NORMAL_X,
	NORMAL_Y,
	NORMAL_Z,
	PAINT_R, /* albedo / pi */
	PAINT_G,
	PAINT_B,
	STEADY_R, /* radiance without the lanterns, panels on */
	STEADY_G,
	STEADY_B,
	PANELS_R, /* of it, by the panels */
	PANELS_G,
	PANELS_B,
	DIR_X,
	DIR_Y,
	DIR_Z,
	PIXEL_RAD,
	SHARE, /* part of the pixel that sees the room; below 1 on the rim of a fisheye's circle */
	LANES
};

/* Samples along a side of a pixel: where it sees one surface, and where it sees several. */
enum { COARSE = 2, FINE = 5 };

struct studio_view {
	int width, height;
	struct sim_eye eye;
	double origin[3];
	float *lanes; /* [height][LANES][width] */
};

/* Sums over the samples of a pixel that hit the room. */
struct pixel_patch {
	int count;
	struct studio_hit first, last;
	bool mixed; /* the samples differ in surface, albedo or emission */
	double paint[3], steady[3], panels[3];
	double last_irradiance[3], last_panels[3];
};

static bool hit_differs(const struct studio_hit *a, const struct studio_hit *b)
{
	if (a->surface != b->surface)
		return true;
	for (int c = 0; c < 3; c++)
		if (fabs(a->albedo[c] - b->albedo[c]) > 0.02 || a->emitted[c] != b->emitted[c])
			return true;
	return false;
}

static void patch_irradiate(const struct studio_hit *hit, struct pixel_patch *patch)
{
	double without[3];

	studio_steady_irradiance(hit->point, hit->surface, 1, patch->last_irradiance);
	studio_steady_irradiance(hit->point, hit->surface, 0, without);
	for (int c = 0; c < 3; c++)
		patch->last_panels[c] = patch->last_irradiance[c] - without[c];
}

static void patch_add(const struct sim_eye *eye, const double px[2], double origin[3],
		      struct pixel_patch *patch)
{
	struct studio_hit hit;
	double dir[3];

	if (!eye_ray(eye, px, origin, dir) || !studio_hit(origin, dir, &hit))
		return;
	/* Within a pixel the steady irradiance is nearly constant on one surface. */
	if (patch->count == 0 || hit.surface != patch->last.surface)
		patch_irradiate(&hit, patch);
	if (patch->count == 0)
		patch->first = hit;
	else if (hit_differs(&hit, &patch->first))
		patch->mixed = true;
	patch->last = hit;
	patch->count++;
	for (int c = 0; c < 3; c++) {
		patch->paint[c] += hit.albedo[c] / M_PI;
		patch->steady[c] += hit.emitted[c] +
				    hit.albedo[c] / M_PI * patch->last_irradiance[c];
		patch->panels[c] += (hit.surface == STUDIO_CEILING ? hit.emitted[c] : 0) +
				    hit.albedo[c] / M_PI * patch->last_panels[c];
	}
}

static void patch_fill(const struct sim_eye *eye, int x, int y, int side, double origin[3],
		       struct pixel_patch *patch)
{
	memset(patch, 0, sizeof(*patch));
	for (int j = 0; j < side; j++)
		for (int i = 0; i < side; i++) {
			const double px[2] = {x + (i + 0.5) / side, y + (j + 0.5) / side};

			patch_add(eye, px, origin, patch);
		}
}

static void prepare_pixel(struct studio_view *view, const struct sim_eye *eye, int x, int y)
{
	float *lane = view->lanes + (size_t)y * LANES * (size_t)view->width + x;
	const size_t step = (size_t)view->width;
	const double middle[2] = {x + 0.5, y + 0.5};
	double origin[3], dir[3];
	struct pixel_patch patch;
	int side = eye_on_rim(eye, x, y) ? FINE : COARSE;

	patch_fill(eye, x, y, side, origin, &patch);
	if (patch.mixed && side < FINE) {
		side = FINE;
		patch_fill(eye, x, y, side, origin, &patch);
	}
	if (patch.count == 0)
		return;
	memcpy(view->origin, origin, sizeof(origin));
	for (int i = 0; i < 3; i++) {
		dir[i] = patch.first.point[i] - origin[i];
		lane[(POINT_X + i) * step] = (float)patch.first.point[i];
		lane[(NORMAL_X + i) * step] = (float)studio_normals[patch.first.surface][i];
		lane[(PAINT_R + i) * step] = (float)(patch.paint[i] / (side * side));
		lane[(STEADY_R + i) * step] = (float)(patch.steady[i] / (side * side));
		lane[(PANELS_R + i) * step] = (float)(patch.panels[i] / (side * side));
	}
	if (!eye_ray(eye, middle, origin, dir))
		vec_normalize(dir); /* at the rim of the field the middle may lie outside */
	for (int i = 0; i < 3; i++)
		lane[(DIR_X + i) * step] = (float)dir[i];
	lane[SHARE * step] = (float)patch.count / (float)(side * side);
	lane[PIXEL_RAD * step] = (float)fmax(eye_pixel_rad(eye, middle), 1e-6);
}

int studio_view_create(struct studio_view **view, const struct sim_eye *eye)
{
	struct studio_view *v = calloc(1, sizeof(*v));

	*view = NULL;
	if (!v)
		return -ENOMEM;
	v->eye = *eye;
	v->width = eye->width;
	v->height = eye->height;
	v->lanes = calloc((size_t)eye->width * (size_t)eye->height * LANES, sizeof(float));
	if (!v->lanes) {
		free(v);
		return -ENOMEM;
	}
	for (int y = 0; y < v->height; y++)
		for (int x = 0; x < v->width; x++)
			prepare_pixel(v, eye, x, y);
	*view = v;
	return 0;
}

void studio_view_destroy(struct studio_view *view)
{
	if (!view)
		return;
	free(view->lanes);
	free(view);
}

/* A lantern, prepared for one frame. */
struct glow {
	float centre[3], radius2_pi, radiance[3];
	float to[3], cosine, sine; /* direction and angular radius, seen from the camera */
	double distance;
};

static void prepare_glow(const struct studio_lantern *lantern, const double origin[3],
			 struct glow *glow)
{
	double to[3];

	for (int i = 0; i < 3; i++) {
		to[i] = lantern->centre[i] - origin[i];
		glow->centre[i] = (float)lantern->centre[i];
		glow->radiance[i] = (float)lantern->radiance[i];
	}
	glow->radius2_pi = (float)(M_PI * lantern->radius * lantern->radius);
	glow->distance = vec_normalize(to);
	for (int i = 0; i < 3; i++)
		glow->to[i] = (float)to[i];
	/* A camera inside the lantern sees nothing else: no cosine is below -2. */
	glow->sine = (float)fmin(lantern->radius / glow->distance, 1);
	glow->cosine = glow->distance > lantern->radius ? sqrtf(1 - glow->sine * glow->sine) : -2;
}

/* Adds the lanterns' light on the surfaces; dark is the share of the panels that is off. The loop
 * has no branches and no calls but sqrtf(), so that compilers vectorise it. */
static void light_row(const float *restrict lanes, int width, const struct glow *glows, float dark,
		      float *restrict rgb)
{
	const struct glow a = glows[0], b = glows[1];
	const size_t w = (size_t)width;

	for (size_t x = 0; x < w; x++) {
		const float px = lanes[POINT_X * w + x], py = lanes[POINT_Y * w + x],
			    pz = lanes[POINT_Z * w + x];
		const float nx = lanes[NORMAL_X * w + x], ny = lanes[NORMAL_Y * w + x],
			    nz = lanes[NORMAL_Z * w + x];
		const float ax = a.centre[0] - px, ay = a.centre[1] - py, az = a.centre[2] - pz;
		const float bx = b.centre[0] - px, by = b.centre[1] - py, bz = b.centre[2] - pz;
		const float a2 = ax * ax + ay * ay + az * az, b2 = bx * bx + by * by + bz * bz;
		float ea = a.radius2_pi * (ax * nx + ay * ny + az * nz) / (a2 * sqrtf(a2));
		float eb = b.radius2_pi * (bx * nx + by * ny + bz * nz) / (b2 * sqrtf(b2));

		ea = ea > 0 ? ea : 0;
		eb = eb > 0 ? eb : 0;
		for (int c = 0; c < 3; c++)
			rgb[3 * x + (size_t)c] = lanes[(size_t)(STEADY_R + c) * w + x] -
						 dark * lanes[(size_t)(PANELS_R + c) * w + x] +
						 lanes[(size_t)(PAINT_R + c) * w + x] *
							 (ea * a.radiance[c] + eb * b.radiance[c]);
	}
}

/* Returns the share that a lantern covers of a pixel on the lantern's rim. */
static float rim_coverage(const struct studio_view *view, const struct glow *glow, int x, int y)
{
	int seen = 0, covered = 0;

	for (int i = 0; i < FINE * FINE; i++) {
		const double px[2] = {x + (i % FINE + 0.5) / FINE, y + (i / FINE + 0.5) / FINE};
		double origin[3], dir[3];

		if (!eye_ray(&view->eye, px, origin, dir))
			continue;
		seen++;
		covered += dir[0] * glow->to[0] + dir[1] * glow->to[1] + dir[2] * glow->to[2] >
			   glow->cosine;
	}
	return seen ? (float)covered / (float)seen : 0;
}

/* Draws the lantern itself over what is behind it. */
static void draw_lantern(const struct studio_view *view, const float *lanes, int y,
			 const struct glow *glow, float *rgb)
{
	const size_t w = (size_t)view->width;

	for (size_t x = 0; x < w; x++) {
		const float cosine = lanes[DIR_X * w + x] * glow->to[0] +
				     lanes[DIR_Y * w + x] * glow->to[1] +
				     lanes[DIR_Z * w + x] * glow->to[2];
		/* On any lens, the corners of a pixel are nearer to its middle than this. */
		const float rim = 1.2f * glow->sine * lanes[PIXEL_RAD * w + x] + 1e-6f;
		float coverage = 1;

		if (lanes[PIXEL_RAD * w + x] == 0 || cosine < glow->cosine - rim)
			continue;
		if (cosine < glow->cosine + rim)
			coverage = rim_coverage(view, glow, (int)x, y);
		for (size_t c = 0; c < 3; c++)
			rgb[3 * x + c] += coverage * (lanes[SHARE * w + x] * glow->radiance[c] -
						      rgb[3 * x + c]);
	}
}

static void render_row(const struct studio_view *view, int y, const struct glow *glows,
		       const struct studio_lamps *lamps, float *rgb)
{
	const double panels = lamps->panels *
			      mains_row(&lamps->mains, lamps->time_s, y, view->height);
	const float *lanes = view->lanes + (size_t)y * LANES * (size_t)view->width;

	light_row(lanes, view->width, glows, (float)(1 - panels), rgb);
	for (int i = 0; i < STUDIO_LANTERNS; i++)
		draw_lantern(view, lanes, y, &glows[i], rgb);
}

void studio_view_render(const struct studio_view *view, const struct studio_lamps *lamps,
			float *rgb)
{
	struct glow glows[STUDIO_LANTERNS], nearer;

	_Static_assert(STUDIO_LANTERNS == 2, "light_row() takes two");
	for (int i = 0; i < STUDIO_LANTERNS; i++)
		prepare_glow(&lamps->lantern[i], view->origin, &glows[i]);
	if (glows[0].distance < glows[1].distance) { /* the nearer one is drawn last */
		nearer = glows[0];
		glows[0] = glows[1];
		glows[1] = nearer;
	}
	for (int y = 0; y < view->height; y++)
		render_row(view, y, glows, lamps, rgb + (size_t)y * (size_t)view->width * 3);
}

struct studio_ground studio_view_ground(const struct studio_view *view, int x, int y)
{
	const size_t step = (size_t)view->width;
	const float *lane = view->lanes + (size_t)y * LANES * step + x;
	struct studio_ground ground;

	for (size_t i = 0; i < 3; i++) {
		ground.point[i] = lane[(POINT_X + i) * step];
		ground.normal[i] = lane[(NORMAL_X + i) * step];
		ground.paint[i] = lane[(PAINT_R + i) * step];
	}
	return ground;
}

void studio_view_paint(struct studio_view *view, int x, int y, const double factor[3])
{
	const size_t step = (size_t)view->width;
	float *lane = view->lanes + (size_t)y * LANES * step + x;

	for (size_t i = 0; i < 3; i++) {
		lane[(PAINT_R + i) * step] *= (float)factor[i];
		lane[(STEADY_R + i) * step] *= (float)factor[i];
		lane[(PANELS_R + i) * step] *= (float)factor[i];
	}
}

const struct sim_eye *studio_view_eye(const struct studio_view *view)
{
	return &view->eye;
}

void studio_view_depth(const struct studio_view *view, const struct studio_lamps *lamps, float *z)
{
	for (int y = 0; y < view->height; y++)
		for (int x = 0; x < view->width; x++) {
			double origin[3], dir[3];
			const double along = eye_along_axis(&view->eye, x, y, origin, dir);
			struct studio_hit hit;
			float *to = &z[y * view->width + x];

			*to = 0;
			if (along > 0 && studio_hit(origin, dir, &hit) &&
			    studio_lantern_hit(lamps, origin, dir, hit.distance) < 0)
				*to = (float)(along * hit.distance);
		}
}
