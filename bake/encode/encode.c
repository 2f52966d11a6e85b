/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode.h"

#include <cblas.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/profile.h"
#include "bake/encode/encode_block.h"
#include "bake/encode/encode_expose.h"
#include "bake/encode/encode_measure.h"
#include "bake/encode/encode_reader.h"
#include "bake/encode/encode_search.h"
#include "bake/encode/encode_shade.h"

/* What the arithmetic between samples and values may be off by, against the largest of them. */
#define FLOAT_ERROR 0x1p-22

/* A pixel is left out where that is worth less than this share of the error asked for. */
#define PIXEL_SHARE 0.5

/* How often a tile is encoded until the errors hold, after how many its parts share what was asked
 * for whatever was measured, and how far inside it the next goes. */
#define ATTEMPTS 10
#define ATTEMPTS_ALONE 3
#define TIGHTER 0.97
/* Watched skies with too large an error that become tried ones after an attempt, at most. */
#define TRIED_AT_ONCE 4
/* How much finer single lights are encoded each time that no plan holds, and how often. */
#define FINER 0.7F
#define FINER_MOST 4

struct encoder {
	struct encode_settings settings; /* its ensemble is shade's */
	struct basis_groups groups;
	struct shade shade;
	struct levels levels;
	struct part *part;
	struct block_reader *reader;
	int parts; /* that there is room for */
	struct split split;
	struct search search;
	struct measure measure;
	struct block_list shown, nearest, exact; /* of an attempt, of the nearest one */
};

int encoder_create(struct encoder **encoder, const struct encode_settings *settings)
{
	struct encoder *e = calloc(1, sizeof(*e));
	int err;

	*encoder = NULL;
	if (!e)
		return -ENOMEM;
	/* Tiles are what is shared among threads. */
	openblas_set_num_threads(1);
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
		err = split_create(&e->split, &e->settings);
	if (!err)
		err = search_create(&e->search, &e->settings, &e->levels);
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
	for (int k = 0; k < e->parts; k++) {
		part_free(&e->part[k]);
		block_reader_free(&e->reader[k]);
	}
	free(e->part);
	free(e->reader);
	basis_groups_free(&e->groups);
	shade_free(&e->shade);
	split_free(&e->split);
	search_free(&e->search);
	measure_free(&e->measure);
	block_list_free(&e->shown);
	block_list_free(&e->nearest);
	block_list_free(&e->exact);
	free(e);
}

static bool samples_pair(const struct encode_samples *samples, int count)
{
	for (int i = 0; i < count; i++) {
		const struct encode_samples *s = &samples[i];
		const bool owed = i && samples[i - 1].kind == BASIS_KIND_D;

		if (owed != (s->kind == BASIS_KIND_U))
			return false;
		if (owed && (s->pixels != samples[i - 1].pixels ||
			     memcmp(s->pixel, samples[i - 1].pixel,
				    (size_t)s->pixels * sizeof(*s->pixel)) != 0))
			return false;
	}
	return !count || samples[count - 1].kind != BASIS_KIND_D;
}

static int encoder_reserve(struct encoder *e, int count)
{
	struct part *part;
	struct block_reader *reader;

	if (count <= e->parts)
		return 0;
	part = realloc(e->part, (size_t)count * sizeof(*part));
	if (!part)
		return -ENOMEM;
	e->part = part;
	reader = realloc(e->reader, (size_t)count * sizeof(*reader));
	if (!reader)
		return -ENOMEM;
	e->reader = reader;
	while (e->parts < count) {
		e->reader[e->parts] = (struct block_reader){.count = 0};
		if (part_create(&e->part[e->parts], &e->settings) < 0) {
			part_free(&e->part[e->parts]);
			return -ENOMEM;
		}
		e->parts++;
	}
	return 0;
}

static int encoder_load(struct encoder *e, const struct encode_samples *samples, int count)
{
	int err = 0;

	for (int k = 0; k < count && !err; k++) {
		err = part_load(&e->part[k], &e->settings, &samples[k]);
		if (!err && samples[k].kind == BASIS_KIND_U)
			err = part_pair(&e->part[k - 1], &e->part[k], e->settings.lights);
	}
	return err;
}

static void encoder_limit(struct encoder *e, struct part *part)
{
	const struct encode_target *target = &e->settings.target;

	profile_enter(PROFILE_LIMITS);
	part_limit(part, &e->settings, &e->levels, PIXEL_SHARE * fmin(target->rms, target->cell));
}

