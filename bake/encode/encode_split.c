/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_split.h"

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/profile.h"

#define TINT_ROUNDS 16
/* Short lines that use up all that one light may be off by leave nothing to skies. */
#define SPENT_FIRST 0.5F

int split_create(struct split *split, const struct encode_settings *settings)
{
	int err;

	*split = (struct split){.mono = false};
	err = rank_metric_create(&split->metric, settings);
	if (!err)
		err = rank_patterns_create(&split->mono_patterns, settings);
	if (!err)
		err = rank_patterns_create(&split->colour_patterns, settings);
	if (!err)
		err = rank_scratch_create(&split->scratch, settings);
	return err;
}

void split_free(struct split *split)
{
	rank_metric_free(&split->metric);
	rank_patterns_free(&split->mono_patterns);
	rank_patterns_free(&split->colour_patterns);
	rank_scratch_free(&split->scratch);
	free(split->own_mono);
	free(split->own_colour);
	free(split->mono_left);
	free(split->colour_left);
	*split = (struct split){.mono = false};
}

bool split_possible(const struct part *part, enum split_way way)
{
	if (way == SPLIT_PLAIN)
		return true;
	if (part->channels == 1 || part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U)
		return false;
	return way == SPLIT_DIRECT ? part->direct != NULL
				   : part->kind == BASIS_KIND_T || part->direct_channels == 3;
}

/* ---- one channel and a tint ---- */

/* The direction in which three channels mostly vary together: power iteration on their products. */
static void main_hue(double product[3][3], double hue[3])
{
	for (int c = 0; c < 3; c++)
		hue[c] = 1;
	for (int round = 0; round < TINT_ROUNDS; round++) {
		double next[3], most = 0;

		for (int c = 0; c < 3; c++) {
			next[c] = 0;
			for (int k = 0; k < 3; k++)
				next[c] += product[c][k] * hue[k];
			most = fmax(most, fabs(next[c]));
		}
		if (!(most > 0))
			return;
		for (int c = 0; c < 3; c++)
			hue[c] = next[c] / most;
	}
}

static void find_tints(struct split *split, const struct encode_settings *settings,
		       const float *value)
{
	const struct part *part = split->part;
	const int pixels = part->pixels, rows = 3 * pixels;
	static _Thread_local double product[PART_PIXELS][3][3];

	memset(product, 0, sizeof(product));
	for (int i = 0; i < settings->lights; i++) {
		const float *v = value + (size_t)i * (size_t)rows;

		for (int p = 0; p < pixels; p++)
			for (int a = 0; a < 3; a++)
				for (int b = a; b < 3; b++)
					product[p][a][b] += (double)(part->weight[i] *
								     v[a * pixels + p] *
								     v[b * pixels + p]);
	}
	for (int p = 0; p < pixels; p++) {
		double hue[3], most = 0;

		for (int a = 0; a < 3; a++)
			for (int b = 0; b < a; b++)
				product[p][a][b] = product[p][b][a];
		main_hue(product[p], hue);
		for (int c = 0; c < 3; c++)
			most = fmax(most, hue[c]);
		for (int c = 0; c < 3; c++) {
			const double share = most > 0 ? fmax(hue[c] / most, 0) : 1;

			split->tint[c][p] = (uint16_t)lrint(share * BASIS_TINT_ONE);
			split->tint_share[c][p] = (float)split->tint[c][p] / BASIS_TINT_ONE;
		}
	}
}

void split_untint(const struct split *split, const float *three, float *one)
{
	const int pixels = split->part->pixels;

	for (int p = 0; p < pixels; p++) {
		float sum = 0, all = 0;

		for (int c = 0; c < 3; c++) {
			sum += split->tint_share[c][p] * three[c * pixels + p];
			all += split->tint_share[c][p] * split->tint_share[c][p];
		}
		one[p] = all > 0 ? sum / all : 0;
	}
}

static int take_mono(struct split *split, const struct encode_settings *settings)
{
	const struct part *part = split->part;
	const float *from = split->way == SPLIT_DIRECT ? part->direct : part->value;
	const size_t pixels = (size_t)part->pixels;
	int err;

	split->mono = true;
	split->tinted = split->way == SPLIT_TOTAL || part->direct_channels == 3;
	for (int c = 0; c < 3; c++)
		for (size_t p = 0; p < pixels; p++)
			split->tint_share[c][p] = 1;
	if (!split->tinted) {
		split->mono_value = from;
		return 0;
	}
	find_tints(split, settings, from);
	err = part_room_for(&split->own_mono, &split->mono_room, (size_t)settings->lights * pixels);
	if (err)
		return err;
	for (size_t i = 0; i < (size_t)settings->lights; i++)
		split_untint(split, from + i * 3 * pixels, split->own_mono + i * pixels);
	split->mono_value = split->own_mono;
	return 0;
}

