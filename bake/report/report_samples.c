/* SPDX-License-Identifier: MIT */
/* Section: samples a pixel. A second bake with fewer samples and other random numbers tells how
 * noisy bakes are in each surrounding, and from that what more samples would bring. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/report/report_parts.h"

#define FEWER 4 /* factor between the samples of both bakes */

/* The bake with fewer samples is looked at in its exact layer alone, so its encoding may be
 * coarser; but not much, as the error that is asked for also decides which dim pixels are left
 * out. */
#define COARSER 2

#define SAMPLES_MOST 4096

/* Root of the mean square difference of two pictures over the pixels of the scope. */
static double pictures_differ(const struct scope *scope, const double *a, const double *b)
{
	double sum = 0;
	long count = 0;

	for (size_t at = 0; at < (size_t)scope->width * (size_t)scope->height; at++) {
		if (scope->pixel[at] == SCOPE_UNTOUCHED)
			continue;
		for (size_t c = 3 * at; c < 3 * at + 3; c++)
			sum += (a[c] - b[c]) * (a[c] - b[c]);
		count += 3;
	}
	return count ? sqrt(sum / (double)count) : 0;
}

/*
 * With S and s samples and independent random numbers, the pictures differ by
 *     difference^2 = noise^2 (1 + S / s)        noise: of S samples
 */
static int find_noise(struct report *r)
{
	const double share = (double)r->render.samples / r->fewer.settings.samples;
	double truth = 0, bake = 0;

	for (int l = 0; l < r->stage.lightings; l++) {
		struct report_lighting *lighting = &r->stage.lighting[l];
		const double *more = report_bake_precise(r->used, &r->stage, l, r->fault);
		const double *fewer = more ? report_bake_precise(&r->fewer, &r->stage, l, r->fault)
					   : NULL;

		if (!fewer)
			return -ENOMEM;
		r->bake_noise_in[l] = pictures_differ(&r->scope, more, fewer) / sqrt(1 + share);
		bake += r->bake_noise_in[l] * r->bake_noise_in[l] / r->stage.lightings;
		lighting->noise_levels =
			pictures_differ(&r->scope, lighting->half[0], lighting->half[1]) / 2;
		truth += lighting->noise_levels * lighting->noise_levels / r->stage.lightings;
	}
	r->bake_noise = sqrt(bake);
	r->truth_noise = sqrt(truth);
	return 0;
}

int report_samples_measure(struct report *r)
{
	struct render_settings settings = r->used->settings;
	int err;

	settings.samples = settings.samples > FEWER ? settings.samples / FEWER : 1;
	settings.target.rms *= COARSER;
	settings.target.max *= COARSER;
	settings.target.cell *= COARSER;
	settings.seed = settings.seed < 1 << 30 ? settings.seed + 1 : 0;
	report_step(r, "bake of %d samples", settings.samples);
	err = report_bake_make(&r->fewer, r->scene, &settings, r->page.temporary, r->fault);
	return err ? err : find_noise(r);
}

/* ---- the section ---- */

struct sample_law {
	double other_square;	      /* of the error that samples do not change */
	double noise_square;	      /* of one sample */
	double tracing_s, encoding_s; /* processor time: of each sample, of the rest */
};

static struct sample_law find_law(const struct report *r, const struct report_trial *trial)
{
	const double *stage = r->used->report.stage_s;
	const int samples = r->render.samples;
	const double noise = r->bake_noise * r->bake_noise, rms = trial->truth.all.rms;
	struct sample_law law = {
		.noise_square = noise * samples,
		.other_square = fmax(rms * rms - noise, REPORT_ROUNDING * REPORT_ROUNDING)};

	for (int k = 0; k < PROFILE_STAGES; k++) {
		if (k == PROFILE_CAMERA || k == PROFILE_CELLS || k == PROFILE_PATHS ||
		    k == PROFILE_DEPOSIT)
			law.tracing_s += stage[k] / samples;
		else
			law.encoding_s += stage[k];
	}
	return law;
}

static double law_rms(const struct sample_law *law, int samples)
{
	return sqrt(law->other_square + law->noise_square / samples);
}

