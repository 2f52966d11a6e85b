/* SPDX-License-Identifier: MIT */
/*
 * From cells to pixels. Beside the edge of a person a pixel's share of him is
 *
 *     f = (1 - OWN) c + OWN alpha
 *
 * with c the cells' own share, drawn between their centres, and alpha what the pixel's colour tells
 * (edges.c); alpha alone would have the noise of one pixel.
 */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define OWN 0.8f
#define STEEPNESS 1.4f /* of f about a half: noise of pixels is not to be seen off the edge */

static inline float clamp_share(float f)
{
	const float least = f > 0 ? f : 0; /* in two steps, as processors do it */

	return least < 1 ? least : 1;
}

/* What pixels at the edge of a person need to know, of which those in a quarter of a cell have the
 * same. */
struct edge {
	struct sides sides;
	bool front;	   /* he is before the object */
	float share[4];	   /* of him in the four cells around, */
	float place[3][4]; /* and the place, in the light beside the edge */
};

/* Finds the four cells around the pixels of a quarter: right, low: which one. Cells that are not
 * watched are as that in which the pixels are. */
static void edge_ask(struct edge *edge, const struct people *p, int cx, int cy, int right, int low)
{
	for (int n = 0; n < 4; n++) {
		const int u = cx - 1 + right + (n & 1), v = cy - 1 + low + (n >> 1);
		const int x = u < 0 ? 0 : u >= p->cells.across ? p->cells.across - 1 : u;
		const int y = v < 0 ? 0 : v >= p->cells.down ? p->cells.down - 1 : v;
		const int beside = y * p->cells.across + x;
		const int at = p->cells.watch[beside] ? beside : cy * p->cells.across + cx;

		edge->share[n] = p->crowd.order[at] > 0;
		for (int c = 0; c < 3; c++)
			edge->place[c][n] = p->place.expected[c][at] *
					    (edge->sides.both ? edge->sides.light[c] : 1);
	}
}

/* Some pixels of a quarter of a cell, side by side; those that there are not are 0. */
struct pixels {
	int count;
	size_t at[PIXEL_LANES]; /* in the picture */
	float weight[4][PIXEL_LANES], seen[3][PIXEL_LANES], place[3][PIXEL_LANES];
	float share[PIXEL_LANES];
};

/* x, y: in the picture; across, down: the pixel's middle from that of the upper left one of the
 * four cells, in cells. */
static void add_pixel(struct pixels *px, const struct people *p, const struct picture *picture,
		      int x, int y, float across, float down)
{
	const uint8_t *in = picture->origin + y * picture->y_step + x * picture->x_step;
	const int k = px->count++;

	px->at[k] = (size_t)y * (size_t)picture->width + (size_t)x;
	px->weight[0][k] = (1 - across) * (1 - down);
	px->weight[1][k] = across * (1 - down);
	px->weight[2][k] = (1 - across) * down;
	px->weight[3][k] = across * down;
	for (int c = 0; c < 3; c++)
		px->seen[c][k] = (float)p->tables.decode[in[2 - c]];
}

/* right, low: which quarter of the cell; first: of its pixels. */
static struct pixels quarter_read(const struct people *p, const struct picture *picture, int cx,
				  int cy, int right, int low, int first)
{
	const int half = p->cells.side / 2;
	const int left = cx * p->cells.side + right * half, top = cy * p->cells.side + low * half;
	const float step = 1 / (float)p->cells.side;
	struct pixels px = {.count = 0};

	for (int k = first; k < first + PIXEL_LANES && k < half * half; k++) {
		const int u = k % half, v = k / half;

		if (left + u < picture->width && top + v < picture->height)
			add_pixel(&px, p, picture, left + u, top + v,
				  ((float)u + 0.5f) * step + (right ? 0 : 0.5f),
				  ((float)v + 0.5f) * step + (low ? 0 : 0.5f));
	}
	return px;
}

static void lanes_between(const float weight[4][PIXEL_LANES], const float of[4],
			  float *restrict out)
{
	for (int k = 0; k < PIXEL_LANES; k++)
		out[k] = weight[0][k] * of[0] + weight[1][k] * of[1] + weight[2][k] * of[2] +
			 weight[3][k] * of[3];
}

static void quarter_share(struct pixels *px, const struct people *p, const struct edge *edge)
{
	float own[PIXEL_LANES];

	lanes_between(px->weight, edge->share, px->share);
	for (int c = 0; c < 3; c++)
		lanes_between(px->weight, edge->place[c], px->place[c]);
	if (edge->sides.both) {
		edges_share(p, &edge->sides, px->seen, px->place, own);
		for (int k = 0; k < PIXEL_LANES; k++)
			px->share[k] += OWN * (clamp_share(own[k]) - px->share[k]);
	}
	for (int k = 0; k < PIXEL_LANES; k++)
		px->share[k] = clamp_share((px->share[k] - 0.5f) * STEEPNESS + 0.5f);
}

/* F = (C - (1 - f) B) / f, as a code value. */
static void draw_foremost(const struct people *p, const struct pixels *px, int k, uint8_t *out)
{
	const float f = px->share[k];

	for (int c = 0; c < 3; c++) {
		const float colour = (px->seen[c][k] - (1 - f) * px->place[c][k]) / f;

		out[2 - c] =
			p->tables.encode[(int)(colour > 0 ? colour < WHITE ? colour : WHITE : 0)];
	}
}

static void draw_pixels(struct people *p, struct pixels *px, const struct edge *edge)
{
	quarter_share(px, p, edge);
	for (int k = 0; k < px->count; k++) {
		const uint8_t code = (uint8_t)(px->share[k] * 255 + 0.5f);

		p->outline.anybody[px->at[k]] = code;
		p->outline.front[px->at[k]] = edge->front ? code : 0;
		if (edge->front && code > 0 && code < 255)
			draw_foremost(p, px, k, p->outline.foremost + 4 * px->at[k]);
	}
}

