/* SPDX-License-Identifier: MIT */
#include "bake/demo/atlas.h"

#include <errno.h>
#include <float.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

#define GUTTER 2 /* texels painted around a piece */
#define TIDY_PASSES 6
/* least cosine between a triangle's normal and the axis that it is laid along */
#define STEEPEST 0.35

/* A connected set of triangles laid along one axis. */
struct atlas_piece {
	int label;
	double low[2], high[2];	 /* on its plane, in the surface's unit */
	int x, y, width, height; /* its rectangle in the picture, gutter included */
};

struct turn {
	int height, piece;
};

struct atlas_work {
	const struct trimesh *mesh;
	int (*neighbour)[3]; /* of each triangle, across the edge from corner k to k + 1 */
	int *label;	     /* 0..5: +x -x +y -y +z -z */
	int *owner;	     /* piece of each triangle */
	int *queue;
	struct atlas_piece *piece;
	int piece_count;
	struct turn *turn; /* pieces, tallest first */
};

/* ---- which triangles touch ---- */

struct mesh_edge {
	int low, high;
	int triangle, corner;
};

static int edge_compare(const void *a, const void *b)
{
	const struct mesh_edge *one = a, *two = b;

	if (one->low != two->low)
		return one->low < two->low ? -1 : 1;
	return (one->high > two->high) - (one->high < two->high);
}

static int find_neighbours(struct atlas_work *work)
{
	const int count = 3 * work->mesh->triangle_count;
	struct mesh_edge *edge = malloc(count * sizeof(*edge));

	if (!edge)
		return -ENOMEM;
	for (int e = 0; e < count; e++) {
		const int a = work->mesh->triangle[e / 3][e % 3];
		const int b = work->mesh->triangle[e / 3][(e + 1) % 3];

		edge[e] = (struct mesh_edge){a < b ? a : b, a < b ? b : a, e / 3, e % 3};
	}
	qsort(edge, count, sizeof(*edge), edge_compare);
	/* On a closed surface edges come in pairs. */
	for (int e = 0; e + 1 < count; e += 2) {
		work->neighbour[edge[e].triangle][edge[e].corner] = edge[e + 1].triangle;
		work->neighbour[edge[e + 1].triangle][edge[e + 1].corner] = edge[e].triangle;
	}
	free(edge);
	return 0;
}

/* ---- which axis each triangle is laid along ---- */

static void triangle_normal(const struct trimesh *mesh, int t, double normal[3])
{
	const int *corner = mesh->triangle[t];
	double a[3], b[3];

	for (int i = 0; i < 3; i++) {
		a[i] = mesh->position[corner[1]][i] - mesh->position[corner[0]][i];
		b[i] = mesh->position[corner[2]][i] - mesh->position[corner[0]][i];
	}
	vec_cross(a, b, normal);
	vec_normalize(normal);
}

static double axis_facing(const double normal[3], int label)
{
	return label & 1 ? -normal[label / 2] : normal[label / 2];
}

/* Gives each triangle the axis that it faces most. Then, so that pieces have smooth borders and few
 * islands, a triangle takes the axis of two or three of its neighbours unless it is too steep for
 * that. */
static void choose_axes(struct atlas_work *work)
{
	const int count = work->mesh->triangle_count;

	for (int t = 0; t < count; t++) {
		double normal[3];

		triangle_normal(work->mesh, t, normal);
		work->label[t] = 0;
		for (int label = 1; label < 6; label++)
			if (axis_facing(normal, label) > axis_facing(normal, work->label[t]))
				work->label[t] = label;
	}
	for (int pass = 0; pass < TIDY_PASSES; pass++) {
		for (int t = 0; t < count; t++) {
			const int *n = work->neighbour[t];
			const int a = work->label[n[0]], b = work->label[n[1]];
			const int c = work->label[n[2]];
			const int most = a == b || a == c ? a : b == c ? b : work->label[t];
			double normal[3];

			triangle_normal(work->mesh, t, normal);
			if (axis_facing(normal, most) > STEEPEST)
				work->label[t] = most;
		}
	}
}

/* ---- pieces ---- */

static void axis_flatten(int label, const double p[3], double flat[2])
{
	flat[0] = p[(label / 2 + 1) % 3];
	flat[1] = p[(label / 2 + 2) % 3];
}

/* Marks all triangles of one axis that are connected with triangle t as one piece. */
static void gather_piece(struct atlas_work *work, int t)
{
	struct atlas_piece *piece = &work->piece[work->piece_count];
	int taken = 0, found = 0;

	*piece = (struct atlas_piece){
		.label = work->label[t], .low = {DBL_MAX, DBL_MAX}, .high = {-DBL_MAX, -DBL_MAX}};
	work->owner[t] = work->piece_count;
	work->queue[found++] = t;
	while (taken < found) {
		const int now = work->queue[taken++];

		for (int k = 0; k < 3; k++) {
			const int next = work->neighbour[now][k];
			double flat[2];

			axis_flatten(piece->label,
				     work->mesh->position[work->mesh->triangle[now][k]], flat);
			for (int i = 0; i < 2; i++) {
				piece->low[i] = fmin(piece->low[i], flat[i]);
				piece->high[i] = fmax(piece->high[i], flat[i]);
			}
			if (work->owner[next] >= 0 || work->label[next] != piece->label)
				continue;
			work->owner[next] = work->piece_count;
			work->queue[found++] = next;
		}
	}
	work->piece_count++;
}

