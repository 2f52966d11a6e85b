/* SPDX-License-Identifier: MIT */
#include "hal/lights/sampler_shares.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

#define SUBPIXELS 8	/* sub-pixels per side, in pixels that straddle cells */
#define EDGE_SLACK 1e-9 /* larger than all rounding of edges and of the field */
/* What the lens says is smooth: it is asked at four of so many pixels. The cubic between them is
 * off by 26 times the fourth derivative, 1e-6 where a pixel turns the direction by this at most. */
#define BLOCK 16
#define SMOOTH_RAD 0.01

/* A pixel of the row that is being shared out: its weights in a light, or in each of its thirds. */
struct row_share {
	int light, x;
	float weight[DOME_PLACED_THIRDS];
};

/* The shares of a light in that row: the first one's index by light, and how many are in place. */
struct row_light {
	int count, first, placed;
};

struct shares_builder {
	const struct dome *dome;
	const struct fisheye *lens;
	int width, height;
	int *corner_light; /* [height + 1][width + 1]: the cell at each pixel's upper left corner */
	int *first_edge;   /* [lights + 1] */
	double(*edge)
		/* unit normals of the cells' edges, inwards; first_edge[i] is cell i's first */
		[3];
	struct dome_placed *placed; /* NULL: shares are of lights, else of thirds */
	int parts;		    /* of a light: DOME_PLACED_THIRDS, or 1 */
	int y, row_count, row_room;
	struct row_share *row;	     /* [row_room]: from left to right */
	int *column;		     /* [row_room]: their places, light by light */
	struct row_light *of_light;  /* [lights]: 0 between rows */
	struct fisheye_pixel *pixel; /* [width]: of the row; falloff 0: outside the field */
	double turn;		     /* fisheye_turn_per_pixel() */
	struct sampler_shares shares;
};

/* Makes room for the shares of a row. 0 or -ENOMEM. */
static int shares_reserve(struct sampler_shares *s, size_t more)
{
	if (s->weights + more > s->weight_room) {
		const size_t room = 2 * (s->weights + more);
		float *weight = realloc(s->weight, room * sizeof(*weight));

		if (!weight)
			return -ENOMEM;
		s->weight = weight;
		s->weight_room = room;
	}
	if (s->runs + more > s->run_room) {
		const size_t room = 2 * (s->runs + more);
		struct sampler_run *run = realloc(s->run, room * sizeof(*run));

		if (!run)
			return -ENOMEM;
		s->run = run;
		s->run_room = room;
	}
	return 0;
}

/* Adds the runs of a light in the row, whose first weight this is. */
static void add_runs(struct shares_builder *b, int light, size_t first)
{
	const struct row_light *l = &b->of_light[light];
	const int *x = b->column + l->first;

	for (int from = 0, to; from < l->count; from = to) {
		to = from + 1;
		while (to < l->count && x[to] == x[to - 1] + 1)
			to++;
		for (int k = 0; k < b->parts; k++)
			b->shares.run[b->shares.runs++] = (struct sampler_run){
				.light = b->parts * light + k,
				.x = (uint16_t)x[from],
				.y = (uint16_t)b->y,
				.count = (uint16_t)(to - from),
				.first = first + (size_t)(k * l->count + from),
			};
	}
}

/* Sorts the row's shares by light into runs. 0 or -ENOMEM. */
static int finish_row(struct shares_builder *b)
{
	const size_t weights = (size_t)b->row_count * (size_t)b->parts;
	int lit = 0;

	if (shares_reserve(&b->shares, weights) < 0)
		return -ENOMEM;
	for (int i = 0; i < b->row_count; i++)
		b->of_light[b->row[i].light].count++;
	for (int i = 0; i < b->row_count; i++) {
		const struct row_share *share = &b->row[i];
		struct row_light *l = &b->of_light[share->light];
		size_t first;

		if (l->placed == 0) {
			l->first = lit;
			lit += l->count;
		}
		first = b->shares.weights + (size_t)(l->first * b->parts);
		b->column[l->first + l->placed] = share->x;
		for (int k = 0; k < b->parts; k++)
			b->shares.weight[first + (size_t)(k * l->count + l->placed)] =
				share->weight[k];
		if (++l->placed == l->count) {
			add_runs(b, share->light, first);
			*l = (struct row_light){.count = 0};
		}
	}
	b->shares.weights += weights;
	b->row_count = 0;
	return 0;
}

