/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>
#include <string.h>

#include "hal/optics/vec.h"

enum {
	SIDE = 4,
	TILE = 8,
	NODES = 1024 /* of a row, at most, at which shadows are computed */
};

struct crowd {
	int count;
	struct walker_body body[WALKER_STYLES];
	struct studio_piece piece[STUDIO_PIECES];
	const struct studio_lamps *lamps;
};

static void crowd_gather(struct crowd *crowd, const struct studio_lamps *lamps,
			 const struct walker *walkers, int count)
{
	crowd->lamps = lamps;
	crowd->count = count < WALKER_STYLES ? count : WALKER_STYLES;
	for (int i = 0; i < crowd->count; i++)
		walker_pose(&walkers[i], &crowd->body[i]);
	studio_pieces(lamps, crowd->piece);
}

/* Irradiance by a piece for a power of 1. */
static double piece_irradiance(const struct studio_piece *piece, const double point[3],
			       const double normal[3])
{
	const double to[3] = {piece->place[0] - point[0], piece->place[1] - point[1],
			      piece->place[2] - point[2]};
	const double d2 = vec_dot(to, to), d = sqrt(d2);
	const bool faces = vec_dot(piece->facing, piece->facing) > 0;
	const double here = vec_dot(to, normal) / d;
	const double there = faces ? -vec_dot(to, piece->facing) / d : 1;

	return here > 0 && there > 0 ? here * there / d2 : 0;
}

/* The share of a lamp that the bodies within a distance on the ground hide from a point. */
static double crowd_hides(const struct crowd *crowd, double within_m, const double point[3],
			  const double lamp[3], double radius)
{
	double seen = 1;

	for (int i = 0; i < crowd->count; i++) {
		const double *middle = crowd->body[i].low;

		if (hypot(middle[0] - point[0], middle[1] - point[1]) < within_m)
			seen *= 1 - walker_hides(&crowd->body[i], point, lamp, radius);
	}
	return 1 - seen;
}

/* The share of the ambient light that is hidden: seven beams share the hemisphere by the cosine. A
 * body is longer than wide, so the strip that walker_hides() compares with a beam covers less of a
 * round one: by half, about. */
static double crowd_hides_ambient(const struct crowd *crowd, const double point[3],
				  const double normal[3])
{
	const double within_m = 1.2, far_m = 2, tilt = 0.9, radius = 0.8, round = 0.5;
	double u[3] = {normal[1], normal[2], normal[0]}, v[3], hidden = 0;

	vec_cross(normal, u, v);
	for (int k = 0; k < 7; k++) {
		const double turn = 2 * M_PI * k / 6, out = k < 6 ? sin(tilt) : 0;
		double lamp[3];

		for (int i = 0; i < 3; i++)
			lamp[i] = point[i] + far_m * (sqrt(1 - out * out) * normal[i] +
						      out * (cos(turn) * u[i] + sin(turn) * v[i]));
		hidden += round * crowd_hides(crowd, within_m, point, lamp, radius) / 7;
	}
	return hidden;
}

static void take_light(const struct studio_view *view, int x, int y, const double lost[3],
		       float *rgb)
{
	const struct sim_eye *eye = studio_view_eye(view);
	const struct studio_ground at = studio_view_ground(view, x, y);
	float *value = &rgb[3 * (y * eye->width + x)];

	for (int c = 0; c < 3; c++)
		value[c] = fmaxf(value[c] - (float)(at.paint[c] * lost[c]), 0.05f * value[c]);
}

/* Irradiance that walkers keep from a place. */
static void crowd_takes(const struct crowd *crowd, const struct studio_ground *at, double lost[3])
{
	const double ambient = crowd_hides_ambient(crowd, at->point, at->normal);

	for (int c = 0; c < 3; c++)
		lost[c] = ambient * studio_ambient_irradiance[c];
	for (int p = 0; p < STUDIO_PIECES; p++) {
		const struct studio_piece *piece = &crowd->piece[p];
		const double e = piece->power[1] > 0
					 ? piece_irradiance(piece, at->point, at->normal)
					 : 0;
		const double hidden = e > 0 ? crowd_hides(crowd, INFINITY, at->point, piece->place,
							  piece->radius)
					    : 0;

		for (int c = 0; c < 3; c++)
			lost[c] += hidden * e * piece->power[c];
	}
}

