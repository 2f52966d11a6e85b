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

/* The four cells around a pixel and their weights. */
struct between {
	int at[4];
	float weight[4];
};

static struct between cells_between(const struct people *p, int x, int y)
{
	const float u = ((float)x + 0.5f) / (float)p->side - 0.5f;
	const float v = ((float)y + 0.5f) / (float)p->side - 0.5f;
	const int left = (int)floorf(u), top = (int)floorf(v);
	const float across = u - (float)left, down = v - (float)top;
	struct between b;

	for (int n = 0; n < 4; n++) {
		int cx = left + (n & 1), cy = top + (n >> 1);

		cx = cx < 0 ? 0 : cx >= p->across ? p->across - 1 : cx;
		cy = cy < 0 ? 0 : cy >= p->down ? p->down - 1 : cy;
		b.at[n] = cy * p->across + cx;
		b.weight[n] = (n & 1 ? across : 1 - across) * (n >> 1 ? down : 1 - down);
		if (!p->watch[b.at[n]]) /* as the cell that the pixel is in */
			b.at[n] = y / p->side * p->across + x / p->side;
	}
	return b;
}

static float clamp_share(float f)
{
	return f > 0 ? f < 1 ? f : 1 : 0;
}

static uint8_t share_code(float f)
{
	return (uint8_t)(f * 255 + 0.5f);
}

/* What there is beside a cell at the edge of a person. */
struct edge {
	struct sides sides;
	bool told;  /* both sides are seen */
	bool front; /* he is before the object */
};

/* A pixel: what is seen, and the place in the light beside the edge. */
struct pixel {
	float seen[3], place[3];
};

static struct pixel read_pixel(const struct people *p, const struct edge *edge,
			       const struct between *b, const uint8_t *in)
{
	struct pixel pixel = {.place = {0}};

	for (int c = 0; c < 3; c++) {
		pixel.seen[c] = (float)p->tables.decode[in[2 - c]];
		for (int n = 0; n < 4; n++)
			pixel.place[c] += b->weight[n] * p->place[c][b->at[n]];
		if (edge->told)
			pixel.place[c] *= edges_light(&edge->sides, c);
	}
	return pixel;
}

/* F = (C - (1 - f) B) / f, as a code value. */
static void draw_foremost(const struct people *p, const struct pixel *pixel, float f, uint8_t *out)
{
	for (int c = 0; c < 3; c++) {
		const float colour = (pixel->seen[c] - (1 - f) * pixel->place[c]) / f;

		out[2 - c] =
			p->tables.encode[(int)(colour > 0 ? colour < WHITE ? colour : WHITE : 0)];
	}
}

static void draw_pixel(struct people *p, const struct picture *picture, const struct edge *edge,
		       int x, int y)
{
	const size_t at = (size_t)y * (size_t)p->settings.width + (size_t)x;
	const uint8_t *in = picture->origin + y * picture->y_step + x * picture->x_step;
	const struct between b = cells_between(p, x, y);
	const struct pixel pixel = read_pixel(p, edge, &b, in);
	float share = 0;

	for (int n = 0; n < 4; n++)
		share += b.weight[n] * (float)(p->order[b.at[n]] > 0);
	if (edge->told) {
		const float own = edges_share(p, &edge->sides, pixel.seen, pixel.place);

		share += OWN * (clamp_share(own) - share);
	}
	share = clamp_share((share - 0.5f) * STEEPNESS + 0.5f);
	p->anybody[at] = share_code(share);
	p->front[at] = edge->front ? p->anybody[at] : 0;
	if (p->front[at] > 0 && p->front[at] < 255)
		draw_foremost(p, &pixel, share, p->foremost + 4 * at);
}

enum presence { NOBODY, ALL_ALIKE, SOME };

/* Who is in a tile's cells and those beside them. */
static enum presence tile_presence(const struct people *p, int tx, int ty)
{
	const int cells = BASIS_TILE / p->side;
	int count[3] = {0}, all = 0;