/* pixel: what the lens says of it; NULL: not known. */
static int add_share(struct shares_builder *b, int light, int x, int y, double weight,
		     const struct fisheye_pixel *pixel)
{
	const double px[2] = {x + 0.5, y + 0.5};
	double part[DOME_PLACED_THIRDS] = {1};
	struct fisheye_pixel own = {.falloff = 1};
	struct row_share *share;

	if ((y != b->y || b->row_count == b->row_room) && finish_row(b) < 0)
		return -ENOMEM;
	b->y = y;
	if (!pixel && !fisheye_pixel_of(b->lens, px, &own))
		memcpy(own.dir, b->dome->direction[light], sizeof(own.dir));
	if (!pixel)
		pixel = &own;
	if (b->placed)
		dome_placed_thirds(b->placed, light, pixel->dir, part);
	share = &b->row[b->row_count++];
	share->light = light;
	share->x = x;
	for (int k = 0; k < b->parts; k++) {
		const float whole = (float)weight * (float)part[k];

		b->shares.undimmed[b->parts * light + k] += (double)whole;
		share->weight[k] = (float)((double)whole / pixel->falloff);
	}
	return 0;
}

/* The cell at a point of the picture; -1: outside the field or below the horizon. */
static int light_at(const struct shares_builder *b, double x, double y)
{
	const double px[2] = {x, y};
	double dir[3];

	return fisheye_ray(b->lens, px, dir) ? dome_cell_of(b->dome, dir) : -1;
}

static int corner_light(const struct shares_builder *b, int x, int y)
{
	return b->corner_light[(size_t)y * (b->width + 1) + x];
}

/* Directions of the pixel's four corners. False: a corner does not see the sky. */
static bool corner_rays(const struct shares_builder *b, int x, int y, double corner[4][3])
{
	for (int k = 0; k < 4; k++) {
		const double px[2] = {x + (k & 1), y + (k >> 1)};

		if (corner_light(b, x + (k & 1), y + (k >> 1)) < 0 ||
		    !fisheye_ray(b->lens, px, corner[k]))
			return false;
	}
	return true;
}

/* Whether a direction surely lies in a cell. */
static bool is_inside(const struct shares_builder *b, int cell, const double dir[3])
{
	for (int k = b->first_edge[cell]; k < b->first_edge[cell + 1]; k++)
		if (!(vec_dot(b->edge[k], dir) > EDGE_SLACK))
			return false;
	return true;
}

/* The lights of a pixel's sub-pixels, and how many each has. */
struct subpixel_tally {
	int kinds;
	int light[SUBPIXELS * SUBPIXELS], count[SUBPIXELS * SUBPIXELS];
};

/* Counts one more sub-pixel of a cell; -1: of none. */
static void tally_add(struct subpixel_tally *tally, int cell)
{
	int at = 0;

	if (cell < 0)
		return;
	while (at < tally->kinds && tally->light[at] != cell)
		at++;
	if (at == tally->kinds) {
		tally->light[at] = cell;
		tally->count[tally->kinds++] = 0;
	}
	tally->count[at]++;
}

/* Counts sub-pixel k of a row from left to right. Returns its place in the tally if the sub-pixel
 * surely lies in that cell, else -1. */
static int tally_between(const struct shares_builder *b, struct subpixel_tally *tally,
			 const double left[3], const double right[3], int k)
{
	const double s = (k + 0.5) / SUBPIXELS;
	double dir[3];

	for (int c = 0; c < 3; c++)
		dir[c] = (1 - s) * left[c] + s * right[c];
	for (int at = 0; at < tally->kinds; at++)
		if (is_inside(b, tally->light[at], dir)) {
			tally->count[at]++;
			return at;
		}
	tally_add(tally, dome_cell_of(b->dome, dir));
	return -1;
}

