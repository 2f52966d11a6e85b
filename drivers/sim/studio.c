/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "hal/optics/vec.h"

static const double half_x = 3, half_y = 2.5, height = 3;

const double studio_normals[STUDIO_SURFACE_COUNT][3] = {
	{0, 0, 1}, {0, 0, -1}, {-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0},
};

/* A rectangular light source on a surface. */
struct emitter {
	enum studio_surface surface;
	double low[2], high[2]; /* in the surface's coordinates: surface_uv() */
	double radiance[3];
	double share; /* luminous part of the rectangle: the window has bars */
};

enum { PANEL_EAST, PANEL_WEST, WINDOW, EMITTER_COUNT };

static const double bar_m = 0.05;

static const struct emitter emitters[EMITTER_COUNT] = {
	[PANEL_EAST] = {STUDIO_CEILING, {0.95, -0.7}, {1.45, 0.7}, {2.0, 1.8, 1.45}, 1},
	[PANEL_WEST] = {STUDIO_CEILING, {-1.45, -0.7}, {-0.95, 0.7}, {2.0, 1.8, 1.45}, 1},
	[WINDOW] = {STUDIO_WALL_WEST,
		    {-1.0, 0.9},
		    {0.6, 2.1},
		    {1.7, 2.1, 2.7},
		    (1.6 - 0.05) * (1.2 - 0.05) / (1.6 * 1.2)},
};

/* Irradiance by light from all other surfaces, assumed equal everywhere. */
const double studio_ambient_irradiance[3] = {0.33, 0.31, 0.28};

/* Index of the axis that is normal to a surface. */
static int surface_axis(enum studio_surface surface)
{
	return surface <= STUDIO_CEILING ? 2 : surface <= STUDIO_WALL_WEST ? 0 : 1;
}

/* Coordinate of a surface on that axis. */
static double surface_place(enum studio_surface surface)
{
	static const double place[STUDIO_SURFACE_COUNT] = {0,	    height, half_x,
							   -half_x, half_y, -half_y};

	return place[surface];
}

/* Coordinates on a surface: those of the other two axes, in the order x, y, z. */
static void surface_uv(enum studio_surface surface, const double point[3], double uv[2])
{
	const int axis = surface_axis(surface);

	uv[0] = point[axis == 0 ? 1 : 0];
	uv[1] = point[axis == 2 ? 1 : 2];
}

struct studio_lamps studio_lamps(double time_s, double switch_s)
{
	struct studio_lamps lamps = {.time_s = time_s};
	/* A turn takes 12 s. The cool lantern leads by a varying angle, so that they never meet. */
	const double turn = 2 * M_PI * time_s / 12 - 0.9;
	const double ahead = turn + 2.6 + 0.4 * sin(2 * M_PI * time_s / 20);

	lamps.lantern[0] = (struct studio_lantern){
		.centre = {1.15 * cos(turn), 0.95 * sin(turn), 1.55 + 0.2 * sin(2 * turn)},
		.radius = 0.32,
		.radiance = {5.2, 3.6, 1.9},
	};
	lamps.lantern[1] = (struct studio_lantern){
		.centre = {1.25 * cos(ahead), 1.05 * sin(ahead), 1.75 + 0.15 * cos(2 * ahead)},
		.radius = 0.30,
		.radiance = {1.5, 2.4, 3.9},
	};
	lamps.panels = switch_s > 0 && fmod(floor(time_s / switch_s), 2) != 0 ? 0 : 1;
	return lamps;
}

double studio_chance(uint32_t a, uint32_t b)
{
	uint32_t h = a * 0x9e3779b1u ^ b * 0x85ebca77u;

	h ^= h >> 15;
	h *= 0x2c1b3c6du;
	h ^= h >> 12;
	h *= 0x297a2d39u;
	h ^= h >> 15;
	return h / 4294967295.0;
}

static void rgb_set(double rgb[3], double r, double g, double b)
{
	rgb[0] = r;
	rgb[1] = g;
	rgb[2] = b;
}

static void rgb_scale(double rgb[3], double factor)
{
	for (int c = 0; c < 3; c++)
		rgb[c] *= factor;
}

