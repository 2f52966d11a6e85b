/* SPDX-License-Identifier: MIT */
#include "bake/report/report_bake.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/compositor/compositor.h"
#include "hal/measure/lightings.h"

/* ---- open ---- */

static double layer_mb(const struct basis *basis, const struct basis_layer *layer)
{
	size_t bytes = 0;

	for (int t = 0; layer->tiles && t < basis->tiles_across * basis->tiles_down; t++)
		bytes += layer->tiles[t].bytes;
	return (double)bytes / 1e6;
}

static void count_encodings(struct report_bake *bake)
{
	const struct basis_layer *layer = &bake->basis.poses[0].shown;
	double patterns = 0, columns = 0, pixels = 0;

	for (int k = 0; k < layer->block_count; k++) {
		const struct basis_block *block = &layer->blocks[k];

		patterns += (double)block->patterns * block->pixels;
		columns += (double)block->columns * block->pixels;
		pixels += block->pixels;
	}
	bake->patterns = pixels > 0 ? patterns / pixels : 0;
	bake->columns = pixels > 0 ? columns / pixels : 0;
}

static int report_bake_open(struct report_bake *bake, const char *path, struct fault *fault)
{
	int err;

	*bake = (struct report_bake){.exact = false};
	err = basis_open(&bake->basis, path, BASIS_ALL, fault);
	if (err)
		return err;
	bake->exact = bake->basis.poses[0].exact.tiles;
	bake->shown_mb = layer_mb(&bake->basis, &bake->basis.poses[0].shown);
	bake->exact_mb = layer_mb(&bake->basis, &bake->basis.poses[0].exact);
	count_encodings(bake);
	return 0;
}

int report_bake_make(struct report_bake *bake, struct scene *scene,
		     const struct render_settings *settings, const char *folder,
		     struct fault *fault)
{
	struct render_settings one = *settings;
	struct render_report report;
	char path[PATH_MAX];
	int err;

	*bake = (struct report_bake){.exact = false};
	snprintf(path, sizeof(path), "%s/report.inlay", folder);
	one.profile = true;
	if (!one.pose)
		one.pose = "0"; /* the pose in which a scene is opened */
	err = render_run(scene, &one, path, &report, fault);
	if (err)
		return err;
	err = report_bake_open(bake, path, fault);
	/* its pages stay until it is closed */
	unlink(path);
	bake->settings = *settings;
	bake->report = report;
	return err;
}

void report_bake_close(struct report_bake *bake)
{
	free(bake->radiance);
	for (int l = 0; l < REPORT_LIGHTINGS_MAX; l++)
		free(bake->precise[l]);
	dome_free(&bake->dome);
	basis_close(&bake->basis);
	*bake = (struct report_bake){.exact = false};
}

const struct basis_layer *report_bake_layer(const struct report_bake *bake)
{
	return bake->exact ? &bake->basis.poses[0].exact : &bake->basis.poses[0].shown;
}

double report_bake_seconds(const struct report_bake *bake)
{
	double sum = 0;

	for (int k = 0; k < PROFILE_STAGES; k++)
		sum += bake->report.stage_s[k];
	return sum > 0 ? sum : NAN;
}

/* ---- light ---- */

static int make_radiance(struct report_bake *bake, const struct report_stage *stage,
			 struct fault *fault)
{
	const struct light_sampler_settings settings = {
		.placed = true,
		.curve = {.named = TRANSFER_SRGB},
		.gain = 1,
	};
	const struct fisheye_settings lens_settings = {.field_deg = 90};
	const int side = stage->lighting[0].fisheye.width;
	struct light_sampler *sampler = NULL;
	struct fisheye lens;
	int err = fisheye_prepare(&lens, &lens_settings, side, side, fault);

	if (!err && !bake->dome.count)
		err = lightings_dome(&bake->dome, &bake->basis, fault);
	if (!err)
		err = light_sampler_create(&sampler, &bake->dome, &lens, side, side, &settings,
					   fault);
	if (err)
		return err;
	bake->radiance = calloc((size_t)stage->lightings * bake->basis.info.lights,
				sizeof(*bake->radiance));
	err = bake->radiance ? 0 : -ENOMEM;
	for (int k = 0; !err && k < stage->lightings; k++)
		err = light_sampler_read_linear(sampler, &stage->lighting[k].fisheye,
						bake->radiance +
							(size_t)k * bake->basis.info.lights);
	light_sampler_destroy(sampler);
	if (!err)
		return 0;
	free(bake->radiance);
	bake->radiance = NULL;
	return fault_say(fault, err, "the lights cannot be read: %s", strerror(-err));
}

const float (*report_bake_radiance(struct report_bake *bake, const struct report_stage *stage,
				   int lighting, struct fault *fault))[3]
{
	if (!bake->radiance && make_radiance(bake, stage, fault))
		return NULL;
	return (const float(*)[3])(bake->radiance + (size_t)lighting * bake->basis.info.lights);
}

/* ---- double precision ---- */

/* Context of make_precise(), which makes one picture each time. */
struct precision {
	struct report_bake *bake;
	const struct report_stage *stage;
	int err[REPORT_LIGHTINGS_MAX];
};

static void make_precise(void *context, int k, int worker)
{
	struct precision *p = context;
	const struct compositor_settings settings = {
		.mode = p->bake->exact ? COMPOSITOR_EXACT : COMPOSITOR_FAST,
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = 1,
		.object = true,
	};
	const size_t values = 3 * (size_t)p->stage->width * (size_t)p->stage->height;
	struct light_selection lights;
	double *out = malloc(values * sizeof(*out));

	(void)worker;
	p->err[k] = out ? light_selection_create(&lights, &p->bake->basis) : -ENOMEM;
	if (!p->err[k]) {
		light_selection_choose(&lights, &p->bake->basis, 0,
				       (const float(*)[3])(p->bake->radiance +
							   (size_t)k * p->bake->basis.info.lights),
				       0, THRESHOLD_DROP, 1);
		p->err[k] = compositor_reference(&p->bake->basis, 0, &settings, &lights,
						 &p->stage->lighting[k].background_picture, out);
		light_selection_free(&lights);
	}
	if (p->err[k])
		free(out);
	else
		p->bake->precise[k] = out;
}

const double *report_bake_precise(struct report_bake *bake, const struct report_stage *stage,
				  int lighting, struct fault *fault)
{
	struct precision p = {.bake = bake, .stage = stage};

	if (bake->reference)
		return report_bake_precise(bake->reference, stage, lighting, fault);
	if (bake->precise[lighting])
		return bake->precise[lighting];
	if (!report_bake_radiance(bake, stage, 0, fault))
		return NULL;
	pool_run(stage->all, stage->lightings, make_precise, &p);
	for (int k = 0; k < stage->lightings; k++) {
		if (!p.err[k])
			continue;
		fault_say(fault, p.err[k], "double precision: %s", strerror(-p.err[k]));
		return NULL;
	}
	return bake->precise[lighting];
}