/* Counts sub-pixels by light. Inside a pixel it interpolates the direction bilinearly between the
 * corners (error 1e-3 pixels in a picture of 480 x 480), which is much cheaper than the lens; but
 * not at the rim, where a corner does not see the sky. Cells are convex: what lies between two
 * sub-pixels of a row in one cell does, too. */
static void count_subpixels(const struct shares_builder *b, int x, int y,
			    struct subpixel_tally *tally)
{
	double corner[4][3];
	const bool whole = corner_rays(b, x, y, corner);

	tally->kinds = 0;
	for (int j = 0; j < SUBPIXELS; j++) {
		const double t = (j + 0.5) / SUBPIXELS;
		double left[3], right[3];
		int first, last;

		for (int i = 0; !whole && i < SUBPIXELS; i++)
			tally_add(tally, light_at(b, x + (i + 0.5) / SUBPIXELS, y + t));
		if (!whole)
			continue;
		for (int c = 0; c < 3; c++) {
			left[c] = (1 - t) * corner[0][c] + t * corner[2][c];
			right[c] = (1 - t) * corner[1][c] + t * corner[3][c];
		}
		first = tally_between(b, tally, left, right, 0);
		last = tally_between(b, tally, left, right, SUBPIXELS - 1);
		if (first >= 0 && first == last)
			tally->count[first] += SUBPIXELS - 2;
		else
			for (int i = 1; i < SUBPIXELS - 1; i++)
				tally_between(b, tally, left, right, i);
	}
}

/* Shares a pixel among cells. Cells are convex: if all four corners lie in one, the pixel does. */
static int share_pixel(struct shares_builder *b, int x, int y)
{
	const struct fisheye_pixel *pixel = &b->pixel[x];
	const int first = corner_light(b, x, y);
	struct subpixel_tally tally;
	int ret = 0;

	if (pixel->falloff == 0 || !(pixel->dir[2] >= 0))
		return 0;
	if (first >= 0 && first == corner_light(b, x + 1, y) &&
	    first == corner_light(b, x, y + 1) && first == corner_light(b, x + 1, y + 1))
		return add_share(b, first, x, y, pixel->sr, pixel);
	count_subpixels(b, x, y, &tally);
	for (int k = 0; k < tally.kinds && ret == 0; k++)
		ret = add_share(b, tally.light[k], x, y,
				pixel->sr * tally.count[k] / (SUBPIXELS * SUBPIXELS), pixel);
	return ret;
}

/* The planes through the edges of all cells. 0 or -ENOMEM. */
static int find_edges(struct shares_builder *b)
{
	const int lights = b->dome->count;
	double(*corner)[3];
	int edges = 0, most = 0;

	b->first_edge = calloc((size_t)lights + 1, sizeof(*b->first_edge));
	if (!b->first_edge)
		return -ENOMEM;
	for (int i = 0; i < lights; i++) {
		const int count = dome_cell_corners(b->dome, i, NULL, 0);

		b->first_edge[i + 1] = b->first_edge[i] + count;
		most = count > most ? count : most;
	}
	b->edge = calloc((size_t)b->first_edge[lights] + 1, sizeof(*b->edge));
	corner = calloc((size_t)most + 1, sizeof(*corner));
	for (int i = 0; b->edge && corner && i < lights; i++) {
		const int count = dome_cell_corners(b->dome, i, corner, most);

		for (int k = 0; k < count; k++, edges++) {
			vec_cross(corner[k], corner[(k + 1) % count], b->edge[edges]);
			vec_normalize(b->edge[edges]);
		}
	}
	free(corner);
	return edges == b->first_edge[lights] ? 0 : -ENOMEM;
}

/* How far, in pixels, all directions around one in a cell surely lie in the cell. */
static double cell_reach_px(const struct shares_builder *b, int cell, const double dir[3])
{
	double nearest = 1;

	for (int k = b->first_edge[cell]; k < b->first_edge[cell + 1]; k++)
		nearest = fmin(nearest, vec_dot(b->edge[k], dir));
	return (nearest - EDGE_SLACK) / b->turn;
}

static bool is_in_field(const struct shares_builder *b, double x, double y)
{
	const double *centre = b->lens->centre_px, *focal = b->lens->focal_px;
	const double u = (x - centre[0]) / focal[0], v = (y - centre[1]) / focal[1];

	return u * u + v * v < b->lens->rim * b->lens->rim * (1 - EDGE_SLACK);
}