/* Oak boards along x: each has its own tone, with a faint grain and dark seams. */
static void boards_albedo(double x, double y, double albedo[3])
{
	const double width = 0.14, length = 1.3, seam = 0.003;
	const double row = floor(y / width);
	const double shifted = x + length * studio_chance((uint32_t)(int32_t)row, 7);
	const double column = floor(shifted / length);
	const double across = y - row * width, along = shifted - column * length;
	const double tone = studio_chance((uint32_t)(int32_t)row,
					  (uint32_t)((int32_t)column + 100));
	const double grain = sin(across * 210 + 9 * tone + 1.5 * sin(along * 5 + 6 * tone)) +
			     0.5 * sin(across * 530 + 3 * sin(along * 3 + 20 * tone));

	rgb_set(albedo, 0.56, 0.36, 0.20);
	rgb_scale(albedo, 0.82 + 0.3 * tone + 0.035 * grain);
	if (across < seam || along < seam)
		rgb_scale(albedo, 0.45);
}

/* A round rug under the object, plain inside so that shadows are clearly visible. False: the point
 * lies beside it. */
static bool rug_albedo(double x, double y, double albedo[3])
{
	const double r = hypot(x, y), edge = 0.85;
	const double azimuth = atan2(y, x);

	if (r > edge)
		return false;
	rgb_set(albedo, 0.68, 0.59, 0.45);
	if (r > edge - 0.05 || (r > 0.60 && r < 0.615))
		rgb_set(albedo, 0.10, 0.22, 0.26);
	else if (r > edge - 0.19 && r < edge - 0.11)
		rgb_set(albedo,
			sin(azimuth * 48) * sin(M_PI * (r - edge + 0.19) / 0.08) > 0.35 ? 0.20
											: 0.52,
			0.15, 0.11);
	/* The weave. */
	rgb_scale(albedo, 1 + 0.012 * sin(r * 300));
	return true;
}

static void floor_albedo(const double uv[2], double albedo[3])
{
	if (!rug_albedo(uv[0], uv[1], albedo))
		boards_albedo(uv[0], uv[1], albedo);
}

static bool uv_is_inside(const double uv[2], double low0, double high0, double low1, double high1)
{
	return uv[0] >= low0 && uv[0] < high0 && uv[1] >= low1 && uv[1] < high1;
}

/* A door, a window frame and a picture make all walls look different. */
static void wall_albedo(enum studio_surface surface, const double uv[2], double albedo[3])
{
	if (uv[1] < 0.09) {
		rgb_set(albedo, 0.62, 0.60, 0.56); /* skirting */
		return;
	}
	switch (surface) {
	case STUDIO_WALL_EAST:
		rgb_set(albedo, 0.50, 0.22, 0.15); /* terracotta */
		if (uv_is_inside(uv, 0.3, 1.2, 0, 2.05))
			rgb_set(albedo, 0.28, 0.17, 0.10);
		break;
	case STUDIO_WALL_WEST:
		rgb_set(albedo, 0.24, 0.33, 0.38); /* slate blue */
		if (uv_is_inside(uv, -1.08, 0.68, 0.82, 2.18))
			rgb_set(albedo, 0.66, 0.65, 0.62); /* the window's frame */
		break;
	case STUDIO_WALL_NORTH:
		rgb_set(albedo, 0.30, 0.38, 0.24); /* sage */
		if (uv_is_inside(uv, -1.1, 0.3, 1.1, 2.0))
			rgb_set(albedo, 0.10, 0.09, 0.08);
		if (uv_is_inside(uv, -1.05, 0.25, 1.15, 1.95))
			rgb_set(albedo, 0.62 - 0.2 * (uv[1] - 1.15), 0.42,
				0.22 + 0.3 * (uv[1] - 1.15));
		break;
	default:
		rgb_set(albedo, 0.48, 0.44, 0.34); /* straw */
		break;
	}
}

/* Whether a point of the surface lies on the luminous part: a panel, or glass of the window. */
static bool emitter_shines(const struct emitter *e, const double uv[2])
{
	const double middle[2] = {(e->low[0] + e->high[0]) / 2, (e->low[1] + e->high[1]) / 2};

	if (!uv_is_inside(uv, e->low[0], e->high[0], e->low[1], e->high[1]))
		return false;
	return e->share == 1 ||
	       (fabs(uv[0] - middle[0]) >= bar_m / 2 && fabs(uv[1] - middle[1]) >= bar_m / 2);
}

