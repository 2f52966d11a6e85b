/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/blas.h"
#include "bake/encode/encode_parts.h"
#include "bake/judge/measure.h"
#include "bake/judge/reader.h"
#include "bake/judge/shade.h"

/* Bound of single precision's error between samples and values, relative to the largest |direct| +
 * |bounce|: four roundings of 2^-24. */
#define FLOAT_ERROR 0x1p-22
/* A tile is encoded at most this often until its errors hold. Chosen by trial. */
#define ATTEMPTS 10

struct encoder {
	struct encode_settings settings; /* its ensemble is shade's */
	struct basis_groups groups;
	struct shade shade;
	struct levels levels;
	/* These arrays have one element for each set of samples (part) of the tile. */
	struct part *part;
	struct low_rank *fit;
	struct block_reader *reader;
	struct allowance *allowance;
	int parts, room; /* elements in use, and elements that there is memory for */
	struct choose choose;
	struct columns columns;
	struct measure measure;
	struct block_list shown;   /* blocks of the present attempt */
	struct block_list nearest; /* blocks of the attempt with the least error so far */
	struct block_list exact;   /* the exact layer */
};

int encoder_create(struct encoder **encoder, const struct encode_settings *settings)
{
	struct encoder *e = calloc(1, sizeof(*e));
	int err;

	*encoder = NULL;
	if (!e)
		return -ENOMEM;
	blas_setup();
	e->settings = *settings;
	levels_fill(&e->levels, settings->target.cell);
	e->measure.settings = &e->settings;
	e->measure.levels = &e->levels;
	e->settings.groups = &e->groups;
	err = basis_groups_create(&e->groups, settings->gather, settings->lights, settings->coarse);
	if (!err)
		err = shade_create(&e->shade, settings);
	e->settings.ensemble = &e->shade.skies;
	if (!err)
		err = choose_create(&e->choose, &e->settings, &e->levels);
	if (!err)
		err = columns_create(&e->columns, &e->settings);
	if (err)
		encoder_destroy(e);
	else
		*encoder = e;
	return err;
}

void encoder_destroy(struct encoder *e)
{
	if (!e)
		return;
	for (int k = 0; k < e->room; k++) {
		part_free(&e->part[k]);
		fit_free(&e->fit[k]);
		block_reader_free(&e->reader[k]);
	}
	free(e->part);
	free(e->fit);
	free(e->reader);
	free(e->allowance);
	basis_groups_free(&e->groups);
	shade_free(&e->shade);
	choose_free(&e->choose);
	columns_free(&e->columns);
	measure_free(&e->measure);
	block_list_free(&e->shown);
	block_list_free(&e->nearest);
	block_list_free(&e->exact);
	free(e);
}

/* Tells whether each D is followed by a U of the same pixels, and each U preceded by its D. */
static bool samples_pair(const struct encode_samples *samples, int count)
{
	for (int i = 0; i < count; i++) {
		const struct encode_samples *s = &samples[i];
		const bool expects_u = i && samples[i - 1].kind == BASIS_KIND_D;

		if (expects_u != (s->kind == BASIS_KIND_U))
			return false;
		if (expects_u && (s->pixels != samples[i - 1].pixels ||
				  memcmp(s->pixel, samples[i - 1].pixel,
					 (size_t)s->pixels * sizeof(*s->pixel)) != 0))
			return false;
	}
	return !count || samples[count - 1].kind != BASIS_KIND_D;
}

static int grow(void *array, size_t each, int count)
{
	void **at = array, *grown = realloc(*at, (size_t)count * each);

	if (!grown)
		return -ENOMEM;
	*at = grown;
	return 0;
}

static int encoder_reserve(struct encoder *e, int room)
{
	int err = 0;

	if (room <= e->room)
		return 0;
	err = grow(&e->part, sizeof(*e->part), room);
	if (!err)
		err = grow(&e->fit, sizeof(*e->fit), room);
	if (!err)
		err = grow(&e->reader, sizeof(*e->reader), room);
	if (!err)
		err = grow(&e->allowance, sizeof(*e->allowance), room);
	for (; e->room < room && !err; e->room++) {
		e->reader[e->room] = (struct block_reader){.count = 0};
		e->fit[e->room] = (struct low_rank){.settings = NULL};
		err = part_create(&e->part[e->room], &e->settings);
		if (!err)
			err = fit_create(&e->fit[e->room], &e->settings);
	}
	return err;
}

static int encoder_load(struct encoder *e, const struct encode_samples *samples, int count)
{
	int err = encoder_reserve(e, count);

	e->parts = count;
	for (int k = 0; k < count && !err; k++) {
		e->fit[k].excess = 0;
		err = part_load(&e->part[k], &e->settings, &samples[k]);
		if (!err && samples[k].kind == BASIS_KIND_U)
			err = part_pair(&e->part[k - 1], &e->part[k], &e->settings);
	}
	return err;
}

/* Adds the blocks of part k to the shown ones; chooses its ranks first where they are not kept. */
static int build_part(struct encoder *e, int tile, int k)
{
	struct allowance *allowance = &e->allowance[k];
	int err = 0;

	if (!allowance->chosen)
		err = choose_ranks(&e->choose, &e->fit[k], &e->shade, &allowance->asked);
	allowance->chosen = true;
	if (err)
		return err;
	columns_find(&e->columns, &e->fit[k]);
	return block_build(&e->shown, &e->fit[k], &e->columns, tile);
}