static int height_compare(const void *a, const void *b)
{
	const struct turn *one = a, *two = b;

	if (one->height != two->height)
		return one->height > two->height ? -1 : 1;
	return (one->piece > two->piece) - (one->piece < two->piece);
}

/* Packs the pieces onto shelves, the tallest first. False: the picture is too small for this
 * texel. */
static bool pack_pieces(struct atlas_work *work, double texel, int side)
{
	int x = 0, y = 0, shelf = 0;

	for (int k = 0; k < work->piece_count; k++) {
		struct atlas_piece *piece = &work->piece[k];

		piece->width = (int)ceil((piece->high[0] - piece->low[0]) / texel) + 2 * GUTTER + 1;
		piece->height = (int)ceil((piece->high[1] - piece->low[1]) / texel) + 2 * GUTTER +
				1;
		if (piece->width > side)
			return false;
		work->turn[k] = (struct turn){piece->height, k};
	}
	qsort(work->turn, work->piece_count, sizeof(*work->turn), height_compare);
	for (int k = 0; k < work->piece_count; k++) {
		struct atlas_piece *piece = &work->piece[work->turn[k].piece];

		if (x + piece->width > side) {
			x = 0;
			y += shelf;
			shelf = 0;
		}
		if (!shelf)
			shelf = piece->height;
		if (y + shelf > side)
			return false;
		piece->x = x;
		piece->y = y;
		x += piece->width;
	}
	return true;
}

/* ---- texture coordinates and colours ---- */

/* Texture coordinates of p, in texels. */
static void texture_point(const struct atlas_piece *piece, double texel, const double p[3],
			  double out[2])
{
	double flat[2];

	axis_flatten(piece->label, p, flat);
	out[0] = piece->x + GUTTER + 0.5 + (flat[0] - piece->low[0]) / texel;
	out[1] = piece->y + GUTTER + 0.5 + (flat[1] - piece->low[1]) / texel;
}

static int write_atlas_points(struct atlas *atlas, const struct atlas_work *work, int side)
{
	const struct trimesh *mesh = work->mesh;
	/* A vertex has a point for each piece that it is in. Two pieces of one axis may share only
	 * a vertex, so the owner of its last point is compared as well as the axis. */
	int(*seen)[6] = malloc(mesh->vertex_count * sizeof(*seen));
	int *owner = malloc(3 * mesh->triangle_count * sizeof(*owner));

	if (!seen || !owner) {
		free(seen);
		free(owner);
		return -ENOMEM;
	}
	memset(seen, -1, mesh->vertex_count * sizeof(*seen));
	for (int t = 0; t < mesh->triangle_count; t++) {
		const struct atlas_piece *piece = &work->piece[work->owner[t]];

		for (int k = 0; k < 3; k++) {
			const int vertex = mesh->triangle[t][k];
			int *at = &seen[vertex][piece->label];

			if (*at < 0 || owner[*at] != work->owner[t]) {
				double *point = atlas->point[atlas->point_count];

				texture_point(piece, atlas->texel, mesh->position[vertex], point);
				point[0] /= side;
				point[1] /= side;
				owner[atlas->point_count] = work->owner[t];
				*at = atlas->point_count++;
			}
			atlas->corner[t][k] = *at;
		}
	}
	free(seen);
	free(owner);
	return 0;
}

/* Stores the place in space of each texel in or near triangle t, unless another triangle of the
 * same piece is nearer to it. */