static void hit_paint(struct studio_hit *hit)
{
	double uv[2];

	surface_uv(hit->surface, hit->point, uv);
	rgb_set(hit->emitted, 0, 0, 0);
	rgb_set(hit->albedo, 0, 0, 0);
	for (int i = 0; i < EMITTER_COUNT; i++) {
		if (emitters[i].surface == hit->surface && emitter_shines(&emitters[i], uv)) {
			memcpy(hit->emitted, emitters[i].radiance, sizeof(hit->emitted));
			return;
		}
	}
	if (hit->surface == STUDIO_FLOOR)
		floor_albedo(uv, hit->albedo);
	else if (hit->surface == STUDIO_CEILING)
		rgb_set(hit->albedo, 0.58, 0.57, 0.54);
	else
		wall_albedo(hit->surface, uv, hit->albedo);
}

bool studio_hit(const double origin[3], const double dir[3], struct studio_hit *hit)
{
	static const double low[3] = {-half_x, -half_y, 0}, high[3] = {half_x, half_y, height};
	double enter = -INFINITY, leave = INFINITY;
	int axis = 2;

	for (int i = 0; i < 3; i++) {
		const double near = dir[i] > 0 ? low[i] : high[i];
		const double far = dir[i] > 0 ? high[i] : low[i];

		if (dir[i] == 0) {
			if (origin[i] < low[i] || origin[i] > high[i])
				return false;
			continue;
		}
		enter = fmax(enter, (near - origin[i]) / dir[i]);
		if ((far - origin[i]) / dir[i] < leave) {
			leave = (far - origin[i]) / dir[i];
			axis = i;
		}
	}
	if (leave < enter || leave < 0 || !isfinite(leave))
		return false;
	if (axis == 2)
		hit->surface = dir[2] > 0 ? STUDIO_CEILING : STUDIO_FLOOR;
	else if (axis == 0)
		hit->surface = dir[0] > 0 ? STUDIO_WALL_EAST : STUDIO_WALL_WEST;
	else
		hit->surface = dir[1] > 0 ? STUDIO_WALL_NORTH : STUDIO_WALL_SOUTH;
	hit->distance = leave;
	for (int i = 0; i < 3; i++)
		hit->point[i] = origin[i] + leave * dir[i];
	hit->point[axis] = surface_place(hit->surface);
	hit_paint(hit);
	return true;
}

/* Irradiance by a rectangle of radiance 1 that lies wholly in front of the surface (Lambert's
 * formula). */
static double rectangle_irradiance(const double corners[4][3], const double point[3],
				   const double normal[3])
{
	double to[4][3], sum = 0;

	for (int i = 0; i < 4; i++) {
		for (int k = 0; k < 3; k++)
			to[i][k] = corners[i][k] - point[k];
		vec_normalize(to[i]);
	}
	for (int i = 0; i < 4; i++) {
		const double *a = to[i], *b = to[(i + 1) % 4];
		double across[3], sine;

		vec_cross(a, b, across);
		sine = vec_length(across);
		if (sine > 0)
			sum += atan2(sine, vec_dot(a, b)) * vec_dot(across, normal) / sine;
	}
	return fabs(sum) / 2; /* the sign depends on the orientation of the corners */
}

static void emitter_corners(const struct emitter *e, double corners[4][3])
{
	const int axis = surface_axis(e->surface);
	const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;

	for (int i = 0; i < 4; i++) {
		corners[i][axis] = surface_place(e->surface);
		corners[i][u] = i == 0 || i == 3 ? e->low[0] : e->high[0];
		corners[i][v] = i < 2 ? e->low[1] : e->high[1];
	}
}

void studio_steady_irradiance(const double point[3], enum studio_surface surface, double panels,
			      double rgb[3])
{
	memcpy(rgb, studio_ambient_irradiance, sizeof(studio_ambient_irradiance));
	for (int i = 0; i < EMITTER_COUNT; i++) {
		double corners[4][3], share;

		if (emitters[i].surface == surface)
			continue; /* lies in the same plane */
		emitter_corners(&emitters[i], corners);
		share = emitters[i].share * (i == WINDOW ? 1 : panels) *
			rectangle_irradiance(corners, point, studio_normals[surface]);
		for (int c = 0; c < 3; c++)
			rgb[c] += share * emitters[i].radiance[c];
	}
}