/* Builds all parts; blocks first[k]..first[k + 1] - 1 are part k's. A U needs no blocks where its D
 * has none, and at least one where its D has some. */
static int encoder_build(struct encoder *e, int tile, int *first)
{
	int err = 0;

	e->shown.count = 0;
	for (int k = 0; k < e->parts && !err; k++) {
		const struct part *part = &e->part[k];
		const bool alone = part->kind == BASIS_KIND_U && first[k - 1] == e->shown.count;

		first[k] = e->shown.count;
		if (alone)
			continue;
		err = build_part(e, tile, k);
		if (!err && part->kind == BASIS_KIND_U && first[k] == e->shown.count)
			err = block_build_zero(&e->shown, &e->settings, part, tile);
	}
	first[e->parts] = e->shown.count;
	return err;
}

static int encoder_measure(struct encoder *e, const uint16_t *coverage, const int *first,
			   struct encode_result *result)
{
	const int count = e->parts;
	int err = 0;

	result->object_error = result->ratio_error = 0;
	for (int k = 0; k < count && !err; k++)
		err = block_reader_open(&e->reader[k], &e->settings, &e->part[k],
					e->shown.block + first[k], first[k + 1] - first[k]);
	if (!err)
		err = measure_tile(&e->measure, e->part, e->reader, count, coverage,
				   &result->error);
	for (int k = 0; k < count && !err; k++) {
		const double bound = e->measure.bound[k] + FLOAT_ERROR * (double)e->part[k].rounded;

		if (e->part[k].kind == BASIS_KIND_T)
			result->object_error = fmax(result->object_error, bound);
		if (e->part[k].kind == BASIS_KIND_V)
			result->ratio_error = fmax(result->ratio_error, bound);
	}
	return err;
}

/* Adds the watched skies whose errors are above the target to the tried ones. */
static void try_watched(struct encoder *e)
{
	bool tried[ENSEMBLE_SKIES_MAX] = {false};

	for (int k = 0; k < e->shade.skies.tried; k++)
		tried[e->shade.tried[k]] = true;
	for (int s = 0; s < e->shade.skies.skies; s++)
		if (!tried[s] && fmax(e->measure.sky_rms[s], e->measure.sky_most[s]) > 1)
			shade_try(&e->shade, s);
}

static void encoder_limit(struct encoder *e)
{
	for (int k = 0; k < e->parts; k++)
		part_limit(&e->part[k], &e->settings, &e->levels);
}

/* Computes what all attempts share: exposures, and the division into mono and colour. */
static int encoder_begin(struct encoder *e)
{
	int err = 0;

	shade_set(&e->shade, &e->settings, e->part, e->parts);
	parts_expose(e->part, e->parts, &e->settings);
	encoder_limit(e);
	for (int k = 0; k < e->parts && !err; k++)
		err = fit_begin(&e->fit[k], &e->part[k]);
	return err;
}

/* Builds, measures and repairs the tile until its measured errors hold. If no attempt holds, the
 * one with the least error is kept: a later attempt may be far worse than those before it. */
static int build_until_held(struct encoder *e, int tile, const uint16_t *coverage,
			    struct encode_result *result)
{
	const struct allowed allowed = {e->part,  e->fit,	e->allowance,
					e->parts, &e->settings, &e->shade};
	int *first = calloc((size_t)e->parts + 1, sizeof(*first));
	int err = first ? encoder_begin(e) : -ENOMEM;
	double nearest = INFINITY;

	allow_target(&allowed);
	for (int k = 0; k < ATTEMPTS && !err; k++) {
		struct encode_result own = *result;
		double worst;

		err = encoder_build(e, tile, first);
		if (!err)
			err = encoder_measure(e, coverage, first, &own);
		worst = err ? INFINITY : measure_worst(&e->measure);
		if (!k || worst < nearest) {
			const struct block_list spare = e->nearest;

			nearest = worst;
			*result = own;
			e->nearest = e->shown;
			e->shown = spare;
		}
		if (err || worst <= 1)
			break;
		allow_less(&allowed, &e->measure, k);
		encoder_limit(e);
		try_watched(e);
	}
	free(first);
	return err;
}

/* Builds the exact layer, which has all samples, also those that the shown layer does without. */
static int build_exact(struct encoder *e, int tile, const struct encode_samples *samples, int count)
{
	struct part *whole = e->part;
	bool nothing = false; /* the D before this part is 0 everywhere */
	int err = 0;

	for (int k = 0; k < count && !err; k++) {
		err = part_load(whole, &e->settings, &samples[k]);
		if (samples[k].kind == BASIS_KIND_D)
			nothing = !(whole->largest > 0);
		if (!err && !(samples[k].kind == BASIS_KIND_U && nothing))
			err = block_build_exact(&e->exact, &e->settings, whole, tile);
	}
	return err;
}

int encode_tile(struct encoder *e, int tile, const uint16_t *coverage,
		const struct encode_samples *samples, int count, struct encode_result *result)
{
	int err;

	*result = (struct encode_result){.shown = NULL};
	if (!samples_pair(samples, count))
		return -EINVAL;
	shade_begin(&e->shade);
	err = encoder_load(e, samples, count);
	if (err)
		return err;
	e->exact.count = 0;
	err = build_until_held(e, tile, coverage, result);
	if (!err && e->settings.exact)
		err = build_exact(e, tile, samples, count);
	if (err)
		return err;
	result->shown = e->nearest.block;
	result->shown_count = e->nearest.count;
	result->exact = e->exact.block;
	result->exact_count = e->exact.count;
	return 0;
}
