#include "app/pipeline.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
static int start_threads(const struct basis *basis, int threads, struct pool **pool,
			 struct compositor **compositor, struct fault *fault)
{
	int err = pool_create(pool, threads);

	if (err)
		return fault_say(fault, err, "cannot start %d threads: %s", threads,
				 strerror(-err));
	err = compositor_create(compositor, basis, *pool, fault);
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
	return start_threads(p->basis, p->settings.threads, &p->pool, &p->compositor, fault);
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
	struct compositor *compositor;
	struct pool *pool;
	int err;

	if (settings->threads != p->settings.threads) {
		err = start_threads(p->basis, settings->threads, &pool, &compositor, fault);
		if (err)
			return err;
		compositor_destroy(p->compositor);
		pool_destroy(p->pool);
		p->compositor = compositor;
		p->pool = pool;
	}
	light_sampler_destroy(p->sampler); /* the next measurement makes another */
	p->sampler = NULL;
	p->settings = *settings;
	return 0;
}

/* The lens and the sampler's table are of one size of picture; a camera may come back with another.
 */
static int fit_lens(struct pipeline *p, int width, int height, struct fault *fault)
{
	int err;

	if (p->sampler && width == p->lens_width && height == p->lens_height)
		return 0;
	light_sampler_destroy(p->sampler);
	p->sampler = NULL;
	err = fisheye_prepare(&p->lens, &p->settings.lens, width, height, fault);
	if (err)
		return err;
	p->lens_width = width;
	p->lens_height = height;
	return light_sampler_create(&p->sampler, &p->dome, &p->lens, width, height,
				    &p->settings.sampler, fault);
}

int pipeline_light_picture(struct pipeline *p, const struct picture *fisheye, struct fault *fault)
{
	int64_t start = clock_now_ns();
	int err = fit_lens(p, fisheye->width, fisheye->height, fault);

	if (err)
		return err;
	err = light_sampler_read(p->sampler, fisheye, p->radiance, &p->clipped);
	if (err)
		return fault_say(fault, err, "cannot measure the light in a picture of %dx%d",
				 fisheye->width, fisheye->height);
	p->lit = true;
	p->sample_ns = clock_now_ns() - start;
	return 0;
}

/* Radiance has no struct picture to be read through: turned and cut by copying. */
static int turn_upright(struct pipeline *p, const struct image *camera, const struct view *view)
{
	struct image *to = &p->upright;
	int err;

	if (to->width != view->width || to->height != view->height) {
		image_free(to);
		err = image_create_f32(to, view->width, view->height);
		if (err)
			return err;
	}
	for (int y = 0; y < view->height; y++) {
		int row = view->y + (view->vflip ? view->height - 1 - y : y);
		const float *from = camera->f32 +
				    3 * ((size_t)row * (size_t)camera->width + (size_t)view->x);
		float *out = to->f32 + 3 * (size_t)y * (size_t)view->width;

		if (!view->hflip) {
			memcpy(out, from, 3 * sizeof(float) * (size_t)view->width);
			continue;
		}
		for (int x = 0; x < view->width; x++)
			memcpy(out + 3 * x, from + 3 * (view->width - 1 - x), 3 * sizeof(float));
	}
	return 0;
}

int pipeline_light_linear(struct pipeline *p, const struct image *camera, const struct view *view,
			  struct fault *fault)
{
	int64_t start = clock_now_ns();
	int err = fit_lens(p, view->width, view->height, fault);

	if (err)
		return err;
	err = turn_upright(p, camera, view);
	if (!err)
		err = light_sampler_read_linear(p->sampler, &p->upright, p->radiance);
	if (err)
		return fault_say(fault, err, "cannot measure the light in a picture of %dx%d: %s",
				 view->width, view->height, strerror(-err));
	p->clipped = 0;
	p->lit = true;
	p->sample_ns = clock_now_ns() - start;
	return 0;
}

void pipeline_light_given(struct pipeline *p, const float (*radiance)[3])
{
	memcpy(p->radiance, radiance, p->basis->info.lights * sizeof(*radiance));
	p->clipped = 0;
	p->lit = true;
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

int pipeline_composite(struct pipeline *p, const struct picture *background, uint8_t *out,
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
	err = compositor_reference(p->basis, p->choice.pose, &settings, &p->selection, background,
				   out);
	if (err)
		return fault_say(fault, err, "cannot composite pose %d", p->choice.pose);
	return 0;
}
