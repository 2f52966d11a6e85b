/* SPDX-License-Identifier: MIT */
#include "bake/report/report_trial.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A trial with all that its frames need. */
struct runner {
	struct report_trial *trial;
	struct basis basis; /* copy of the bake's, with the trial's cut; owns nothing */
	struct compositor *compositor;
	struct light_selection lights[REPORT_LIGHTINGS_MAX];
};

struct runners {
	struct runner *runner;
	int count;
	struct report_stage *stage;
	struct canvas out;
	int lighting; /* index of the one that is measured */
	struct fault *fault;
};

struct report_way report_way_plain(struct report_bake *bake)
{
	return (struct report_way){.bake = bake,
				   .threshold_mode = THRESHOLD_AMBIENT,
				   .mode = COMPOSITOR_FAST,
				   .column_cut = -1};
}

/* ---- setting up ---- */

static int choose_lights(struct runner *r, struct report_stage *stage, struct fault *fault)
{
	const struct report_way *way = &r->trial->way;

	for (int k = 0; k < stage->lightings; k++) {
		const float(*radiance)[3] = report_bake_radiance(way->bake, stage, k, fault);

		if (!radiance)
			return -EIO;
		if (light_selection_create(&r->lights[k], &r->basis))
			return fault_say(fault, -ENOMEM, "not enough memory for lights");
		light_selection_choose(&r->lights[k], &r->basis, 0, radiance, way->threshold,
				       way->threshold_mode, 1);
		r->trial->lights[k] = r->lights[k].used_count;
	}
	return 0;
}

static int runner_create(struct runner *r, struct report_trial *trial, struct report_stage *stage,
			 struct fault *fault)
{
	const struct report_way *way = &trial->way;
	const struct compositor_settings settings = {.mode = way->mode,
						     .background = {.named = TRANSFER_SRGB},
						     .output = {.named = TRANSFER_SRGB},
						     .gain = 1,
						     .object = true};
	const struct compositor_options options = {.pool = NULL};
	int err;

	*r = (struct runner){.trial = trial, .basis = way->bake->basis};
	if (way->column_cut >= 0)
		r->basis.info.column_cut = way->column_cut;
	err = choose_lights(r, stage, fault);
	if (!err)
		err = compositor_create(&r->compositor, &r->basis, &options, fault);
	if (!err)
		compositor_set(r->compositor, &settings);
	return err;
}

static void runner_destroy(struct runner *r)
{
	compositor_destroy(r->compositor);
	for (int k = 0; k < REPORT_LIGHTINGS_MAX; k++)
		light_selection_free(&r->lights[k]);
}

/* ---- frames ---- */

static int runner_composite(struct runner *r, const struct report_stage *stage, int lighting,
			    struct canvas *out, struct fault *fault)
{
	const struct report_lighting *l = &stage->lighting[lighting];
	const struct backdrop backdrop = backdrop_of(&l->background_picture);
	int err;

	err = compositor_run(r->compositor, 0, &r->lights[lighting], &backdrop, out->pixels,
			     out->stride);
	return err ? fault_say(fault, err, "the compositor fails: %s", strerror(-err)) : 0;
}

/* Runs an untimed frame of the same trial, so that the timed one finds the caches as it leaves
 * them. */
static int runner_prepare(void *context, int which, int turn)
{
	struct runners *all = context;

	(void)turn;
	return runner_composite(&all->runner[which], all->stage, all->lighting, &all->out,
				all->fault);
}

static int runner_run(void *context, int which)
{
	struct runners *all = context;
	struct runner *r = &all->runner[which];

	return runner_composite(r, all->stage, all->lighting, &all->out, all->fault);
}

static double read_mb(const struct runner *r)
{
	return (double)compositor_last(r->compositor).basis_bytes / 1e6;
}

static int time_all(struct runners *all)
{
	const int repeat = all->stage->repeat, lightings = all->stage->lightings;
	struct turns turns = {.context = all,
			      .ways = all->count,
			      .repeat = repeat,
			      .prepare = runner_prepare,
			      .run = runner_run};
	double *ms = calloc((size_t)all->count * (size_t)repeat, sizeof(*ms));
	int err = ms ? 0 : fault_say(all->fault, -ENOMEM, "not enough memory");

	for (all->lighting = 0; !err && all->lighting < lightings; all->lighting++) {
		err = turns_time(&turns, ms);
		for (int k = 0; !err && k < all->count; k++) {
			struct report_trial *trial = all->runner[k].trial;

			const struct turns_spread spread =
				turns_spread(ms + (size_t)k * (size_t)repeat, repeat);

			trial->ms.low += spread.low / lightings;
			trial->ms.median += spread.median / lightings;
			trial->ms.high += spread.high / lightings;
			trial->read_mb += read_mb(&all->runner[k]) / lightings;
		}
	}
	all->stage->timed_ns += turns.timed_ns;
	all->stage->ran_ns += turns.ran_ns;
	free(ms);
	return err;
}

