/* SPDX-License-Identifier: MIT */
#include "app/pipeline/pipeline.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/compositor/near/near_sky.h"

/* Relative difference between the solid angle of a light in the file and that of its shape. */
#define SOLID_ANGLE_OFF 1e-6

/* The dome of the basis's own nodes, whose shapes must have the solid angles that were baked. */
static int create_dome(struct dome *dome, const struct basis *basis, struct fault *fault)
{
	const struct basis_info_chunk *info = &basis->info;
	const int stride = sizeof(*basis->lights) / sizeof(double);
	int err = dome_create_nodes(dome, basis->lights[0].direction, stride, (int)info->lights,
				    (int)info->dome_frequency, fault);

	for (int i = 0; !err && i < dome->count; i++) {
		const double is = basis->lights[i].solid_angle_sr, own = dome->solid_angle_sr[i];

		if (!(fabs(is - own) <= SOLID_ANGLE_OFF * own))
			err = fault_say(
				fault, -EINVAL,
				"light %d of the basis has a solid angle of %g sr, expected %g by the lights around it",
				i, is, own);
	}
	return err;
}

/* Creates the threads and the compositor that runs in them. */
static int start_threads(const struct basis *basis, const struct pipeline_settings *settings,
			 struct pool **pool, struct compositor **compositor, struct fault *fault)
{
	struct compositor_options options = {.kernel = *settings->kernel ? settings->kernel : NULL,
					     .lamps = &settings->lamps};
	int err = pool_create(pool, settings->threads);

	if (err)
		return fault_say(fault, err, "cannot start %d threads: %s", settings->threads,
				 strerror(-err));
	options.pool = *pool;
	err = compositor_create(compositor, basis, &options, fault);
	if (err) {
		pool_destroy(*pool);
		*pool = NULL;
	}
	return err;
}

void pipeline_warn_of_lamps(const struct basis *basis, const struct lamps *lamps)
{
	if (lamps->count && !near_sky_possible(basis))
		log_warning(
			"[lamp]: the basis does not tell where its pixels are, so lamps are taken as distant: bake the scene again with inlay-bake render");
}

/* Begins to measure lamps at places, where the compositor can use them. */
static int start_lamps(struct pipeline *p, const struct compositor *compositor,
		       const struct pipeline_settings *settings, struct fault *fault)
{
	struct lamp_light *lamps = NULL;

	pipeline_warn_of_lamps(p->basis, &settings->lamps);
	if (compositor_lamps(compositor) &&
	    lamp_light_create(&lamps, &p->dome, p->placed, &settings->lamps) < 0)
		return fault_say(fault, -ENOMEM, "not enough memory");
	lamp_light_destroy(p->lamps);
	p->lamps = lamps;
	memset(p->selection.lamp, 0, sizeof(p->selection.lamp));
	memset(p->light.told.missing, 0, sizeof(p->light.told.missing));
	return 0;
}

static int pipeline_fill(struct pipeline *p, struct fault *fault)
{
	const struct basis_info_chunk *info = &p->basis->info;
	int err;

	err = create_dome(&p->dome, p->basis, fault);
	if (err)
		return err;
	p->light.radiance = calloc(info->lights, sizeof(*p->light.radiance));
	p->distant = calloc(info->lights, sizeof(*p->distant));
	p->light.merged = calloc((size_t)info->lights * EXPOSURES_PARTS, sizeof(*p->light.merged));
	p->light.left = calloc((size_t)info->lights * EXPOSURES_PARTS, sizeof(*p->light.left));
	if (!p->distant || !p->light.radiance || !p->light.merged || !p->light.left ||
	    dome_placed_create(&p->placed, &p->dome) == -ENOMEM ||
	    lamps_search_create(&p->light.lamps_search, &p->dome, p->placed))
		return fault_say(fault, -ENOMEM, "not enough memory for %u lights", info->lights);
	err = light_selection_create(&p->selection, p->basis);
	if (!err)
		err = light_filter_create(&p->light.filter, (int)info->lights);
	if (!err)
		err = light_exposures_create(&p->light.exposures, (int)info->lights);
	if (err)
		return fault_say(fault, err, "not enough memory for %u lights", info->lights);
	err = pipeline_ground_prepare(p, &p->settings, fault);
	if (!err)
		err = pipeline_people_prepare(p, &p->settings, fault);
	if (!err)
		err = pipeline_exposure_prepare(p, &p->settings, fault);
	if (!err)
		err = pipeline_grain_prepare(p, &p->settings, fault);
	if (!err)
		err = start_threads(p->basis, &p->settings, &p->pool, &p->compositor, fault);
	return err ? err : start_lamps(p, p->compositor, &p->settings, fault);
}