/* Interpolates pixels of a block between four of them: a cubic in each of their numbers. */
static void interpolate_block(struct fisheye_pixel *pixel)
{
	enum { NUMBERS = sizeof(*pixel) / sizeof(double), STEP = (BLOCK - 1) / 3 };
	double number[BLOCK][NUMBERS];

	for (int i = 0; i < BLOCK; i += STEP)
		memcpy(number[i], &pixel[i], sizeof(number[i]));
	for (int i = 0; i < BLOCK; i++) {
		const double t = (double)i / STEP;
		const double w[4] = {(1 - t) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
				     t * (1 - t) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6};

		for (int n = 0; i % STEP && n < NUMBERS; n++)
			number[i][n] = w[0] * number[0][n] + w[1] * number[STEP][n] +
				       w[2] * number[2 * STEP][n] + w[3] * number[3 * STEP][n];
		memcpy(&pixel[i], number[i], sizeof(*pixel));
	}
}

static void look_at_row(struct shares_builder *b, int y)
{
	for (int x = 0, end; x < b->width; x = end) {
		const bool smooth = b->turn <= SMOOTH_RAD && x + BLOCK <= b->width &&
				    is_in_field(b, x + 0.5, y + 0.5) &&
				    is_in_field(b, x + BLOCK - 0.5, y + 0.5);

		end = x + BLOCK < b->width ? x + BLOCK : b->width;
		for (int i = x; i < end; i += smooth ? (BLOCK - 1) / 3 : 1) {
			const double px[2] = {i + 0.5, y + 0.5};

			if (!fisheye_pixel_of(b->lens, px, &b->pixel[i]))
				b->pixel[i].falloff = 0;
		}
		if (smooth)
			interpolate_block(b->pixel + x);
	}
}

/* The cells of a row of corners. Where a corner is far from its cell's edges, those beside it are
 * of the same cell. */
static void find_corner_lights(struct shares_builder *b, int y)
{
	int *row = b->corner_light + (size_t)y * (b->width + 1);

	for (int x = 0; x <= b->width; x++) {
		const double px[2] = {x, y};
		double dir[3], reach;
		int last;

		row[x] = fisheye_ray(b->lens, px, dir) ? dome_cell_of(b->dome, dir) : -1;
		if (row[x] < 0)
			continue;
		reach = fmin(cell_reach_px(b, row[x], dir), b->width - x);
		last = x + (reach > 0 ? (int)reach : 0);
		if (last > x && is_in_field(b, last, y))
			for (const int cell = row[x]; x < last; x++)
				row[x + 1] = cell;
	}
}

static int share_by_cell(struct shares_builder *b)
{
	const int err = find_edges(b);

	b->turn = fisheye_turn_per_pixel(b->lens);
	b->pixel = malloc((size_t)b->width * sizeof(*b->pixel));
	if (err)
		return err;
	b->corner_light = calloc((size_t)(b->width + 1) * (b->height + 1),
				 sizeof(*b->corner_light));
	if (!b->corner_light || !b->pixel)
		return -ENOMEM;
	for (int y = 0; y <= b->height; y++)
		find_corner_lights(b, y);
	for (int y = 0; y < b->height; y++) {
		look_at_row(b, y);
		for (int x = 0; x < b->width; x++) {
			const int ret = share_pixel(b, x, y);

			if (ret < 0)
				return ret;
		}
	}
	return 0;
}

/* Gives a light the pixel nearest to px, among the pixels around it whose centre sees the sky. */
static int share_nearest(struct shares_builder *b, int light, const double px[2])
{
	const int x0 = (int)floor(px[0]), y0 = (int)floor(px[1]);
	double best = INFINITY;
	int found[2] = {0, 0};

	for (int y = y0 - 2; y <= y0 + 2; y++)
		for (int x = x0 - 2; x <= x0 + 2; x++) {
			const double d = hypot(x + 0.5 - px[0], y + 0.5 - px[1]);

			if (x < 0 || y < 0 || x >= b->width || y >= b->height || d >= best ||
			    light_at(b, x + 0.5, y + 0.5) < 0)
				continue;
			best = d;
			found[0] = x;
			found[1] = y;
		}
	return best < INFINITY ? add_share(b, light, found[0], found[1], 1, NULL) : 0;
}

