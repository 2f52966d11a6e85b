/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_parts.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Power iteration converges by the ratio of the two largest eigenvalues each round; tints are
 * rounded to 2^-15, and a tint need not be exact, as colour takes what mono leaves. */
#define TINT_ROUNDS 16
/* Colour has at most this many patterns, as its coefficients take three times the bytes of
 * mono's. Tuned
 * (README.md, "Constants"). */
#define RANK_COLOUR 24

int fit_create(struct low_rank *fit, const struct encode_settings *settings)
{
	int err;

	*fit = (struct low_rank){.settings = settings};
	err = rank_patterns_create(&fit->mono_patterns, settings);
	if (!err)
		err = rank_patterns_create(&fit->colour_patterns, settings);
	if (!err)
		err = rank_finder_create(&fit->finder, settings);
	fit->tinted_rows = calloc((size_t)RANK_MOST * PART_ROWS, sizeof(*fit->tinted_rows));
	return err || fit->tinted_rows ? err : -ENOMEM;
}

void fit_free(struct low_rank *fit)
{
	rank_patterns_free(&fit->mono_patterns);
	rank_patterns_free(&fit->colour_patterns);
	rank_finder_free(&fit->finder);
	free(fit->own_mono);
	free(fit->own_colour);
	free(fit->tinted_rows);
	free(fit->left);
	*fit = (struct low_rank){.settings = NULL};
}

/* ---- one channel and a tint ---- */

/* Finds the main eigenvector of the symmetric 3 x 3 matrix with the upper triangle `product`, by
 * power iteration. */