	for (int y = ty * cells - 1; y <= (ty + 1) * cells; y++)
		for (int x = tx * cells - 1; x <= (tx + 1) * cells; x++) {
			if (y < 0 || x < 0 || y >= p->down || x >= p->across)
				continue;
			count[p->order[y * p->across + x]]++;
			all++;
		}
	return count[0] == all ? NOBODY : count[1] == all || count[2] == all ? ALL_ALIKE : SOME;
}

static void fill_tile(struct people *p, const struct picture *picture, int tx, int ty)
{
	const int x = tx * BASIS_TILE, side = BASIS_TILE / p->side;
	const int width = picture->width - x < BASIS_TILE ? picture->width - x : BASIS_TILE;
	const uint8_t order = p->order[ty * side * p->across + tx * side];

	for (int y = ty * BASIS_TILE; y < (ty + 1) * BASIS_TILE && y < picture->height; y++) {
		const size_t at = (size_t)y * (size_t)picture->width + (size_t)x;

		memset(p->front + at, order == 2 ? 255 : 0, (size_t)width);
		memset(p->anybody + at, 255, (size_t)width);
	}
}

/* Whether all cells around have the cell's order: then so have all its pixels. Else *front: groups do
 * not touch, so one order is there. */
static bool is_inside(const struct people *p, int x, int y, bool *front)
{
	const int at = y * p->across + x;
	bool alike = true;

	*front = false;
	for (int v = y ? y - 1 : y; v <= y + 1 && v < p->down; v++)
		for (int u = x ? x - 1 : x; u <= x + 1 && u < p->across; u++) {
			const int beside = v * p->across + u;

			if (!p->watch[beside])
				continue;
			alike &= p->order[beside] == p->order[at];
			*front |= p->order[beside] == 2;
		}
	return alike;
}

static void draw_cell(struct people *p, const struct picture *picture, int cx, int cy)
{
	const int cell = cy * p->across + cx;
	struct edge edge;
	const bool inside = is_inside(p, cx, cy, &edge.front) || !p->watch[cell];

	if (!inside) {
		edge.sides = edges_around(p, p->verdict, cx, cy);
		edge.told = edge.sides.people && edge.sides.others && p->known[cell];
	}
	for (int y = cy * p->side; y < (cy + 1) * p->side && y < picture->height; y++)
		for (int x = cx * p->side; x < (cx + 1) * p->side && x < picture->width; x++) {
			const size_t at = (size_t)y * (size_t)picture->width + (size_t)x;

			if (inside) {
				p->front[at] = p->order[cell] == 2 ? 255 : 0;
				p->anybody[at] = p->order[cell] ? 255 : 0;
			} else {
				draw_pixel(p, picture, &edge, x, y);
			}
		}
}

static void draw_tile(struct people *p, const struct picture *picture, int tx, int ty)
{
	const int cells = BASIS_TILE / p->side;

	for (int y = ty * cells; y < (ty + 1) * cells && y < p->down; y++)
		for (int x = tx * cells; x < (tx + 1) * cells && x < p->across; x++)
			draw_cell(p, picture, x, y);
}

/* Whether a tile, or the cells beside it, reach into the box of all people. */
static bool is_near_box(const struct people *p, int tx, int ty)
{
	const int cells = BASIS_TILE / p->side;
	const struct box *box = &p->box;

	return tx * cells - 1 <= box->right && (tx + 1) * cells >= box->left &&
	       ty * cells - 1 <= box->bottom && (ty + 1) * cells >= box->top;
}

void outline_draw(struct people *p, const struct picture *picture)
{
	if (!p->visited)
		return;
	for (int ty = 0; ty < p->tiles_down; ty++)
		for (int tx = 0; tx < p->tiles_across; tx++) {
			uint8_t *tile = &p->tile[ty * p->tiles_across + tx];

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