/* Where no plan holds, columns of single lights are what is too coarse, or left out too soon: many
 * of them add up. */
static int search_until_held(struct encoder *e, struct part *part, struct encode_plan *plan)
{
	int err = search_best(&e->search, &e->split, part, plan);

	for (int k = 0; k < FINER_MOST && !err && plan->excess > 1; k++) {
		part->fine *= FINER;
		encoder_limit(e, part);
		err = search_best(&e->search, &e->split, part, plan);
	}
	return err;
}

/* Blocks first[k]..first[k + 1] - 1 are the part's. */
static int encoder_build(struct encoder *e, int tile, int count, int *first)
{
	int err = 0;

	e->shown.count = 0;
	for (int k = 0; k < count && !err; k++) {
		struct part *part = &e->part[k];
		const bool alone = part->kind == BASIS_KIND_U && first[k - 1] == e->shown.count;
		struct encode_plan plan;

		first[k] = e->shown.count;
		if (!part->kept || alone)
			continue;
		err = search_until_held(e, part, &plan);
		profile_enter(PROFILE_WRITE);
		if (!err)
			err = block_build(&e->shown, &e->search, &e->split, &plan, tile);
		if (!err && part->kind == BASIS_KIND_U && first[k] == e->shown.count)
			err = block_build_zero(&e->shown, &e->settings, part, tile);
	}
	first[count] = e->shown.count;
	return err;
}

static int encoder_measure(struct encoder *e, const uint16_t *coverage, int count, const int *first,
			   struct encode_result *result)
{
	int err = 0;

	profile_enter(PROFILE_CHECK);
	result->object_error = result->ratio_error = 0;
	for (int k = 0; k < count && !err; k++)
		err = block_reader_open(&e->reader[k], &e->settings, &e->part[k],
					e->shown.block + first[k], first[k + 1] - first[k]);
	if (!err)
		err = measure_tile(&e->measure, e->part, e->reader, count, coverage,
				   e->shade.number, &result->error);
	for (int k = 0; k < count && !err; k++) {
		const double bound = e->measure.bound[k] + FLOAT_ERROR * (double)e->part[k].rounded;

		if (e->part[k].kind == BASIS_KIND_T)
			result->object_error = fmax(result->object_error, bound);
		if (e->part[k].kind == BASIS_KIND_V)
			result->ratio_error = fmax(result->ratio_error, bound);
	}
	return err;
}

/* The largest error of all places, as a share of that asked for; listed: by how many parts each. */
static double worst_of(const struct encoder *e, int count, const double *over, int *listed)
{
	double worst = 0;

	memset(listed, 0, PART_PIXELS * sizeof(*listed));
	for (int k = 0; k < count; k++)
		for (int p = 0; p < e->part[k].pixels; p++) {
			const int at = e->part[k].pixel[p];

			listed[at]++;
			worst = fmax(worst, over[at]);
		}
	return worst;
}

/* The largest error of any sky or cell, as a share of that asked for. */
static double worst_of_all(const struct encoder *e, int count)
{
	int listed[PART_PIXELS];
	double worst = worst_of(e, count, e->measure.cell_over, listed);

	for (int s = 0; s < e->shade.skies.skies; s++)
		worst = fmax(worst, fmax(e->measure.sky_rms[s], e->measure.sky_most[s]));
	return worst;
}

/* Lowers the parts' shares under skies, or under cells, where the error is larger than asked for.
 * False: it is not larger. */
static bool share_out(struct encoder *e, int count, bool skies, bool last)
{
	const double *over = skies ? e->measure.sky_over : e->measure.cell_over;
	int listed[PART_PIXELS];
	const double worst = worst_of(e, count, over, listed);

	for (int k = 0; k < count; k++)
		for (int p = 0; p < e->part[k].pixels; p++) {
			struct part *part = &e->part[k];
			float *share = skies ? &part->sky_share[p] : &part->cell_share[p];
			const int at = part->pixel[p];

			if (worst > 1 && (over[at] > 1 || listed[at] > 1))
				*share *= (float)(TIGHTER / worst);
			if (last)
				*share = fminf(*share, 1 / (float)listed[at]);
		}
	return worst > 1;
}

/* Where the measured error is larger than asked for, parts have to do with less: mostly along an
 * object's edge, where the shadow behind it is off as well, and wherever else that is so. At last
 * what they may use up together is what was asked for. False: the error is not larger. */