static void main_eigenvector(const double product[6], double hue[3])
{
	static const int at[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

	for (int c = 0; c < 3; c++)
		hue[c] = 1;
	for (int round = 0; round < TINT_ROUNDS; round++) {
		double next[3], most = 0;

		for (int c = 0; c < 3; c++) {
			next[c] = 0;
			for (int k = 0; k < 3; k++)
				next[c] += product[at[c][k]] * hue[k];
			most = fmax(most, fabs(next[c]));
		}
		if (!(most > 0))
			return;
		for (int c = 0; c < 3; c++)
			hue[c] = next[c] / most;
	}
}

/* Sets each pixel's tint: the main eigenvector of sum_i W_i a_i a_i^T, divided by its largest
 * component. value: a_i, [lights][3 * pixels]. */
static void find_tints(struct low_rank *fit, const float *value)
{
	const struct part *part = fit->part;
	const int pixels = part->pixels;
	float product[6][PART_PIXELS] = {{0}};

	for (int i = 0; i < fit->settings->lights; i++) {
		const float *v = value + (size_t)i * (size_t)part->rows;
		const float weight = part->limit.weight[i];

		for (int p = 0; p < pixels; p++) {
			const float r = v[p], g = v[pixels + p], b = v[2 * pixels + p];

			product[0][p] += weight * r * r;
			product[1][p] += weight * r * g;
			product[2][p] += weight * r * b;
			product[3][p] += weight * g * g;
			product[4][p] += weight * g * b;
			product[5][p] += weight * b * b;
		}
	}
	for (int p = 0; p < pixels; p++) {
		double own[6], hue[3], most = 0;

		for (int k = 0; k < 6; k++)
			own[k] = (double)product[k][p];
		main_eigenvector(own, hue);
		for (int c = 0; c < 3; c++)
			most = fmax(most, hue[c]);
		for (int c = 0; c < 3; c++) {
			const double share = most > 0 ? fmax(hue[c] / most, 0) : 1;

			fit->tint[c][p] = (uint16_t)lrint(share * BASIS_TINT_ONE);
			fit->tint_share[c][p] = (float)fit->tint[c][p] / BASIS_TINT_ONE;
		}
	}
}

void fit_untint(const struct low_rank *fit, const float *three, float *one)
{
	const int pixels = fit->part->pixels;

	for (int p = 0; p < pixels; p++) {
		const float r = fit->tint_share[0][p], g = fit->tint_share[1][p],
			    b = fit->tint_share[2][p];
		const float sum = r * three[p] + g * three[pixels + p] + b * three[2 * pixels + p];
		const float all = r * r + g * g + b * b;

		one[p] = all > 0 ? sum / all : 0;
	}
}

/* Sets M, the mono part, to direct light, or to all light where nothing bounces: it varies most,
 * and its channels vary together. T's has the tint of the object; a shadow's direct light has one
 * channel and needs no tint. */
static int fit_split_mono(struct low_rank *fit)
{
	const struct part *part = fit->part;
	const size_t n = (size_t)fit->settings->lights, pixels = (size_t)part->pixels;
	const bool bounces = part->direct && part->direct_channels == 3;
	int err;

	fit->tinted = part->kind == BASIS_KIND_T;
	fit->mono_value = part->direct;
	if (!fit->tinted)
		return 0;
	fit->mono_value = bounces ? part->direct : part->value;
	find_tints(fit, fit->mono_value);
	err = part_room_for(&fit->own_mono, &fit->mono_room, n * pixels);
	for (size_t i = 0; i < n && !err; i++)
		fit_untint(fit, fit->mono_value + i * 3 * pixels, fit->own_mono + i * pixels);
	fit->mono_value = fit->own_mono;
	return err;
}

/* Sets C, the colour part, to A - tint (x) M. */
static int fit_split_colour(struct low_rank *fit)
{
	const struct part *part = fit->part;
	const size_t n = (size_t)fit->settings->lights, rows = (size_t)part->rows;
	const size_t pixels = (size_t)part->pixels;
	int err = part_room_for(&fit->own_colour, &fit->colour_room, n * rows);

	for (size_t i = 0; i < n && !err; i++)
		for (size_t c = 0; c < 3; c++) {
			const float *all = part->value + i * rows + c * pixels;
			const float *mono = fit->mono_value + i * pixels;
			const float *tint = fit->tint_share[c];
			float *to = fit->own_colour + i * rows + c * pixels;

			for (size_t p = 0; p < pixels; p++)
				to[p] = all[p] - tint[p] * mono[p];
		}
	fit->colour_value = fit->own_colour;
	return err;
}

int fit_begin(struct low_rank *fit, const struct part *part)
{
	const bool pair = part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U;
	int err;

	fit->part = part;
	fit->mono = part->channels == 1 || part->kind == BASIS_KIND_T ||
		    (part->kind == BASIS_KIND_V && part->direct && part->direct_channels == 1);
	fit->colour = part->channels == 3;
	fit->tinted = fit->found = false;
	fit->mono_patterns.count = fit->colour_patterns.count = 0;
	fit->mono_rank = fit->colour_rank = -1;
	fit->mono_value = fit->colour_value = part->value;
	for (int c = 0; c < 3; c++)
		for (int p = 0; p < part->pixels; p++)
			fit->tint_share[c][p] = 1;
	err = part_room_for(&fit->left, &fit->left_room,
			    (size_t)fit->settings->lights * (size_t)part->rows);
	if (err || pair || !fit->mono || !fit->colour)
		return err;
	err = fit_split_mono(fit);
	return err ? err : fit_split_colour(fit);
}

/* ---- patterns ---- */

int fit_find(struct low_rank *fit)
{
	const struct part *part = fit->part;
	const int pixels = part->pixels;
	int err = rank_weigh(&fit->finder, part);

	if (err)
		return err;
	fit->found = true;
	if (fit->mono)
		rank_find(&fit->mono_patterns, &fit->finder, fit->mono_value, pixels, RANK_MOST);
	if (fit->colour)
		rank_find(&fit->colour_patterns, &fit->finder, fit->colour_value, part->rows,
			  RANK_COLOUR);
	for (int j = 0; j < fit->mono_patterns.count; j++) {
		const float *from = fit->mono_patterns.coefficient + (size_t)(j * pixels);
		float *to = fit->tinted_rows + (size_t)(j * part->rows);

		for (int c = 0; c < part->channels; c++)
			for (int p = 0; p < pixels; p++)
				to[c * pixels + p] = fit->tint_share[c][p] * from[p];
	}
	fit->mono_rank = fit->colour_rank = -1;
	return 0;
}

/* Subtracts patterns from..to - 1 from the residual; if to < from, adds patterns to..from - 1. */
static void fit_subtract(struct low_rank *fit, const struct rank_patterns *patterns,
			 const float *rows, int from, int to)
{
	const int n = fit->settings->lights, first = from < to ? from : to;

	if (from == to)
		return;
	cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, n, fit->part->rows, abs(to - from),
		    from < to ? -1 : 1, patterns->at_light + (size_t)first * (size_t)n, n,
		    rows + (size_t)first * (size_t)fit->part->rows, fit->part->rows, 1, fit->left,
		    fit->part->rows);
}

void fit_set_ranks(struct low_rank *fit, int mono, int colour)
{
	const size_t count = (size_t)fit->settings->lights * (size_t)fit->part->rows;

	mono = mono < fit->mono_patterns.count ? mono : fit->mono_patterns.count;
	colour = colour < fit->colour_patterns.count ? colour : fit->colour_patterns.count;
	/* Adding what was subtracted leaves rounding errors, so if a rank falls, both begin
	 * anew. */
	if (fit->mono_rank < 0 || mono < fit->mono_rank || colour < fit->colour_rank) {
		memcpy(fit->left, fit->part->value, count * sizeof(*fit->left));
		fit->mono_rank = fit->colour_rank = 0;
	}
	fit_subtract(fit, &fit->mono_patterns, fit->tinted_rows, fit->mono_rank, mono);
	fit_subtract(fit, &fit->colour_patterns, fit->colour_patterns.coefficient, fit->colour_rank,
		     colour);
	fit->mono_rank = mono;
	fit->colour_rank = colour;
}