int pipeline_create(struct pipeline **out, const struct basis *basis,
		    const struct pipeline_settings *settings, struct fault *fault)
{
	struct pipeline *p = malloc(sizeof(*p));
	int err;

	if (!p)
		return fault_say(fault, -ENOMEM, "not enough memory");
	*p = (struct pipeline){.settings = *settings,
			       .basis = basis,
			       .light = {.told_due = true},
			       .pose = {.shown = {.pose = -1}, .expected = {-1}, .missing = -1},
			       .looked_ns = -1};
	err = pipeline_fill(p, fault);
	p->settings.mask_pixels = NULL; /* the caller's */
	if (err)
		pipeline_destroy(p);
	else
		*out = p;
	return err;
}

void pipeline_destroy(struct pipeline *p)
{
	if (!p)
		return;
	pipeline_relight_end(p);
	pipeline_fade_end(p);
	pipeline_people_free(p);
	pipeline_exposure_free(p);
	pipeline_grain_free(p);
	compositor_destroy(p->compositor);
	pool_destroy(p->pool);
	light_selection_free(&p->selection);
	light_sampler_destroy(p->light.sampler);
	light_filter_destroy(p->light.filter);
	light_exposures_destroy(p->light.exposures);
	pipeline_ground_free(p);
	image_free(&p->light.upright);
	lamps_search_destroy(p->light.lamps_search);
	lamp_light_destroy(p->lamps);
	free(p->distant);
	free(p->light.radiance);
	free(p->light.merged);
	free(p->light.left);
	dome_placed_destroy(p->placed);
	dome_free(&p->dome);
	free(p);
}

int pipeline_change(struct pipeline *p, const struct pipeline_settings *settings,
		    struct fault *fault)
{
	const bool others = settings->threads != p->settings.threads ||
			    strcmp(settings->kernel, p->settings.kernel) != 0 ||
			    memcmp(&settings->lamps, &p->settings.lamps, sizeof(settings->lamps));
	struct pipeline_settings before;
	struct compositor *compositor = NULL;
	struct pool *pool = NULL;
	int err = others ? start_threads(p->basis, settings, &pool, &compositor, fault) : 0;

	if (!err)
		err = pipeline_ground_prepare(p, settings, fault);
	if (!err)
		err = pipeline_people_prepare(p, settings, fault);
	if (!err)
		err = pipeline_exposure_prepare(p, settings, fault);
	if (!err)
		err = pipeline_grain_prepare(p, settings, fault);
	if (!err && others)
		err = start_lamps(p, compositor, settings, fault);
	if (err) {
		compositor_destroy(compositor);
		pool_destroy(pool);
		return err;
	}
	if (others) {
		compositor_destroy(p->compositor);
		pool_destroy(p->pool);
		p->compositor = compositor;
		p->pool = pool;
	}
	/* What the light is measured with does not change here: see pipeline_relight(). */
	before = p->settings;
	p->settings = *settings;
	p->settings.mask_pixels = NULL;
	p->settings.sampler = before.sampler;
	p->settings.lens = before.lens;
	p->settings.exposures = before.exposures;
	memcpy(p->settings.exposure, before.exposure, sizeof(before.exposure));
	return 0;
}