/* Gives a light the bilinear weights at its node, of the pixels whose centre sees the sky. Adds
 * none if the node lies outside the lens's field or the picture. */
static int share_node(struct shares_builder *b, int light)
{
	double px[2], total = 0;
	int x0, y0;

	if (!fisheye_project(b->lens, b->dome->direction[light], px))
		return 0;
	if (!(px[0] >= 0 && px[1] >= 0 && px[0] <= b->width && px[1] <= b->height))
		return 0;
	x0 = (int)floor(px[0] - 0.5);
	y0 = (int)floor(px[1] - 0.5);
	for (int k = 0; k < 4; k++) {
		const int x = x0 + (k & 1), y = y0 + (k >> 1);
		const double weight = (1 - fabs(x + 0.5 - px[0])) * (1 - fabs(y + 0.5 - px[1]));
		int ret;

		if (x < 0 || y < 0 || x >= b->width || y >= b->height || !(weight > 0) ||
		    light_at(b, x + 0.5, y + 0.5) < 0)
			continue;
		ret = add_share(b, light, x, y, weight, NULL);
		if (ret < 0)
			return ret;
		total += weight;
	}
	return total > 0 ? 0 : share_nearest(b, light, px);
}

/* Gives each light that no pixel reaches the weights at its node. */
static int share_missing(struct shares_builder *b)
{
	bool *done = calloc((size_t)b->dome->count, sizeof(*done));
	int ret = done ? finish_row(b) : -ENOMEM;

	for (size_t k = 0; ret == 0 && k < b->shares.runs; k++)
		done[b->shares.run[k].light / b->parts] = true;
	for (int i = 0; ret == 0 && i < b->dome->count; i++)
		ret = done[i] ? 0 : share_node(b, i);
	free(done);
	return ret;
}

/* Begins to share, among thirds unless the dome's cells are too wide. */
static int shares_begin(struct shares_builder *b, bool placed)
{
	const size_t lights = (size_t)b->dome->count;
	const int ret = placed ? dome_placed_create(&b->placed, b->dome) : 0;

	if (ret && ret != -EINVAL)
		return ret;
	b->parts = b->placed ? DOME_PLACED_THIRDS : 1;
	b->row_room = SUBPIXELS * SUBPIXELS * b->width;
	b->row = malloc((size_t)b->row_room * sizeof(*b->row));
	b->column = malloc((size_t)b->row_room * sizeof(*b->column));
	b->of_light = calloc(lights, sizeof(*b->of_light));
	b->shares.undimmed = calloc((size_t)b->parts * lights, sizeof(*b->shares.undimmed));
	return b->row && b->column && b->of_light && b->shares.undimmed ? 0 : -ENOMEM;
}

int sampler_shares_create(struct sampler_shares *shares, const struct dome *dome,
			  const struct fisheye *lens, int width, int height,
			  struct dome_placed **placed)
{
	struct shares_builder b = {.dome = dome, .lens = lens, .width = width, .height = height};
	int ret = shares_begin(&b, placed);

	if (ret == 0)
		ret = share_by_cell(&b);
	if (ret == 0)
		ret = share_missing(&b);
	if (ret == 0)
		ret = finish_row(&b);
	if (ret == 0 && b.placed)
		dome_placed_even(b.placed, b.shares.undimmed);
	free(b.corner_light);
	free(b.pixel);
	free(b.first_edge);
	free(b.edge);
	free(b.row);
	free(b.column);
	free(b.of_light);
	*shares = b.shares;
	if (placed)
		*placed = ret < 0 ? NULL : b.placed;
	if (ret < 0) {
		dome_placed_destroy(b.placed);
		sampler_shares_free(shares);
	}
	return ret;
}

void sampler_shares_free(struct sampler_shares *shares)
{
	free(shares->run);
	free(shares->weight);
	free(shares->undimmed);
	memset(shares, 0, sizeof(*shares));
}
