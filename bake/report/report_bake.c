/* SPDX-License-Identifier: MIT */
#include "bake/report/report_bake.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "hal/compositor/compositor.h"
#include "hal/measure/measure.h"
#include "hal/mirror/mirror_eye.h"

void report_bake_close(struct report_bake *bake)
{
	free(bake->radiance);
	for (int l = 0; bake->settings.exact && l < REPORT_LIGHTINGS_MAX; l++)
		free(bake->precise[l]);
	basis_close(&bake->basis);
	*bake = (struct report_bake){.seconds = 0};
}

/* ---- light ---- */

/* Fills what mirrors show; as no pixel of radiance clips, it is the same for all bakes. */
static int fill_mirror(struct report_lighting *lighting, const struct basis *basis,
		       const struct fisheye *lens, struct fault *fault)
{
	const struct mirror_colours colours = {.matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
	const struct image *picture = &lighting->fisheye;
	struct mirror_eye eye = {.width = 0};
	int err;

	if (lighting->mirror.cell)
		return 0;
	err = mirror_map_create(&lighting->mirror, basis, fault);
	if (!err)
		err = mirror_eye_prepare(&eye, lens, picture->width, picture->height);
	if (!err)
		err = mirror_eye_take_linear(&eye, picture);
	if (!err)
		mirror_eye_fill(&eye, &colours, NULL, &lighting->mirror);
	mirror_eye_free(&eye);
	return err;
}

static int read_lights(struct report_bake *bake, struct report_stage *stage,
		       const struct dome *dome, struct fault *fault)
{
	const struct light_sampler_settings settings = {
		.placed = true,
		.curve = {.named = TRANSFER_SRGB},
		.gain = 1,
	};
	const struct fisheye_settings lens_settings = {.field_deg = 90};
	const int side = stage->lighting[0].fisheye.width, lights = dome->count;
	float(*to)[3] = calloc((size_t)stage->lightings * (size_t)lights, sizeof(*to));
	struct light_sampler *sampler = NULL;
	struct fisheye lens;
	int err = fisheye_prepare(&lens, &lens_settings, side, side, fault);

	bake->radiance = to;
	if (!to)
		return fault_say(fault, -ENOMEM, "not enough memory for lights");
	if (!err)
		err = light_sampler_create(&sampler, dome, &lens, side, side, &settings, fault);
	if (err)
		return err;
	for (int k = 0; !err && k < stage->lightings; k++)
		err = light_sampler_read_linear(sampler, &stage->lighting[k].fisheye,
						to + (size_t)k * (size_t)lights);
	light_sampler_destroy(sampler);
	for (int k = 0; !err && bake->basis.poses[0].mirror_count && k < stage->lightings; k++)
		err = fill_mirror(&stage->lighting[k], &bake->basis, &lens, fault);
	return err ? fault_say(fault, err, "the lights cannot be read: %s", strerror(-err)) : 0;
}

static int make_radiance(struct report_bake *bake, struct report_stage *stage, struct fault *fault)
{
	struct dome dome;
	int err = lightings_dome(&dome, &bake->basis, fault);

	if (err)
		return err;
	err = read_lights(bake, stage, &dome, fault);
	dome_free(&dome);
	return err;
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
	struct report_bake *bake = p->bake;
	const struct compositor_settings settings = background_settings(COMPOSITOR_EXACT);
	const float(*radiance)[3] =
		(const float(*)[3])(bake->radiance + (size_t)k * bake->basis.info.lights);
	struct light_selection lights = {.count = 0};

	(void)worker;
	bake->precise[k] = malloc(3 * (size_t)p->stage->width * (size_t)p->stage->height *
				  sizeof(*bake->precise[k]));
	p->err[k] = bake->precise[k] ? light_selection_create(&lights, &bake->basis) : -ENOMEM;
	if (!p->err[k]) {
		lights.mirror = &p->stage->lighting[k].mirror;
		light_selection_choose(&lights, &bake->basis, 0, radiance, 0, THRESHOLD_DROP, 1);
		p->err[k] = compositor_reference(&bake->basis, 0, &settings, &lights,
						 &p->stage->lighting[k].background_picture,
						 bake->precise[k]);
	}
	light_selection_free(&lights);
}

static int make_pictures(struct report_bake *bake, const struct report_stage *stage,
			 struct fault *fault)
{
	struct precision p = {.bake = bake, .stage = stage};

	pool_run(stage->all, stage->lightings, make_precise, &p);
	for (int k = 0; k < stage->lightings; k++)
		if (p.err[k])
			return fault_say(fault, p.err[k], "double precision: %s",
					 strerror(-p.err[k]));
	return 0;
}

int report_bake_make(struct report_bake *bake, struct scene *scene,
		     const struct report_bake *reference, struct report_stage *stage,
		     const char *folder, struct fault *fault)
{
	struct render_settings settings = bake->settings;
	const clock_t begun = clock(); /* processor time of all threads */
	char path[PATH_MAX];
	int err;

	snprintf(path, sizeof(path), "%s/report.inlay", folder);
	if (!settings.pose)
		settings.pose = "0"; /* the pose in which a scene is opened */
	err = render_run(scene, &settings, path, &bake->report, fault);
	if (err)
		return err;
	bake->seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
	err = basis_open(&bake->basis, path, BASIS_ALL, fault);
	/* its pages stay until it is closed */
	unlink(path);
	if (!err)
		err = make_radiance(bake, stage, fault);
	if (!err && settings.exact)
		err = make_pictures(bake, stage, fault);
	for (int l = 0; !settings.exact && l < REPORT_LIGHTINGS_MAX; l++)
		bake->precise[l] = reference->precise[l];
	return err;
}
