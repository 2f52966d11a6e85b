/* SPDX-License-Identifier: MIT */
#include "bake/report/report_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/measure/measure.h"

/* RMS of rounding to 8 bits, in levels: no picture is nearer to truth. */
#define ROUNDING 0.289

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
	int lighting; /* index of the one that is measured */
	struct canvas *out;
	struct fault *fault;
};

struct report_result report_result_of(const struct report_trial *trial)
{
	return (struct report_result){.ms = trial->ms.median,
				      .ms_low = trial->ms.low,
				      .ms_high = trial->ms.high,
				      .rms = trial->truth.all.rms};
}

/* ---- setting up ---- */

static int runner_create(struct runner *r, struct report_trial *trial,
			 const struct report_stage *stage, struct fault *fault)
{
	const struct report_bake *bake = trial->bake;
	const struct compositor_settings settings = background_settings(trial->mode);
	const struct compositor_options options = {.pool = NULL};
	const uint32_t count = bake->basis.info.lights;
	int err;

	*r = (struct runner){.trial = trial, .basis = bake->basis};
	r->basis.info.column_cut = trial->column_cut;
	for (int k = 0; k < stage->lightings; k++) {
		struct light_selection *lights = &r->lights[k];

		if (light_selection_create(lights, &r->basis))
			return fault_say(fault, -ENOMEM, "not enough memory for lights");
		lights->budget = trial->budget;
		lights->mirror = &stage->lighting[k].mirror;
		light_selection_choose(lights, &r->basis, 0,
				       (const float(*)[3])(bake->radiance + (size_t)k * count),
				       trial->threshold, trial->threshold_mode, 1);
		trial->used_percent += 100.0 * lights->used_count / count / stage->lightings;
	}
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

static int runner_run(void *context, int which)
{
	const struct runners *all = context;
	const struct runner *r = &all->runner[which];
	const struct backdrop backdrop =
		backdrop_of(&all->stage->lighting[all->lighting].background_picture);
	const int err = compositor_run(r->compositor, 0, &r->lights[all->lighting], &backdrop,
				       all->out->pixels, all->out->stride);

	return err ? fault_say(all->fault, err, "the compositor fails: %s", strerror(-err)) : 0;
}

/* A frame of the same trial, untimed, leaves the caches as each timed one finds them. */
static int runner_prepare(void *context, int which, int turn)
{
	(void)turn;
	return runner_run(context, which);
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
			const struct compositor *made = all->runner[k].compositor;

			trial->ms.low += spread.low / lightings;
			trial->ms.median += spread.median / lightings;
			trial->ms.high += spread.high / lightings;
			trial->read_mb += (double)compositor_last(made).basis_bytes / 1e6 /
					  lightings;
		}
	}
	all->stage->timed_ns += turns.timed_ns;
	all->stage->ran_ns += turns.ran_ns;
	free(ms);
	return err;
}

/* ---- errors ---- */

static void sum_up(struct report_errors *errors, int lightings)
{
	struct composite_error *all = &errors->all;
	double square = 0;

	for (int k = 0; k < lightings; k++) {
		const struct composite_error *one = &errors->each[k];

		square += one->rms * one->rms / lightings;
		all->max = fmax(all->max, one->max);
		all->contrast += one->contrast / lightings;
	}
	all->rms = sqrt(square);
	all->psnr_db = error_psnr(all->rms);
}

static int measure_all(struct runners *all, const struct scope *scope)
{
	int err = 0;

	for (int k = 0; !err && k < all->count; k++) {
		struct report_trial *trial = all->runner[k].trial;

		for (int l = 0; !err && l < all->stage->lightings; l++) {
			struct report_lighting *at = &all->stage->lighting[l];
			struct composite_error *truth = &trial->truth.each[l];
			struct canvas *other = all->out;

			all->lighting = l;
			all->out = k ? other : &at->composite;
			err = runner_run(all, k);
			trial->precise.each[l] = error_measure(scope, trial->bake->precise[l],
							       all->out, &at->background_picture,
							       TRANSFER_SRGB);
			*truth = error_measure(scope, at->truth, all->out, &at->background_picture,
					       TRANSFER_SRGB);
			all->out = other;
			/* the truth's own noise is none of the picture's; rounding remains */
			truth->rms = sqrt(
				fmax(truth->rms * truth->rms - at->truth_noise * at->truth_noise,
				     ROUNDING * ROUNDING));
			truth->psnr_db = error_psnr(truth->rms);
		}
		sum_up(&trial->truth, all->stage->lightings);
		sum_up(&trial->precise, all->stage->lightings);
	}
	return err;
}

int report_trials_run(struct report_trial *trials, int count, struct report_stage *stage,
		      const struct scope *scope, struct fault *fault)
{
	struct canvas out = {.pixels = NULL};
	struct runners all = {.stage = stage, .out = &out, .fault = fault};
	int err = canvas_create(&out, stage->width, stage->height);

	all.runner = calloc((size_t)count, sizeof(*all.runner));
	if (err || !all.runner)
		err = fault_say(fault, -ENOMEM, "not enough memory for a picture");
	while (!err && all.count < count) {
		err = runner_create(&all.runner[all.count], &trials[all.count], stage, fault);
		all.count++;
	}
	if (!err)
		err = time_all(&all);
	if (!err)
		err = measure_all(&all, scope);
	for (int k = 0; k < all.count; k++)
		runner_destroy(&all.runner[k]);
	free(all.runner);
	canvas_free(&out);
	return err;
}