static int check_choice_pose(const struct pipeline *p, int pose, struct fault *fault)
{
	if (pose >= 0 && (uint32_t)pose < p->basis->info.poses)
		return 0;
	return fault_say(fault, -EINVAL, "pose %d is not in the basis, expected 0..%u", pose,
			 p->basis->info.poses - 1);
}

/* Mixes each light with grey of its luminance Y (ITU-R BT.709), so that colours that must be
 * recognised stay themselves: L' = (1 - share) L + share Y (1, 1, 1). Y does not change. */
static void mix_grey(double (*radiance)[3], int count, double share)
{
	for (int i = 0; i < count; i++) {
		double *l = radiance[i];
		const double luminance = 0.2126 * l[0] + 0.7152 * l[1] + 0.0722 * l[2];

		for (int c = 0; c < 3; c++)
			l[c] += share * (luminance - l[c]);
	}
}

int pipeline_choose(struct pipeline *p, const struct pipeline_choice *choice, struct fault *fault)
{
	const struct ini_level *threshold = &choice->threshold;
	const double level = threshold->percent ? 0 : threshold->value;
	int err = check_choice_pose(p, choice->pose, fault);

	if (!err)
		err = check_choice_pose(p, choice->next, fault);
	if (err)
		return err;
	p->choice = *choice;
	err = pipeline_take_poses(p, choice);
	if (err)
		return fault_say(fault, err, "%s", p->pose.trouble.text);
	p->selection.band = pipeline_band_below(&p->settings.sampler, level);
	p->selection.budget = threshold->percent ? threshold->value / 100 : 0;
	p->followed = false;
	p->selection.lamps = p->lamps ? &p->settings.lamps : NULL;
	if (p->lamps) {
		memcpy(p->distant, p->light.radiance,
		       (size_t)p->selection.count * sizeof(*p->distant));
		lamp_light_take(p->lamps, p->distant, p->selection.lamp);
	}
	light_selection_choose(
		&p->selection, p->basis, p->choice.share > 0.5 ? p->choice.next : p->choice.pose,
		p->lamps ? (const float(*)[3])p->distant : (const float(*)[3])p->light.radiance,
		pipeline_linear_level(&p->settings.sampler, level), p->settings.threshold_mode,
		p->settings.gain);
	memset(p->look_ns, 0, sizeof(p->look_ns));
	if (p->settings.neutral > 0) {
		const int64_t start_ns = clock_now_ns();

		mix_grey(p->selection.radiance, p->selection.count, p->settings.neutral);
		mix_grey(&p->selection.ambient, 1, p->settings.neutral);
		mix_grey(p->selection.lamp, LAMPS_MAX, p->settings.neutral);
		p->look_ns[PIPELINE_NEUTRAL] += clock_now_ns() - start_ns;
	}
	return 0;
}

static struct compositor_settings compositor_settings_of(const struct pipeline *p)
{
	return (struct compositor_settings){
		.mode = p->settings.mode,
		.background = p->settings.background,
		.output = p->settings.background,
		.gain = p->settings.gain,
		.object = p->choice.object,
		.veil = pipeline_veil(p),
		.grain = pipeline_grain(p),
		.rows = pipeline_rows(p),
	};
}

int pipeline_fits(const struct pipeline *p, int width, int height, struct fault *fault)
{
	const struct basis_info_chunk *info = &p->basis->info;

	if ((uint32_t)width == info->width && (uint32_t)height == info->height)
		return 0;
	return fault_say(fault, -EINVAL,
			 "the background is %dx%d pixels, expected %ux%u as the basis was baked",
			 width, height, info->width, info->height);
}

bool pipeline_looks(const struct pipeline *p)
{
	return p->people || p->follower || p->grain;
}

