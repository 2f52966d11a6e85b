/* SPDX-License-Identifier: MIT */
#include "hal/measure/thesis.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

static size_t rows_of(const struct unpacked *t)
{
	return 3 * (size_t)t->lights;
}

int unpacked_create(struct unpacked *t, const struct basis *basis)
{
	*t = (struct unpacked){.lights = (int)basis->info.lights};
	t->object = malloc(rows_of(t) * sizeof(*t->object));
	t->unlit = malloc(rows_of(t) * sizeof(*t->unlit));
	t->taken = malloc(rows_of(t) * sizeof(*t->taken));
	if (!t->object || !t->unlit || !t->taken) {
		unpacked_free(t);
		return -ENOMEM;
	}
	return 0;
}

void unpacked_free(struct unpacked *t)
{
	free(t->object);
	free(t->unlit);
	free(t->taken);
	*t = (struct unpacked){.lights = 0};
}

/* The values of one light in a line of pixels, per unit of X. */
struct unpacked_line {
	const struct basis_block *block;
	int first, count; /* pixels, in the block's list */
	int channel;	  /* in the block */
	float value[BASIS_LINE8];
};

static void add_column8(struct unpacked_line *l, int column)
{
	const struct basis_block *b = l->block;
	int8_t v[BASIS_LINE8];

	basis_column8_line(b, column, l->channel, l->first / BASIS_LINE8, v);
	for (int p = 0; p < l->count; p++)
		l->value[p] += b->column_scale[column] * v[p];
}

static void add_line16(struct unpacked_line *l, const int16_t *lines, int count, int which,
		       float factor)
{
	const int panels = basis_panels16(l->block->pixels);

	for (int first = 0; first < l->count; first += BASIS_LINE16) {
		const int panel = (l->first + first) / BASIS_LINE16;
		const int16_t *v = lines + basis_line16(panels, count, l->channel, panel, which) *
						   BASIS_LINE16;
		const int left = l->count - first;

		for (int p = 0; p < left && p < BASIS_LINE16; p++)
			l->value[first + p] += factor * v[p];
	}
}

/* Returns the weight of pattern j in light i. */
static float pattern_share(const struct basis *basis, const struct basis_block *b, int j, int i)
{
	const int16_t *pattern = b->pattern + (size_t)j * (size_t)b->stride;
	float sum = 0;

	if (!basis->coarse)
		return b->pattern_scale[j] * pattern[i];
	for (int k = 0; k < 3; k++)
		sum += (float)basis->coarse[i].weight[k] * pattern[basis->coarse[i].index[k]];
	return b->pattern_scale[j] * sum / BASIS_COARSE_ONE;
}

/* Fills in a line. column: of the light, or -1 if it has none. share: [patterns]. */
static void fill_line(struct unpacked_line *l, int column, const float *share)
{
	const struct basis_block *b = l->block;

	memset(l->value, 0, sizeof(l->value));
	for (int j = 0; j < b->patterns; j++)
		add_line16(l, b->coefficient, b->patterns, j, share[j]);
	if (column < 0)
		return;
	if (b->bits == 8)
		add_column8(l, column);
	else
		add_line16(l, b->column16, b->columns, column, b->column_scale[column]);
}

static void add_line(struct unpacked *t, const struct unpacked_line *l, int channel, float unit,
		     int light)
{
	const struct basis_block *b = l->block;
	const size_t row = (size_t)channel * (size_t)t->lights + (size_t)light;
	float *to = b->kind == BASIS_KIND_T   ? t->object[row]
		    : b->kind == BASIS_KIND_U ? t->unlit[row]
					      : t->taken[row];

	for (int p = 0; p < l->count; p++) {
		const int at = l->first + p;
		const float tint =
			b->tint ? (float)b->tint[channel * b->pixels + at] / BASIS_TINT_ONE : 1;

		to[b->pixel[at]] += unit * tint * l->value[p];
	}
}

/* Adds the values of one light in a block. */
static void unpacked_add_light(struct unpacked *t, const struct basis *basis,
			       const struct basis_block *b, int column, int light)
{
	float share[BASIS_PATTERNS_MAX];

	for (int j = 0; j < b->patterns; j++)
		share[j] = pattern_share(basis, b, j, light);
	for (int c = 0; c < b->channels; c++) {
		struct unpacked_line l = {.block = b, .channel = c};

		for (l.first = 0; l.first < b->pixels; l.first += BASIS_LINE8) {
			l.count = b->pixels - l.first;
			l.count = l.count < BASIS_LINE8 ? l.count : BASIS_LINE8;
			fill_line(&l, column, share);
			for (int to = c; to < (b->channels == 3 ? c + 1 : 3); to++) {
				const double unit = b->kind == BASIS_KIND_V
							    ? basis_ground(basis, b->ground,
									   to)[light]
							    : basis->lights[light].solid_angle_sr;

				add_line(t, &l, to, (float)unit, light);
			}
		}
	}
}

static void unpacked_mark(struct unpacked *t, const struct basis *basis,
			  const struct basis_block *b)
{
	bool *is = b->kind == BASIS_KIND_T ? t->is_object : t->is_receiver;

	for (int p = 0; p < b->pixels; p++) {
		is[b->pixel[p]] = true;
		for (int c = 0; b->kind == BASIS_KIND_V && c < 3; c++) {
			const double *u = basis_ground(basis, b->ground, c);

			for (int i = 0; i < t->lights; i++)
				t->unlit[c * t->lights + i][b->pixel[p]] = (float)u[i];
		}
	}
}

void unpacked_fill(struct unpacked *t, const struct basis *basis, const struct basis_tile *tile)
{
	memset(t->object, 0, rows_of(t) * sizeof(*t->object));
	memset(t->unlit, 0, rows_of(t) * sizeof(*t->unlit));
	memset(t->taken, 0, rows_of(t) * sizeof(*t->taken));
	memset(t->is_object, 0, sizeof(t->is_object));
	memset(t->is_receiver, 0, sizeof(t->is_receiver));
	for (int k = 0; k < tile->block_count; k++) {
		const struct basis_block *b = &tile->blocks[k];
		int column = 0;

		unpacked_mark(t, basis, b);
		for (int i = 0; i < t->lights; i++) {
			const bool own = column < b->columns && b->light[column] == i;

			if (own || b->patterns)
				unpacked_add_light(t, basis, b, own ? column : -1, i);
			column += own;
		}
	}
}
