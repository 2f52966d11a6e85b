/* SPDX-License-Identifier: MIT */
#include "hal/lights/sampler_shares.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

#define SUBPIXELS 8 /* sub-pixels per side, in pixels that straddle cells */

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
	struct dome_placed *placed; /* NULL: shares are of lights, else of thirds */
	int parts;		    /* of a light: DOME_PLACED_THIRDS, or 1 */
	int y, row_count, row_room;
	struct row_share *row;	    /* [row_room]: from left to right */
	int *column;		    /* [row_room]: their places, light by light */
	struct row_light *of_light; /* [lights]: 0 between rows */
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

/* Counts sub-pixels by light. Inside a pixel it interpolates the direction bilinearly between the
 * corners (error 1e-3 pixels in a picture of 480 x 480), which is much cheaper than the lens; but
 * not at the rim, where a corner does not see the sky. */
static void count_subpixels(const struct shares_builder *b, int x, int y,
			    struct subpixel_tally *tally)
{
	double corner[4][3];
	const bool whole = corner_rays(b, x, y, corner);

	tally->kinds = 0;
	for (int k = 0; k < SUBPIXELS * SUBPIXELS; k++) {
		const double s = (k % SUBPIXELS + 0.5) / SUBPIXELS,
			     t = (k / SUBPIXELS + 0.5) / SUBPIXELS;
		double dir[3];

		for (int c = 0; c < 3 && whole; c++)
			dir[c] = (1 - t) * ((1 - s) * corner[0][c] + s * corner[1][c]) +
				 t * ((1 - s) * corner[2][c] + s * corner[3][c]);
		tally_add(tally, whole ? dome_cell_of(b->dome, dir) : light_at(b, x + s, y + t));
	}
}

/* Shares a pixel among cells. Cells are convex: if all four corners lie in one, the pixel does. */
static int share_pixel(struct shares_builder *b, int x, int y)
{
	const double px[2] = {x + 0.5, y + 0.5};
	struct fisheye_pixel pixel;
	const int first = corner_light(b, x, y);
	struct subpixel_tally tally;
	int ret = 0;

	if (!fisheye_pixel_of(b->lens, px, &pixel) || !(pixel.dir[2] >= 0))
		return 0;
	if (first >= 0 && first == corner_light(b, x + 1, y) &&
	    first == corner_light(b, x, y + 1) && first == corner_light(b, x + 1, y + 1))
		return add_share(b, first, x, y, pixel.sr, &pixel);
	count_subpixels(b, x, y, &tally);
	for (int k = 0; k < tally.kinds && ret == 0; k++)
		ret = add_share(b, tally.light[k], x, y,
				pixel.sr * tally.count[k] / (SUBPIXELS * SUBPIXELS), &pixel);
	return ret;
}

static int share_by_cell(struct shares_builder *b)
{
	b->corner_light = calloc((size_t)(b->width + 1) * (b->height + 1),
				 sizeof(*b->corner_light));
	if (!b->corner_light)
		return -ENOMEM;
	for (int y = 0; y <= b->height; y++)
		for (int x = 0; x <= b->width; x++)
			b->corner_light[(size_t)y * (b->width + 1) + x] = light_at(b, x, y);
	for (int y = 0; y < b->height; y++)
		for (int x = 0; x < b->width; x++) {
			const int ret = share_pixel(b, x, y);

			if (ret < 0)
				return ret;
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