static void draw_quarter(struct people *p, const struct picture *picture, struct edge *edge, int cx,
			 int cy, int quarter)
{
	const int right = quarter & 1, low = quarter >> 1;
	const int pixels = p->cells.side * p->cells.side / 4;

	edge_ask(edge, p, cx, cy, right, low);
	for (int first = 0; first < pixels; first += PIXEL_LANES) {
		struct pixels px = quarter_read(p, picture, cx, cy, right, low, first);

		draw_pixels(p, &px, edge);
	}
}

enum presence { NOBODY, ALL_ALIKE, SOME };

/* Who is in a tile's cells and those beside them. */
static enum presence tile_presence(const struct people *p, int tx, int ty)
{
	const int cells = BASIS_TILE / p->cells.side;
	int count[3] = {0}, all = 0;

	for (int y = ty * cells - 1; y <= (ty + 1) * cells; y++)
		for (int x = tx * cells - 1; x <= (tx + 1) * cells; x++) {
			if (y < 0 || x < 0 || y >= p->cells.down || x >= p->cells.across)
				continue;
			count[p->crowd.order[y * p->cells.across + x]]++;
			all++;
		}
	return count[0] == all ? NOBODY : count[1] == all || count[2] == all ? ALL_ALIKE : SOME;
}

static void fill_tile(struct people *p, const struct picture *picture, int tx, int ty)
{
	const int x = tx * BASIS_TILE, side = BASIS_TILE / p->cells.side;
	const int width = picture->width - x < BASIS_TILE ? picture->width - x : BASIS_TILE;
	const uint8_t order = p->crowd.order[ty * side * p->cells.across + tx * side];

	for (int y = ty * BASIS_TILE; y < (ty + 1) * BASIS_TILE && y < picture->height; y++) {
		const size_t at = (size_t)y * (size_t)picture->width + (size_t)x;

		memset(p->outline.front + at, order == 2 ? 255 : 0, (size_t)width);
		memset(p->outline.anybody + at, 255, (size_t)width);
	}
}

/* Whether all cells around have the cell's order: then so have all its pixels. Else *front: groups
 * do not touch, so one order is there. */
static bool is_inside(const struct people *p, int x, int y, bool *front)
{
	const int at = y * p->cells.across + x;
	bool alike = true;

	*front = false;
	for (int v = y ? y - 1 : y; v <= y + 1 && v < p->cells.down; v++)
		for (int u = x ? x - 1 : x; u <= x + 1 && u < p->cells.across; u++) {
			const int beside = v * p->cells.across + u;

			if (!p->cells.watch[beside])
				continue;
			alike &= p->crowd.order[beside] == p->crowd.order[at];
			*front |= p->crowd.order[beside] == 2;
		}
	return alike;
}

/* A cell whose pixels all are as it is. */
static void fill_cell(struct people *p, const struct picture *picture, int cx, int cy)
{
	const uint8_t order = p->crowd.order[cy * p->cells.across + cx];
	const int x = cx * p->cells.side;
	const int wide = picture->width - x < p->cells.side ? picture->width - x : p->cells.side;

	for (int y = cy * p->cells.side; y < (cy + 1) * p->cells.side && y < picture->height; y++) {
		const size_t at = (size_t)y * (size_t)picture->width + (size_t)x;

		memset(p->outline.front + at, order == 2 ? 255 : 0, (size_t)wide);
		memset(p->outline.anybody + at, order ? 255 : 0, (size_t)wide);
	}
}

static void draw_cell(struct people *p, const struct picture *picture, int cx, int cy)
{
	const int cell = cy * p->cells.across + cx;
	struct edge edge;

	if (is_inside(p, cx, cy, &edge.front) || !p->cells.watch[cell]) {
		fill_cell(p, picture, cx, cy);
		return;
	}
	edge.sides = edges_around(p, cx, cy);
	edge.sides.both &= p->place.known[cell] != 0;
	for (int quarter = 0; quarter < 4; quarter++)
		draw_quarter(p, picture, &edge, cx, cy, quarter);
}

static void draw_tile(struct people *p, const struct picture *picture, int tx, int ty)
{
	const int cells = BASIS_TILE / p->cells.side;

	for (int y = ty * cells; y < (ty + 1) * cells && y < p->cells.down; y++)
		for (int x = tx * cells; x < (tx + 1) * cells && x < p->cells.across; x++)
			draw_cell(p, picture, x, y);
}

/* Whether a tile, or the cells beside it, reach into the box of all people. */
static bool is_near_box(const struct people *p, int tx, int ty)
{
	const int cells = BASIS_TILE / p->cells.side;
	const struct box *box = &p->verdict.box;

	return tx * cells - 1 <= box->right && (tx + 1) * cells >= box->left &&
	       ty * cells - 1 <= box->bottom && (ty + 1) * cells >= box->top;
}

void outline_draw(struct people *p, const struct picture *picture)
{
	if (!p->visited)
		return;
	edges_mark(p, p->verdict.of);
	for (int ty = 0; ty < p->tiles_down; ty++)
		for (int tx = 0; tx < p->tiles_across; tx++) {
			uint8_t *tile = &p->outline.tile[ty * p->tiles_across + tx];

			const enum presence presence =
				p->object.touched[ty * p->tiles_across + tx] &&
						is_near_box(p, tx, ty)
					? tile_presence(p, tx, ty)
					: NOBODY;

			*tile = presence != NOBODY;
			if (presence == ALL_ALIKE)
				fill_tile(p, picture, tx, ty);
			else if (presence == SOME)
				draw_tile(p, picture, tx, ty);
		}
}
