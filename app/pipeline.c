#include "app/pipeline.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline_parts.h"
#include "hal/clock.h"

/* The light files and the sampler are in the dome's order, so the basis must be of that dome. */
static int check_dome(const struct dome *dome, const struct basis *basis, struct fault *fault)
{
	if ((uint32_t)dome->count != basis->info.lights)
		return fault_say(fault, -EINVAL,
				 "the basis holds %u lights, expected %d of a dome of frequency %d "
				 "divided by %s",
				 basis->info.lights, dome->count, dome->frequency,
				 dome_division_names[dome->division]);
	for (int i = 0; i < dome->count; i++) {
		for (int c = 0; c < 3; c++) {
			double apart = dome->direction[i][c] - basis->lights[i].direction[c];

			if (!(fabs(apart) < 1e-6))
				return fault_say(fault, -EINVAL,
						 "light %d of the basis is not where the dome of "
						 "frequency %d has it",
						 i, dome->frequency);
		}
	}
	return 0;
}

/* Threads and the compositor that they run in. */
static int start_threads(const struct basis *basis, const struct pipeline_settings *settings,
			 struct pool **pool, struct compositor **compositor, struct fault *fault)
{
	struct compositor_options options = {.kernel = *settings->kernel ? settings->kernel : NULL};
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

static int fill(struct pipeline *p, struct fault *fault)
{
	const struct basis_info_chunk *info = &p->basis->info;
	int err;

	err = dome_create(&p->dome, (int)info->dome_frequency,
			  (enum dome_division)info->dome_division, fault);
	if (err)
		return err;
	err = check_dome(&p->dome, p->basis, fault);
	if (err)
		return err;
	p->radiance = calloc(info->lights, sizeof(*p->radiance));
	if (!p->radiance)
		return fault_say(fault, -ENOMEM, "not enough memory for %u lights", info->lights);
	err = light_selection_create(&p->selection, p->basis);
	if (err)
		return fault_say(fault, err, "not enough memory for %u lights", info->lights);
	return start_threads(p->basis, &p->settings, &p->pool, &p->compositor, fault);
}

int pipeline_create(struct pipeline *pipeline, const struct basis *basis,
		    const struct pipeline_settings *settings, struct fault *fault)
{
	int err;

	*pipeline = (struct pipeline){.settings = *settings, .basis = basis};
	err = fill(pipeline, fault);
	if (err)
		pipeline_destroy(pipeline);
	return err;
}

void pipeline_destroy(struct pipeline *p)
{
	pipeline_relight_end(p);
	compositor_destroy(p->compositor);
	pool_destroy(p->pool);
	light_selection_free(&p->selection);
	light_sampler_destroy(p->sampler);
	image_free(&p->upright);
	free(p->radiance);
	dome_free(&p->dome);
	*p = (struct pipeline){.basis = NULL};
}

int pipeline_change(struct pipeline *p, const struct pipeline_settings *settings,
		    struct fault *fault)
{
	struct light_sampler_settings sampler;
	struct fisheye_settings lens;
	struct compositor *compositor;
	struct pool *pool;
	int err;

	if (settings->threads != p->settings.threads ||
	    strcmp(settings->kernel, p->settings.kernel) != 0) {
		err = start_threads(p->basis, settings, &pool, &compositor, fault);
		if (err)
			return err;
		compositor_destroy(p->compositor);
		pool_destroy(p->pool);
		p->compositor = compositor;
		p->pool = pool;
	}
	/* What the light is measured with is pipeline_relight()'s. */
	sampler = p->settings.sampler;
	lens = p->settings.lens;
	p->settings = *settings;
	p->settings.sampler = sampler;
	p->settings.lens = lens;
	return 0;
}

/* The level as the sampler would read it from the picture. */
static double linear_threshold(const struct pipeline *p)
{
	const struct light_sampler_settings *s = &p->settings.sampler;
	double code = (p->choice.threshold - s->black_level) / (255 - s->black_level);

	return transfer_decode(s->transfer, code) * s->gain;
}

int pipeline_choose(struct pipeline *p, const struct pipeline_choice *choice, struct fault *fault)
{
	if (choice->pose < 0 || (uint32_t)choice->pose >= p->basis->info.poses)
		return fault_say(fault, -EINVAL, "pose %d is not in the basis, expected 0..%u",
				 choice->pose, p->basis->info.poses - 1);
	p->choice = *choice;
	light_selection_choose(&p->selection, p->basis, choice->pose, p->radiance,
			       linear_threshold(p), p->settings.threshold_mode, p->settings.gain);
	return 0;
}

static struct compositor_settings compositor_settings_of(const struct pipeline *p)
{
	return (struct compositor_settings){
		.mode = p->settings.mode,
		.reuse = p->settings.reuse,
		.background = p->settings.background,
		.output = p->settings.background,
		.gain = p->settings.gain,
		.object = p->choice.object,
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

int pipeline_composite(struct pipeline *p, const struct backdrop *background, uint8_t *out,
		       size_t out_stride, struct fault *fault)
{
	struct compositor_settings settings = compositor_settings_of(p);
	int64_t start = clock_now_ns();
	int err = pipeline_fits(p, background->width, background->height, fault);

	if (err)
		return err;
	compositor_set(p->compositor, &settings);
	err = compositor_run(p->compositor, p->choice.pose, &p->selection, background, out,
			     out_stride);
	if (err)
		return fault_say(fault, err, "cannot composite pose %d", p->choice.pose);
	p->composite_ns = clock_now_ns() - start;
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
