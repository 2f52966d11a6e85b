/* SPDX-License-Identifier: MIT */
#include "bake/scene/footprint.h"

#include <math.h>
#include <string.h>

#define CORNERS_MAX 7 /* a triangle after four cuts, each of which adds a corner */
/* Squares are larger by this factor, so that rounding leaves nothing outside. */
#define ROOM 1.0001
/* A square's side is at least this share of the largest coordinate: single precision resolves
 * it. */
#define SQUARE_LEAST 1e-6

/* A convex polygon. */
struct outline {
	int count;
	double at[CORNERS_MAX][3];
};

/* Cuts off the part of a polygon where sign * at[axis] > sign * limit. */
static void outline_cut(struct outline *o, int axis, double sign, double limit)
{
	const struct outline from = *o;

	o->count = 0;
	for (int i = 0; i < from.count; i++) {
		const double *a = from.at[i], *b = from.at[(i + 1) % from.count];
		const double over_a = sign * (a[axis] - limit), over_b = sign * (b[axis] - limit);

		if (over_a <= 0)
			memcpy(o->at[o->count++], a, sizeof(o->at[0]));
		if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0)) {
			const double share = over_a / (over_a - over_b);

			for (int k = 0; k < 3; k++)
				o->at[o->count][k] = a[k] + share * (b[k] - a[k]);
			o->at[o->count++][axis] = limit;
		}
	}
}

/* The part of the objects that counts: between low and high. */
struct footprint_range {
	const struct mesh *const *meshes;
	int count;
	double low, high; /* Z */
};

typedef void outline_visit(void *context, const struct outline *outline);

/* Calls visit() with the part of each triangle that is between low and high. */
static void walk_triangles(const struct footprint_range *range, outline_visit *visit, void *context)
{
	for (int m = 0; m < range->count; m++)
		for (int p = 0; p < range->meshes[m]->part_count; p++) {
			const struct mesh_part *part = &range->meshes[m]->parts[p];

			for (int t = 0; t < part->triangles; t++) {
				struct outline o = {.count = 3};

				for (int k = 0; k < 3; k++) {
					const struct v3 at = mesh_corner(part, t, k);

					o.at[k][0] = (double)at.x;
					o.at[k][1] = (double)at.y;
					o.at[k][2] = (double)at.z;
				}
				outline_cut(&o, 2, -1, range->low);
				outline_cut(&o, 2, 1, range->high);
				if (o.count)
					visit(context, &o);
			}
		}
}

struct bounds_above {
	double low[2], high[2];
};

static void add_bounds(void *context, const struct outline *o)
{
	struct bounds_above *bounds = context;

	for (int i = 0; i < o->count; i++)
		for (int k = 0; k < 2; k++) {
			bounds->low[k] = fmin(bounds->low[k], o->at[i][k]);
			bounds->high[k] = fmax(bounds->high[k], o->at[i][k]);
		}
}

static int square_index(double at, double corner, double side)
{
	const double square = floor((at - corner) / side);

	return square < 0			 ? 0
	       : square > BASIS_FOOT_SQUARES - 1 ? BASIS_FOOT_SQUARES - 1
						 : (int)square;
}

/* Marks each square that the outline touches: in each row from its lowest X to its highest. */
static void mark_squares(void *context, const struct outline *outline)
{
	struct basis_footprint *foot = context;
	const double side = (double)foot->side;
	struct bounds_above all = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};

	add_bounds(&all, outline);
	for (int j = square_index(all.low[1], (double)foot->corner[1], side),
		 last = square_index(all.high[1], (double)foot->corner[1], side);
	     j <= last; j++) {
		struct bounds_above row = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
		struct outline o = *outline;
		int from, to;

		outline_cut(&o, 1, -1, (double)foot->corner[1] + j * side);
		outline_cut(&o, 1, 1, (double)foot->corner[1] + (j + 1) * side);
		add_bounds(&row, &o);
		if (!o.count)
			continue;
		from = square_index(row.low[0], (double)foot->corner[0], side);
		to = square_index(row.high[0], (double)foot->corner[0], side);
		foot->row[j] |= UINT64_MAX >> (63 - to + from) << from;
	}
}

void footprint_measure(const struct mesh *const *meshes, int count, double height,
		       struct basis_footprint *foot)
{
	const struct footprint_range ranges[] = {{meshes, count, 0, height},
						 {meshes, count, -INFINITY, INFINITY}};
	const struct footprint_range *range = NULL;
	struct bounds_above bounds = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
	double largest, side;

	memset(foot, 0, sizeof(*foot));
	for (int n = 0; n < 2 && !(bounds.low[0] <= bounds.high[0]); n++) {
		range = &ranges[n];
		walk_triangles(range, add_bounds, &bounds);
	}
	if (!(bounds.low[0] <= bounds.high[0]))
		return;
	largest = fmax(fmax(fabs(bounds.low[0]), fabs(bounds.high[0])),
		       fmax(fabs(bounds.low[1]), fabs(bounds.high[1])));
	side = fmax(bounds.high[0] - bounds.low[0], bounds.high[1] - bounds.low[1]) * ROOM /
	       BASIS_FOOT_SQUARES;
	foot->side = (float)fmax(fmax(side, SQUARE_LEAST * largest), 1e-30);
	for (int k = 0; k < 2; k++)
		foot->corner[k] = (float)(0.5 * (bounds.low[k] + bounds.high[k]) -
					  0.5 * BASIS_FOOT_SQUARES * (double)foot->side);
	walk_triangles(range, mark_squares, foot);
}

void footprint_of_scene(const struct scene *scene, struct basis_footprint *foot)
{
	const struct mesh *meshes[SCENE_MESHES_MAX];
	int count = 0;

	for (int k = 0; k < scene->file->mesh_count; k++)
		if (!scene->file->mesh[k].standin)
			meshes[count++] = &scene->meshes[k];
	footprint_measure(meshes, count, (double)scene->eye.z, foot);
}