/* Irradiance that walkers keep from the nodes of a row: every `step` pixels, and the last one. */
static void take_row(const struct crowd *crowd, const struct studio_view *view, int y, int step,
		     double row[NODES + 1][3])
{
	const int right = studio_view_eye(view)->width - 1;

	for (int i = 0; (i - 1) * step < right; i++) {
		const int x = i * step < right ? i * step : right;
		const struct studio_ground at = studio_view_ground(view, x, y);

		crowd_takes(crowd, &at, row[i]);
	}
}

void studio_people_shade(const struct studio_view *view, const struct studio_lamps *lamps,
			 const struct walker *walkers, int count, float *rgb)
{
	const struct sim_eye *eye = studio_view_eye(view);
	const int step = 4 * (1 + eye->width / (4 * NODES));
	double rows[2][NODES + 1][3];
	struct crowd crowd;

	if (count == 0)
		return;
	crowd_gather(&crowd, lamps, walkers, count);
	take_row(&crowd, view, 0, step, rows[0]);
	for (int y = 0; y < eye->height; y++) {
		const double(*above)[3] = rows[y / step % 2], (*below)[3] = rows[1 - y / step % 2];
		const double v = (double)(y % step) / step;

		if (y % step == 0)
			take_row(&crowd, view, y + step < eye->height ? y + step : eye->height - 1,
				 step, rows[1 - y / step % 2]);
		for (int x = 0; x < eye->width; x++) {
			const double u = (double)(x % step) / step;
			const int i = x / step;
			double lost[3];

			for (int c = 0; c < 3; c++)
				lost[c] = (1 - v) * ((1 - u) * above[i][c] + u * above[i + 1][c]) +
					  v * ((1 - u) * below[i][c] + u * below[i + 1][c]);
			take_light(view, x, y, lost, rgb);
		}
	}
}

static void body_irradiance(const struct crowd *crowd, const double point[3],
			    const double normal[3], double rgb[3])
{
	/* Nearer to the ground, which is darker than the walls, less comes from below. */
	const double ambient = 0.75 + 0.25 * normal[2];

	for (int c = 0; c < 3; c++)
		rgb[c] = ambient * studio_ambient_irradiance[c];
	for (int p = 0; p < STUDIO_PIECES; p++) {
		const double e = piece_irradiance(&crowd->piece[p], point, normal);

		for (int c = 0; c < 3; c++)
			rgb[c] += e * crowd->piece[p].power[c];
	}
}

/* What is known of a pixel's samples so far. */
struct drawn_pixel {
	int hits, seen;
	int of[WALKER_STYLES]; /* hits of each walker */
	double depth;
	int shaded; /* how often another part was met than the sample before had */
	int shaded_body, shaded_part; /* whose light the next one has, too */
	double irradiance[3];
};

static void pixel_sample(const struct crowd *crowd, const unsigned *parts, const double origin[3],
			 const double dir[3], struct drawn_pixel *pixel, float rgb[3])
{
	struct walker_hit hit, nearest = {.distance = INFINITY};
	int who = -1;

	for (int i = 0; i < crowd->count; i++)
		if (parts[i] && walker_hit(&crowd->body[i], parts[i], origin, dir, &hit) &&
		    hit.distance < nearest.distance) {
			nearest = hit;
			who = i;
		}
	if (who < 0 || studio_lantern_hit(crowd->lamps, origin, dir, nearest.distance) >= 0)
		return;
	if (pixel->shaded_body != who || pixel->shaded_part != nearest.part) {
		double point[3];

		for (int i = 0; i < 3; i++)
			point[i] = origin[i] + nearest.distance * dir[i];
		body_irradiance(crowd, point, nearest.normal, pixel->irradiance);
		pixel->shaded++;
		pixel->shaded_body = who;
		pixel->shaded_part = nearest.part;
	}
	pixel->hits++;
	pixel->of[who]++;
	pixel->depth += nearest.distance;
	for (int c = 0; c < 3; c++)
		rgb[c] += (float)(nearest.albedo[c] / M_PI * pixel->irradiance[c]);
}

static const int corners_first[SIDE * SIDE] = {0, 3, 12, 15, 1,	 2,  4,	 5,
					       6, 7, 8,	 9,  10, 11, 13, 14};