static bool encoder_tighten(struct encoder *e, int count, bool last)
{
	const bool skies = share_out(e, count, true, last);
	const bool cells = share_out(e, count, false, last);
	double rms = 0;

	for (int s = 0; s < e->shade.skies.tried; s++)
		rms = fmax(rms, e->measure.sky_rms[s]);
	e->search.target.rms *= rms > 1 ? TIGHTER / rms : 1;
	return skies || cells || rms > 1;
}

/* The watched sky that the tile is worst off under, if by more than was asked for; else -1. */
static int worst_watched(const struct encoder *e)
{
	double worst = 1;
	int found = -1;

	for (int s = e->shade.skies.tried; s < e->shade.skies.skies; s++) {
		const double over = fmax(e->measure.sky_rms[s], e->measure.sky_most[s]);

		if (over > worst) {
			worst = over;
			found = s;
		}
	}
	return found;
}

/* The worst of the watched are tried from now on, a few at a time: their neighbours are mostly off
 * for the same reason. False: there are none. */
static bool try_watched(struct encoder *e, int count)
{
	struct measure *m = &e->measure;
	int sky, tried = 0;

	for (; tried < TRIED_AT_ONCE && (sky = worst_watched(e)) >= 0; tried++) {
		/* the places change, and what was measured with them */
		m->sky_rms[sky] = m->sky_rms[e->shade.skies.tried];
		m->sky_most[sky] = m->sky_most[e->shade.skies.tried];
		shade_try(&e->shade, sky);
	}
	profile_enter(PROFILE_LIMITS);
	for (int k = 0; k < count && tried; k++)
		part_expose(&e->part[k], &e->settings);
	return tried > 0;
}

/* The truth decides, and the search does it again. Where no attempt holds what is asked for, one
 * that asks for too much may be far worse than those before it: the nearest is taken. */
static int build_until_held(struct encoder *e, int tile, const uint16_t *coverage, int count,
			    struct encode_result *result)
{
	int *first = calloc((size_t)count + 1, sizeof(*first)), err = first ? 0 : -ENOMEM;
	double nearest = INFINITY;
	bool over = true;

	e->search.target = e->settings.target;
	shade_set(&e->shade, &e->settings, e->part, count);
	for (int k = 0; k < count; k++)
		part_expose(&e->part[k], &e->settings);
	for (int k = 0; k < ATTEMPTS && !err && over; k++) {
		for (int part = 0; part < count; part++)
			encoder_limit(e, &e->part[part]);
		struct encode_result own = *result;
		double worst;

		err = encoder_build(e, tile, count, first);
		if (!err)
			err = encoder_measure(e, coverage, count, first, &own);
		worst = err ? INFINITY : worst_of_all(e, count);
		if (worst < nearest) {
			const struct block_list spare = e->nearest;

			nearest = worst;
			*result = own;
			e->nearest = e->shown;
			e->shown = spare;
		}
		if (!err && k < ATTEMPTS - 1) {
			const bool held = !encoder_tighten(e, count, k >= ATTEMPTS_ALONE);

			over = try_watched(e, count) || !held;
		}
	}
	free(first);
	return err;
}

static int build_exact(struct encoder *e, int tile, int count)
{
	int err = 0;

	for (int k = 0; k < count && !err; k++) {
		const struct part *part = &e->part[k];

		if (part->kind == BASIS_KIND_U && !(e->part[k - 1].largest > 0))
			continue;
		err = block_build_exact(&e->exact, &e->settings, part, tile);
	}
	return err;
}

int encode_tile(struct encoder *e, int tile, const uint16_t *coverage,
		const struct encode_samples *samples, int count, struct encode_result *result)
{
	int err;

	*result = (struct encode_result){.shown = NULL};
	profile_enter(PROFILE_LIMITS);
	if (!samples_pair(samples, count))
		return -EINVAL;
	err = encoder_reserve(e, count);
	if (err)
		return err;
	err = encoder_load(e, samples, count);
	if (err)
		return err;
	e->exact.count = 0;
	err = build_until_held(e, tile, coverage, count, result);
	profile_enter(PROFILE_WRITE);
	if (!err && e->settings.exact)
		err = build_exact(e, tile, count);
	if (err)
		return err;
	result->shown = e->nearest.block;
	result->shown_count = e->nearest.count;
	result->exact = e->exact.block;
	result->exact_count = e->exact.count;
	return 0;
}