static void mark_texels(const struct atlas_work *work, const struct atlas *atlas, int t, int side,
			double *away, double (*place)[3])
{
	const struct atlas_piece *piece = &work->piece[work->owner[t]];
	const int *corner = work->mesh->triangle[t];
	double q[3][2], area2;

	for (int k = 0; k < 3; k++)
		texture_point(piece, atlas->texel, work->mesh->position[corner[k]], q[k]);
	area2 = (q[1][0] - q[0][0]) * (q[2][1] - q[0][1]) -
		(q[2][0] - q[0][0]) * (q[1][1] - q[0][1]);
	if (fabs(area2) < 1e-9)
		return;

	const int x0 = (int)fmin(q[0][0], fmin(q[1][0], q[2][0])) - GUTTER;
	const int y0 = (int)fmin(q[0][1], fmin(q[1][1], q[2][1])) - GUTTER;
	const int x1 = (int)fmax(q[0][0], fmax(q[1][0], q[2][0])) + GUTTER;
	const int y1 = (int)fmax(q[0][1], fmax(q[1][1], q[2][1])) + GUTTER;

	for (int y = y0 > piece->y ? y0 : piece->y; y <= y1 && y < piece->y + piece->height; y++) {
		for (int x = x0 > piece->x ? x0 : piece->x; x <= x1 && x < piece->x + piece->width;
		     x++) {
			double weight[3], out = 0;

			for (int k = 0; k < 3; k++) {
				const double *a = q[(k + 1) % 3], *b = q[(k + 2) % 3];
				const double cross = (a[0] - (x + 0.5)) * (b[1] - (y + 0.5)) -
						     (b[0] - (x + 0.5)) * (a[1] - (y + 0.5));
				const double edge = hypot(b[0] - a[0], b[1] - a[1]);

				weight[k] = cross / area2;
				out = fmax(out, -weight[k] * fabs(area2) / edge);
			}
			double *best = &away[(size_t)y * side + x];

			if (out > GUTTER || out >= *best)
				continue;
			*best = out;
			for (int i = 0; i < 3; i++) {
				double *at = &place[(size_t)y * side + x][i];

				*at = 0;
				for (int k = 0; k < 3; k++)
					*at += weight[k] * work->mesh->position[corner[k]][i];
			}
		}
	}
}

static int paint_atlas(struct atlas *atlas, const struct atlas_work *work, int side,
		       void (*colour)(const double p[3], double rgb[3]))
{
	const size_t texels = (size_t)side * side;
	double *away = malloc(texels * sizeof(*away));
	double(*place)[3] = malloc(texels * sizeof(*place));
	int err = image_create_u8(&atlas->picture, side, side);

	if (!away || !place)
		err = -ENOMEM;
	if (err)
		goto out;
	for (size_t i = 0; i < texels; i++)
		away[i] = DBL_MAX;
	for (int t = 0; t < work->mesh->triangle_count; t++)
		mark_texels(work, atlas, t, side, away, place);
	for (size_t i = 0; i < texels; i++) {
		double rgb[3] = {0.5, 0.5, 0.5};

		if (away[i] < DBL_MAX)
			colour(place[i], rgb);
		for (int c = 0; c < 3; c++)
			atlas->picture.u8[3 * i + c] = (uint8_t)lrint(255 * rgb[c]);
	}
out:
	free(away);
	free(place);
	return err;
}

static void work_free(struct atlas_work *work)
{
	free(work->neighbour);
	free(work->label);
	free(work->owner);
	free(work->queue);
	free(work->piece);
	free(work->turn);
}

static int work_create(struct atlas_work *work, const struct trimesh *mesh)
{
	const int count = mesh->triangle_count;

	*work = (struct atlas_work){.mesh = mesh};
	work->neighbour = calloc(count, sizeof(*work->neighbour));
	work->label = malloc(count * sizeof(*work->label));
	work->owner = malloc(count * sizeof(*work->owner));
	work->queue = malloc(count * sizeof(*work->queue));
	work->piece = malloc(count * sizeof(*work->piece));
	work->turn = malloc(count * sizeof(*work->turn));
	if (!work->neighbour || !work->label || !work->owner || !work->queue || !work->piece ||
	    !work->turn)
		return -ENOMEM;
	memset(work->owner, -1, count * sizeof(*work->owner));
	return 0;
}

int atlas_create(struct atlas *atlas, const struct trimesh *mesh, int side,
		 void (*colour)(const double p[3], double rgb[3]))
{
	struct atlas_work work;
	int err;

	memset(atlas, 0, sizeof(*atlas));
	err = work_create(&work, mesh);
	if (err)
		goto out;
	atlas->point = malloc(3 * mesh->triangle_count * sizeof(*atlas->point));
	atlas->corner = malloc(mesh->triangle_count * sizeof(*atlas->corner));
	if (!atlas->point || !atlas->corner) {
		err = -ENOMEM;
		goto out;
	}
	err = find_neighbours(&work);
	if (err)
		goto out;
	choose_axes(&work);
	for (int t = 0; t < mesh->triangle_count; t++)
		if (work.owner[t] < 0)
			gather_piece(&work, t);
	/* Texels grow from far too fine until the pieces fit. */
	atlas->texel = 0.1 / side;
	while (!pack_pieces(&work, atlas->texel, side))
		atlas->texel *= 1.02;
	err = write_atlas_points(atlas, &work, side);
	if (err)
		goto out;
	err = paint_atlas(atlas, &work, side, colour);
out:
	work_free(&work);
	if (err)
		atlas_free(atlas);
	return err;
}

void atlas_free(struct atlas *atlas)
{
	free(atlas->point);
	free(atlas->corner);
	image_free(&atlas->picture);
	memset(atlas, 0, sizeof(*atlas));
}