static struct studio_layer draw_pixel(const struct crowd *crowd, const struct sim_eye *eye,
				      const unsigned *parts, int x, int y)
{
	struct studio_layer layer = {.walker = -1};
	struct drawn_pixel pixel = {.shaded_body = -1};
	int samples = 0;

	/* The corners first: where they see one part, the rest does, too. */
	for (int k = 0; k < SIDE * SIDE && !(samples == 4 && pixel.hits == 4 && pixel.shaded == 1);
	     k++, samples++) {
		const int at = corners_first[k];
		const double px[2] = {x + (at % SIDE + 0.5) / SIDE, y + (at / SIDE + 0.5) / SIDE};
		double origin[3], dir[3];

		if (eye_ray(eye, px, origin, dir))
			pixel_sample(crowd, parts, origin, dir, &pixel, layer.rgb);
	}
	for (int i = 0; i < crowd->count; i++)
		if (pixel.of[i] > 0 && (layer.walker < 0 || pixel.of[i] > pixel.of[layer.walker]))
			layer.walker = i;
	for (int c = 0; c < 3; c++)
		layer.rgb[c] /= (float)samples;
	layer.alpha = (float)pixel.hits / (float)samples;
	layer.depth = pixel.hits ? (float)(pixel.depth / pixel.hits) : 0;
	return layer;
}

/* The parts of bodies that a tile may see: those in a cone around its middle, or, where that lies
 * outside the field, around its corners. False: none. */
static bool tile_parts(const struct crowd *crowd, const struct sim_eye *eye, int x, int y,
		       unsigned *parts)
{
	double origin[3], dir[3], angle;
	bool middle = false, any = false;

	memset(parts, 0, WALKER_STYLES * sizeof(*parts));
	for (int k = 0; k < 5 && !middle; k++) {
		const double px[2] = {x + (k ? k % 2 : 0.5) * TILE, y + (k ? k / 3 : 0.5) * TILE};

		if (!eye_ray(eye, px, origin, dir))
			continue;
		middle = k == 0;
		/* Half the diagonal of a square is 0.71 of its side. */
		angle = (middle ? 0.75 : 1.5) * TILE * eye_pixel_rad(eye, px);
		for (int i = 0; i < crowd->count; i++)
			any |= (parts[i] |= walker_in_cone(&crowd->body[i], origin, dir, angle));
	}
	return any;
}

void studio_people_draw(const struct studio_view *view, const struct studio_lamps *lamps,
			const struct walker *walkers, int count, struct studio_layer *layer)
{
	const struct sim_eye *eye = studio_view_eye(view);
	const struct studio_layer nothing = {.walker = -1};
	struct crowd crowd;

	crowd_gather(&crowd, lamps, walkers, count);
	for (int k = 0; k < eye->width * eye->height; k++)
		layer[k] = nothing;
	for (int ty = 0; ty < eye->height; ty += TILE)
		for (int tx = 0; tx < eye->width; tx += TILE) {
			unsigned parts[WALKER_STYLES];

			if (!tile_parts(&crowd, eye, tx, ty, parts))
				continue;
			for (int y = ty; y < ty + TILE && y < eye->height; y++)
				for (int x = tx; x < tx + TILE && x < eye->width; x++)
					layer[y * eye->width + x] = draw_pixel(&crowd, eye, parts,
									       x, y);
		}
}

void studio_people_over(const struct studio_view *view, const struct studio_layer *layer,
			float *rgb)
{
	const struct sim_eye *eye = studio_view_eye(view);

	for (int k = 0; k < eye->width * eye->height; k++)
		for (int c = 0; c < 3; c++)
			rgb[3 * k + c] = (1 - layer[k].alpha) * rgb[3 * k + c] + layer[k].rgb[c];
}

void studio_people_depth(const struct studio_view *view, const struct studio_layer *layer, float *z)
{
	const struct sim_eye *eye = studio_view_eye(view);

	for (int y = 0; y < eye->height; y++)
		for (int x = 0; x < eye->width; x++) {
			const int k = y * eye->width + x;
			double origin[3], dir[3];

			if (layer[k].alpha >= 0.5f)
				z[k] = (float)(eye_along_axis(eye, x, y, origin, dir) *
					       (double)layer[k].depth);
		}
}