static int take_colour(struct split *split, const struct encode_settings *settings)
{
	const struct part *part = split->part;
	const int pixels = part->pixels;
	int err = part_room_for(&split->own_colour, &split->colour_room,
				(size_t)settings->lights * (size_t)part->rows);

	if (err)
		return err;
	for (int i = 0; i < settings->lights; i++) {
		const float *all = part->value + (size_t)i * (size_t)part->rows;
		const float *mono = split->mono_value + (size_t)i * (size_t)pixels;
		float *to = split->own_colour + (size_t)i * (size_t)part->rows;

		for (int c = 0; c < 3; c++)
			for (int p = 0; p < pixels; p++)
				to[c * pixels + p] = all[c * pixels + p] -
						     split->tint_share[c][p] * mono[p];
	}
	split->colour = true;
	split->colour_value = split->own_colour;
	return 0;
}

int split_part(struct split *split, const struct encode_settings *settings, const struct part *part,
	       enum split_way way)
{
	const size_t n = (size_t)settings->lights;
	int err = 0;

	profile_enter(PROFILE_BASIS);
	split->part = part;
	split->way = way;
	split->mono = split->colour = split->tinted = false;
	for (int k = 0; k < 2; k++) {
		split->whole[k] = !(part->column_cut > 0);
		split->wide[k] = false;
	}
	split->spent = SPENT_FIRST;
	split->most = 0;
	split->mono_patterns.count = split->colour_patterns.count = 0;
	if (way != SPLIT_PLAIN) {
		err = take_mono(split, settings);
		if (!err)
			err = take_colour(split, settings);
	} else if (part->channels == 1) {
		split->mono = true;
		split->mono_value = part->value;
		for (int c = 0; c < 3; c++)
			for (int p = 0; p < part->pixels; p++)
				split->tint_share[c][p] = 1;
	} else {
		split->colour = true;
		split->colour_value = part->value;
	}
	if (!err && split->mono)
		err = part_room_for(&split->mono_left, &split->mono_left_room,
				    n * (size_t)part->pixels);
	if (!err && split->colour)
		err = part_room_for(&split->colour_left, &split->colour_left_room,
				    n * 3 * (size_t)part->pixels);
	split->mono_rank = split->colour_rank = -1;
	return err;
}

int split_find(struct split *split, const struct encode_settings *settings, const float *weight,
	       int most)
{
	const struct part *part = split->part;
	int err;

	profile_enter(PROFILE_BASIS);
	err = rank_metric_set(&split->metric, settings, part, weight);
	if (err)
		return err;
	split->most = most;
	if (split->mono)
		rank_find(&split->mono_patterns, settings, &split->metric, &split->scratch,
			  split->mono_value, part->pixels, most);
	if (split->colour)
		rank_find(&split->colour_patterns, settings, &split->metric, &split->scratch,
			  split->colour_value, 3 * part->pixels, most);
	split->mono_rank = split->colour_rank = -1;
	return 0;
}

/* ---- what is left ---- */

static void patterns_leave(const struct rank_patterns *p, const float *value, float *left,
			   int lights, int *rank, int wanted)
{
	const size_t n = (size_t)lights, rows = (size_t)p->rows;

	wanted = wanted < p->count ? wanted : p->count;
	if (*rank < 0 || *rank > wanted) {
		memcpy(left, value, n * rows * sizeof(*left));
		*rank = 0;
	}
	if (*rank < wanted)
		cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, lights, p->rows,
			    wanted - *rank, -1, p->at_light + (size_t)*rank * n, lights,
			    p->coefficient + (size_t)*rank * rows, p->rows, 1, left, p->rows);
	*rank = wanted;
}

void split_set_ranks(struct split *split, int lights, int mono_rank, int colour_rank)
{
	split->mono_patterns.rows = split->part->pixels;
	split->colour_patterns.rows = 3 * split->part->pixels;
	if (split->mono)
		patterns_leave(&split->mono_patterns, split->mono_value, split->mono_left, lights,
			       &split->mono_rank, mono_rank);
	if (split->colour)
		patterns_leave(&split->colour_patterns, split->colour_value, split->colour_left,
			       lights, &split->colour_rank, colour_rank);
}

void split_left(const struct split *split, int light, float *left)
{
	const int pixels = split->part->pixels;
	const float *mono = split->mono_left + (size_t)light * (size_t)pixels;
	const float *colour = split->colour_left + (size_t)light * 3 * (size_t)pixels;

	if (!split->colour) {
		memcpy(left, mono, (size_t)pixels * sizeof(*left));
		return;
	}
	memcpy(left, colour, 3 * (size_t)pixels * sizeof(*left));
	for (int c = 0; split->mono && c < 3; c++)
		for (int p = 0; p < pixels; p++)
			left[c * pixels + p] += split->tint_share[c][p] * mono[p];
}