/* The least power of two with which noise is no larger than the rest of the error. */
static int enough_samples(const struct sample_law *law)
{
	int samples = 1;

	while (samples < SAMPLES_MOST && law->noise_square / samples > law->other_square)
		samples *= 2;
	return samples;
}

static int show_samples(struct report *r, const struct report_trial *trial,
			const struct sample_law *law, int enough)
{
	const int least = r->fewer.settings.samples, used = r->render.samples;
	const int most = enough > used ? enough : used;
	int samples = least;
	struct report_table t;
	struct report_plot plot;
	int err;

	report_table_begin(&t, "samples");
	report_table_column(&t, "samples", "samples", "a pixel");
	report_table_column(&t, "bake_noise_levels", "noise", "levels");
	report_table_column(&t, "truth_rms_levels", "RMS", "measured");
	report_table_column(&t, "expected_rms_levels", "RMS", "expected");
	report_table_column(&t, "bake_s", "bake", "processor s");
	report_plot_begin(&plot, "samples", "samples a pixel",
			  "RMS error against truth, 8-bit levels");
	plot.x_log = true;
	report_plot_series(&plot, "expected", STYLE_LINE, 0);
	while (samples <= 2 * most && plot.x_ticks < REPORT_TICKS_MAX) {
		plot.x_tick[plot.x_ticks++] = samples;
		report_plot_point(&plot, samples, law_rms(law, samples))->ringed = samples == used;
		report_number(&t, samples);
		report_number(&t, sqrt(law->noise_square / samples));
		report_number(&t, samples == used    ? trial[0].truth.all.rms
				  : samples == least ? trial[1].truth.all.rms
						     : NAN);
		report_number(&t, law_rms(law, samples));
		report_number(&t, law->encoding_s + samples * law->tracing_s);
		if (samples == used)
			report_table_mark(&t);
		samples = samples < used ? used : 2 * samples;
	}
	report_plot_series(&plot, "measured", STYLE_POINTS, 1);
	report_plot_point(&plot, least, trial[1].truth.all.rms);
	report_plot_point(&plot, used, trial[0].truth.all.rms);
	err = report_page_plot(&r->page, r->page.body, &plot,
			       "Error by samples a pixel. Ring: what this report bakes with.",
			       r->fault);
	if (!err)
		err = report_page_table(&r->page, r->page.body, &t, r->fault);
	report_table_free(&t);
	return err;
}

int report_samples(struct report *r)
{
	struct report_trial trial[2] = {{.way = report_way_plain(r->used)},
					{.way = report_way_plain(&r->fewer)}};
	const struct scene_render_values *used;
	struct sample_law law;
	int enough, err;

	for (int k = 0; k < 2; k++)
		trial[k].way.mode = COMPOSITOR_EXACT;
	err = report_trials_run(trial, 2, &r->stage, &r->scope, r->fault);
	if (err)
		return err;
	law = find_law(r, &trial[0]);
	enough = enough_samples(&law);
	r->hidden = sqrt(law.noise_square / enough);
	report_heading(r->page.body, "How many samples?");
	report_paragraph(
		r->page.body,
		"Bakes of %d and of %d samples with other random numbers differ as far as their "
		"noise goes: %.2g levels for %d samples, mean over the surroundings. Noise falls "
		"with the root of the samples, and adds to the rest of the error by squares; "
		"that is what is expected. Errors are of the exact layers. Processor time of a bake grows with the samples only as far as tracing goes.",
		r->render.samples, r->fewer.settings.samples, r->bake_noise, r->render.samples);
	err = show_samples(r, trial, &law, enough);
	report_paragraph(
		r->page.body,
		"Advised: %d, the fewest (a power of two) with which noise is no larger "
		"than the rest of the error. They leave a noise of %.2g levels, which hides smaller differences: where choices below differ by less, they are called equal.",
		enough, r->hidden);
	used = &r->scene->file->render;
	if (used->noise_levels > 0)
		report_advise_number(r, REPORT_SCENE, "render", "noise", 0, used->noise_levels);
	report_advise_number(r, REPORT_SCENE, "render", "samples", enough, used->samples);
	report_advice_show(r);
	return err;
}