/* ---- errors ---- */

static double psnr_of(double rms)
{
	return rms > 0 ? fmin(20 * log10(255 / rms), 120) : 120;
}

/* The error without the noise of the truth that it was measured against. Rounding remains. */
static struct composite_error without_noise(struct composite_error error, double noise)
{
	const double square = error.rms * error.rms - noise * noise;

	error.rms = sqrt(fmax(square, REPORT_ROUNDING * REPORT_ROUNDING));
	error.psnr_db = psnr_of(error.rms);
	return error;
}

static int measure_one(struct runner *r, struct runners *all, int lighting,
		       const struct scope *scope)
{
	const struct report_lighting *l = &all->stage->lighting[lighting];
	const struct report_way *way = &r->trial->way;
	const double *precise;

	precise = report_bake_precise(way->bake, all->stage, lighting, all->fault);
	if (!precise)
		return -ENOMEM;
	r->trial->precise.each[lighting] = error_measure(scope, precise, &all->out,
							 &l->background_picture, TRANSFER_SRGB);
	r->trial->truth.each[lighting] = without_noise(
		error_measure(scope, l->truth, &all->out, &l->background_picture, TRANSFER_SRGB),
		l->noise_levels);
	return 0;
}

static void sum_up(struct report_errors *errors, int lightings)
{
	struct composite_error *all = &errors->all;
	double square = 0, frame = 0;

	*all = (struct composite_error){.rms = 0};
	for (int k = 0; k < lightings; k++) {
		const struct composite_error *one = &errors->each[k];

		square += one->rms * one->rms / lightings;
		frame += pow(10, -one->frame_psnr_db / 10) / lightings;
		all->max = fmax(all->max, one->max);
		all->contrast += one->contrast / lightings;
	}
	all->rms = sqrt(square);
	all->psnr_db = psnr_of(all->rms);
	all->frame_psnr_db = frame > 0 ? -10 * log10(frame) : 120;
}

static int measure_all(struct runners *all, const struct scope *scope)
{
	int err = 0;

	for (int k = 0; !err && k < all->count; k++) {
		struct runner *r = &all->runner[k];

		for (int l = 0; !err && l < all->stage->lightings; l++) {
			all->lighting = l;
			err = runner_prepare(all, k, 0);
			if (!err)
				err = runner_run(all, k);
			if (!err)
				err = measure_one(r, all, l, scope);
		}
		sum_up(&r->trial->truth, all->stage->lightings);
		sum_up(&r->trial->precise, all->stage->lightings);
	}
	return err;
}

int report_trials_run(struct report_trial *trials, int count, struct report_stage *stage,
		      const struct scope *scope, struct fault *fault)
{
	struct runners all = {.stage = stage, .fault = fault};
	int err;

	all.runner = calloc((size_t)count, sizeof(*all.runner));
	if (!all.runner || canvas_create(&all.out, stage->width, stage->height)) {
		err = fault_say(fault, -ENOMEM, "not enough memory for a picture");
		goto release;
	}
	err = 0;
	while (!err && all.count < count) {
		trials[all.count].ms = (struct turns_spread){0, 0, 0};
		trials[all.count].read_mb = 0;
		err = runner_create(&all.runner[all.count], &trials[all.count], stage, fault);
		all.count++;
	}
	if (!err)
		err = time_all(&all);
	if (!err)
		err = measure_all(&all, scope);
release:
	for (int k = 0; k < all.count; k++)
		runner_destroy(&all.runner[k]);
	free(all.runner);
	canvas_free(&all.out);
	return err;
}

int report_trial_picture(const struct report_way *way, struct report_stage *stage, int lighting,
			 struct canvas *out, struct fault *fault)
{
	struct report_trial trial = {.way = *way};
	struct runner runner;
	int err = runner_create(&runner, &trial, stage, fault);

	if (!err)
		err = runner_composite(&runner, stage, lighting, out, fault);
	runner_destroy(&runner);
	return err;
}