/* Divides an emitter into u x v pieces; returns the one after them. */
static struct studio_piece *emitter_pieces(const struct emitter *e, double level, int u, int v,
					   struct studio_piece *piece)
{
	const int axis = surface_axis(e->surface);
	const double size[2] = {(e->high[0] - e->low[0]) / u, (e->high[1] - e->low[1]) / v};
	const double area = size[0] * size[1];

	for (int k = 0; k < u * v; k++, piece++) {
		piece->place[axis] = surface_place(e->surface);
		piece->place[axis == 0 ? 1 : 0] = e->low[0] + (k % u + 0.5) * size[0];
		piece->place[axis == 2 ? 1 : 2] = e->low[1] + (k / u + 0.5) * size[1];
		piece->radius = sqrt(area / M_PI);
		for (int i = 0; i < 3; i++) {
			piece->facing[i] = studio_normals[e->surface][i];
			piece->power[i] = level * e->share * area * e->radiance[i];
		}
	}
	return piece;
}

void studio_pieces(const struct studio_lamps *lamps, struct studio_piece piece[STUDIO_PIECES])
{
	piece = emitter_pieces(&emitters[PANEL_EAST], lamps->panels, 1, 3, piece);
	piece = emitter_pieces(&emitters[PANEL_WEST], lamps->panels, 1, 3, piece);
	piece = emitter_pieces(&emitters[WINDOW], 1, 2, 2, piece);
	for (int i = 0; i < STUDIO_LANTERNS; i++, piece++) {
		const struct studio_lantern *lantern = &lamps->lantern[i];

		memcpy(piece->place, lantern->centre, sizeof(piece->place));
		memset(piece->facing, 0, sizeof(piece->facing));
		piece->radius = lantern->radius;
		for (int c = 0; c < 3; c++)
			piece->power[c] = M_PI * lantern->radius * lantern->radius *
					  lantern->radiance[c];
	}
}

double studio_lantern_irradiance(const struct studio_lantern *lantern, const double point[3],
				 const double normal[3])
{
	const double to[3] = {lantern->centre[0] - point[0], lantern->centre[1] - point[1],
			      lantern->centre[2] - point[2]};
	const double d2 = vec_dot(to, to), facing = vec_dot(to, normal);

	return facing > 0 ? M_PI * lantern->radius * lantern->radius * facing / (d2 * sqrt(d2)) : 0;
}

int studio_lantern_hit(const struct studio_lamps *lamps, const double origin[3],
		       const double dir[3], double limit)
{
	int found = -1;

	for (int i = 0; i < STUDIO_LANTERNS; i++) {
		const double *centre = lamps->lantern[i].centre;
		const double to[3] = {centre[0] - origin[0], centre[1] - origin[1],
				      centre[2] - origin[2]};
		const double along = vec_dot(to, dir);
		const double inside2 = lamps->lantern[i].radius * lamps->lantern[i].radius -
				       (vec_dot(to, to) - along * along);
		double distance;

		if (inside2 < 0 || along < 0)
			continue;
		distance = along - sqrt(inside2);
		if (distance < limit) {
			limit = distance;
			found = i;
		}
	}
	return found;
}

void studio_radiance(const double origin[3], const double dir[3], const struct studio_lamps *lamps,
		     double rgb[3])
{
	struct studio_hit hit;
	double irradiance[3];
	int lantern;

	rgb_set(rgb, 0, 0, 0);
	if (!studio_hit(origin, dir, &hit))
		return;
	lantern = studio_lantern_hit(lamps, origin, dir, hit.distance);
	if (lantern >= 0) {
		memcpy(rgb, lamps->lantern[lantern].radiance, sizeof(double[3]));
		return;
	}
	studio_steady_irradiance(hit.point, hit.surface, lamps->panels, irradiance);
	for (int i = 0; i < STUDIO_LANTERNS; i++) {
		const double e = studio_lantern_irradiance(&lamps->lantern[i], hit.point,
							   studio_normals[hit.surface]);

		for (int c = 0; c < 3; c++)
			irradiance[c] += e * lamps->lantern[i].radiance[c];
	}
	for (int c = 0; c < 3; c++)
		rgb[c] = (hit.surface == STUDIO_CEILING ? lamps->panels : 1) * hit.emitted[c] +
			 hit.albedo[c] / M_PI * irradiance[c];
}