void pipeline_look(struct pipeline *p, const struct picture *background,
		   const struct depth_map *depth, int64_t captured_ns)
{
	const bool fresh = p->looked_ns != captured_ns;

	if (!p->choice.object || pipeline_fits(p, background->width, background->height, NULL))
		return;
	if (fresh && p->follower && p->light.lit)
		pipeline_exposure_look(p, background);
	if (p->people && p->light.lit)
		pipeline_people_look(p, background, depth, captured_ns, fresh);
	if (fresh && p->grain) {
		const int64_t start_ns = clock_now_ns();

		pipeline_grain_watch(p, background, (uint64_t)captured_ns);
		p->look_ns[PIPELINE_NOISE] += clock_now_ns() - start_ns;
	}
	p->looked_ns = captured_ns;
}

int pipeline_composite(struct pipeline *p, const struct backdrop *background, uint8_t *out,
		       size_t out_stride, struct fault *fault)
{
	struct compositor_settings settings = compositor_settings_of(p);
	int err = pipeline_fits(p, background->width, background->height, fault);

	if (err)
		return err;
	pipeline_exposure_follow(p);
	compositor_set(p->compositor, &settings);
	if (p->choice.share > 0)
		err = pipeline_fade_run(p, background, out, out_stride);
	else
		err = compositor_run(p->compositor, p->choice.pose, &p->selection, background, out,
				     out_stride);
	if (err)
		return fault_say(fault, err, "cannot composite pose %d", p->choice.pose);
	return 0;
}

int pipeline_reference(struct pipeline *p, const struct picture *background, double *out,
		       struct fault *fault)
{
	struct compositor_settings settings = compositor_settings_of(p);
	int err = pipeline_fits(p, background->width, background->height, fault);

	if (err)
		return err;
	if (p->basis->poses[p->choice.pose].exact.tiles)
		settings.mode = COMPOSITOR_EXACT;
	err = compositor_reference(p->basis, p->choice.pose, &settings, &p->selection, background,
				   out);
	if (err)
		return fault_say(fault, err, "cannot composite pose %d", p->choice.pose);
	return 0;
}

struct pipeline_report pipeline_report(const struct pipeline *p)
{
	const double *error = p->selection.dropped_error;
	struct pipeline_report report = {
		.lit = p->light.lit,
		.level = p->light.level,
		.clipped = p->light.clipped,
		.recovered = p->light.recovery.recovered,
		.at_bound = p->light.recovery.at_bound,
		.exposures = p->settings.exposures ? p->settings.exposures : 1,
		.unfit = p->light.unfit,
		.threshold = p->choice.threshold,
		.lights = p->selection.count,
		.lights_used = p->light.lit ? p->selection.used_count : 0,
		.dropped_error = fmax(fmax(error[0], error[1]), error[2]),
		.pose = p->choice.pose,
		.missing = p->pose.missing,
		.lamp = p->light.lamp,
		.told = p->light.told,
		.people = pipeline_people_seen(p),
	};

	for (int l = 0, count = 0; l < p->settings.lamps.count; l++)
		if (report.told.missing[l])
			report.missing_lamp[count++] = p->settings.lamp_name[l];
	memcpy(report.look_ns, p->look_ns, sizeof(report.look_ns));
	return report;
}

const char *pipeline_trouble(const struct pipeline *p)
{
	return p->pose.trouble.text;
}

bool pipeline_has_patch(const struct pipeline *p)
{
	return p->light.ground != NULL;
}

struct pool *pipeline_pool(const struct pipeline *p)
{
	return p->pool;
}

const struct dome *pipeline_dome(const struct pipeline *p)
{
	return &p->dome;
}

const struct fisheye *pipeline_lens(const struct pipeline *p)
{
	return &p->light.lens;
}

const bool *pipeline_used(const struct pipeline *p)
{
	return p->selection.used;
}

const float (*pipeline_radiance(const struct pipeline *p))[3]
{
	return (const float(*)[3])p->light.radiance;
}
