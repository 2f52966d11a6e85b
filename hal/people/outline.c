/* SPDX-License-Identifier: MIT */
/*
 * From cells to pixels. Off the object the edge of a person is the cells' own, drawn between their
 * centres. On the object it is a matte that follows the picture: a guided filter (He, Sun and Tang
 * 2013; at the cells' resolution, He and Sun 2015), which in each window of cells fits
 *
 *     front = slope grey + offset
 *
 * in least squares, and takes the grey of the pixels themselves.
 */
#include <math.h>
#include <string.h>

#include "hal/people/people_parts.h"

#define WINDOW 2				 /* cells on each side */
#define FLATNESS (0.02f * WHITE * 0.02f * WHITE) /* variance of grey that counts as an edge */
#define STEEPNESS 2.0f				 /* of an edge that is drawn between cells */

static float grey_of(float r, float g, float b)
{
	return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

static float cell_grey(const struct people *p, int at)
{
	return grey_of(p->seen[0][at], p->seen[1][at], p->seen[2][at]);
}

/* Fits the matte around a cell. False: no edge of a person in front is near. */
static bool fit_matte(const struct people *p, int x, int y, float *slope, float *offset)
{
	float grey = 0, front = 0, grey2 = 0, both = 0;
	int count = 0, ones = 0;

	for (int v = y - WINDOW; v <= y + WINDOW; v++)
		for (int u = x - WINDOW; u <= x + WINDOW; u++) {
			const int at = v * p->across + u;
			float i, f;

			if (v < 0 || u < 0 || v >= p->down || u >= p->across || !p->watch[at])
				continue;
			i = cell_grey(p, at);
			f = p->order[at] == 2;
			grey += i;
			front += f;
			grey2 += i * i;
			both += i * f;
			ones += p->order[at] == 2;
			count++;
		}
	if (ones == 0 || ones == count)
		return false;
	grey /= (float)count;
	front /= (float)count;
	*slope = (both / (float)count - grey * front) /
		 (grey2 / (float)count - grey * grey + FLATNESS);
	*offset = front - *slope * grey;
	return true;
}

/* The matte around a cell, fitted when it is first asked for in a frame. */
static void matte_of(struct people *p, int at)
{
	if (p->fitted[at] == p->frame + 1)
		return;
	p->fitted[at] = p->frame + 1;
	if (!fit_matte(p, at % p->across, at / p->across, &p->slope[at], &p->offset[at])) {
		p->slope[at] = 0;
		p->offset[at] = p->order[at] == 2;
	}
}

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

static float share_of(const struct people *p, const struct between *b, int least)
{
	float sum = 0;

	for (int n = 0; n < 4; n++)
		sum += b->weight[n] * (float)(p->order[b->at[n]] >= least);
	return clamp_share((sum - 0.5f) * STEEPNESS + 0.5f);
}

static uint8_t share_code(float f)
{
	return (uint8_t)(f * 255 + 0.5f);
}

/* F = (C - (1 - f) B) / f, as a code value. */
static void draw_foremost(struct people *p, const struct between *b, const uint8_t *in, float f,
			  uint8_t *out)
{
	for (int c = 0; c < 3; c++) {
		const float seen = (float)p->tables.decode[in[2 - c]];
		float place = 0, colour;

		for (int n = 0; n < 4; n++)
			place += b->weight[n] * p->place[c][b->at[n]];
		colour = (seen - (1 - f) * place) / f;
		colour = colour > 0 ? colour < WHITE ? colour : WHITE : 0;
		out[2 - c] = p->tables.encode[(int)colour];
	}
}

static void draw_pixel(struct people *p, const struct picture *picture, int x, int y)
{
	const size_t at = (size_t)y * (size_t)p->settings.width + (size_t)x;
	const uint8_t *in = picture->origin + y * picture->y_step + x * picture->x_step;
	const struct between b = cells_between(p, x, y);
	float front = share_of(p, &b, 2), anybody = share_of(p, &b, 1);

	if (p->object.coverage[at]) {
		const float grey = grey_of((float)p->tables.decode[in[2]],
					   (float)p->tables.decode[in[1]],
					   (float)p->tables.decode[in[0]]);
		float slope = 0, offset = 0;

		for (int n = 0; n < 4; n++) {
			matte_of(p, b.at[n]);
			slope += b.weight[n] * p->slope[b.at[n]];
			offset += b.weight[n] * p->offset[b.at[n]];
		}
		front = clamp_share((slope * grey + offset - 0.5f) * STEEPNESS + 0.5f);
	}
	anybody = anybody > front ? anybody : front;
	p->front[at] = share_code(front);
	p->anybody[at] = share_code(anybody);
	if (p->front[at] > 0 && p->front[at] < 255)
		draw_foremost(p, &b, in, front, p->foremost + 4 * at);
}

enum presence { NOBODY, ALL_ALIKE, SOME };

/* Who is in a tile's cells and those beside them. */
static enum presence tile_presence(const struct people *p, int tx, int ty)
{
	const int cells = BASIS_TILE / p->side;
	int count[3] = {0}, all = 0;

	for (int y = ty * cells - WINDOW; y < (ty + 1) * cells + WINDOW; y++)
		for (int x = tx * cells - WINDOW; x < (tx + 1) * cells + WINDOW; x++) {
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

/* Whether all cells around have the cell's order: then so have all its pixels. */
static bool is_inside(const struct people *p, int x, int y)
{
	const int at = y * p->across + x;

	for (int v = y ? y - 1 : y; v <= y + 1 && v < p->down; v++)
		for (int u = x ? x - 1 : x; u <= x + 1 && u < p->across; u++)
			if (p->watch[v * p->across + u] &&
			    p->order[v * p->across + u] != p->order[at])
				return false;
	return true;
}

static void draw_cell(struct people *p, const struct picture *picture, int cx, int cy)
{
	const int cell = cy * p->across + cx;
	const uint8_t order = p->order[cell];
	const bool inside = !p->watch[cell] || is_inside(p, cx, cy);

	for (int y = cy * p->side; y < (cy + 1) * p->side && y < picture->height; y++)
		for (int x = cx * p->side; x < (cx + 1) * p->side && x < picture->width; x++) {
			const size_t at = (size_t)y * (size_t)picture->width + (size_t)x;

			if (inside) {
				p->front[at] = order == 2 ? 255 : 0;
				p->anybody[at] = order ? 255 : 0;
			} else {
				draw_pixel(p, picture, x, y);
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

	return tx * cells - WINDOW <= box->right && (tx + 1) * cells + WINDOW > box->left &&
	       ty * cells - WINDOW <= box->bottom && (ty + 1) * cells + WINDOW > box->top;
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
