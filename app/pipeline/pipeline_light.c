/* SPDX-License-Identifier: MIT */
/* Measures the light; makes the sampler, the lens and the filter's noise model. */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_parts.h"

/* Making a sampler takes longer than a frame lasts: a thread makes the next one. Meanwhile the
 * pipeline measures with the present one, or waits where there is none for pictures of this
 * size. */
struct relight {
	pthread_t thread;
	bool threaded; /* the thread has to be joined */
	atomic_bool done;
	/* Belongs to the thread until done is set, then to the pipeline: */
	const struct dome *dome;
	struct light_sampler_settings settings;
	struct fisheye_settings lens_settings;
	int width, height;
	struct fisheye lens;
	struct light_sampler *sampler;
	bool mirrors;
	struct mirror_eye eye; /* if there are mirrors */
	int err;
	struct fault fault;
};

static void *make_sampler(void *context)
{
	struct relight *r = context;

	r->err = fisheye_prepare(&r->lens, &r->lens_settings, r->width, r->height, &r->fault);
	if (!r->err)
		r->err = light_sampler_create(&r->sampler, r->dome, &r->lens, r->width, r->height,
					      &r->settings, &r->fault);
	if (!r->err && r->mirrors && mirror_eye_prepare(&r->eye, &r->lens, r->width, r->height) < 0)
		r->err = fault_say(&r->fault, -ENOMEM, "not enough memory for mirrors");
	atomic_store(&r->done, true);
	return NULL;
}

static void relight_join(struct relight *r)
{
	if (r->threaded)
		pthread_join(r->thread, NULL);
	r->threaded = false;
}

void pipeline_relight_end(struct pipeline *p)
{
	if (!p->light.relight)
		return;
	relight_join(p->light.relight);
	light_sampler_destroy(p->light.relight->sampler);
	mirror_eye_free(&p->light.relight->eye);
	free(p->light.relight);
	p->light.relight = NULL;
}

/* Makes a sampler for pictures of the lens's size: in a thread, or before it returns. */
static int relight_begin(struct pipeline *p, const struct pipeline_settings *settings,
			 bool threaded, struct fault *fault)
{
	struct relight *r = calloc(1, sizeof(*r));
	int err = 0;

	if (!r)
		return fault_say(fault, -ENOMEM, "not enough memory to measure the light");
	r->dome = &p->dome;
	r->settings = settings->sampler;
	r->lens_settings = settings->lens;
	r->width = p->light.lens_width;
	r->height = p->light.lens_height;
	r->mirrors = p->mirror.on;
	r->threaded = threaded;
	if (threaded)
		err = -pthread_create(&r->thread, NULL, make_sampler, r);
	else
		make_sampler(r);
	if (err) {
		free(r);
		return fault_say(fault, err, "no thread to measure the light: %s", strerror(-err));
	}
	p->light.relight = r;
	return 0;
}

int pipeline_relight(struct pipeline *p, const struct pipeline_settings *settings,
		     struct fault *fault)
{
	pipeline_relight_end(p); /* a later change replaces an earlier one */
	if (p->light.sampler)
		return relight_begin(p, settings, true, fault);
	p->settings.sampler = settings->sampler; /* the first measurement will make one */
	p->settings.lens = settings->lens;
	return 0;
}

void pipeline_lens_size(const struct pipeline *p, int *width, int *height)
{
	*width = p->light.lens_width;
	*height = p->light.lens_height;
}

/* ---- what noise the filter has to expect ---- */

/* Number of pixels that a light is measured from: those of its cell; 1 where the lens does not see
 * the light. */
static float light_pixels(const struct pipeline *p, int light)
{
	double px[2], pixel_sr;

	if (!fisheye_project(&p->light.lens, p->dome.direction[light], px))
		return 1;
	pixel_sr = fisheye_pixel_sr(&p->light.lens, px);
	return pixel_sr > 0 ? (float)fmax(1, p->dome.solid_angle_sr[light] / pixel_sr) : 1;
}

/* Tells filter and exposures what noise to expect, after sampler or lens have changed. */
static int expect_noise(struct pipeline *p, struct fault *fault)
{
	static const double one[] = {1};
	const int count = p->dome.count;
	float *pixels = malloc(sizeof(*pixels) * (size_t)count);

	if (!pixels)
		return fault_say(fault, -ENOMEM, "not enough memory for %d lights", count);
	for (int i = 0; i < count; i++)
		pixels[i] = light_pixels(p, i);
	light_filter_measured(p->light.filter, &p->settings.sampler.curve,
			      pipeline_gain_of_grey(&p->settings.sampler), pixels);
	light_exposures_parts(p->light.exposures, light_sampler_parts(p->light.sampler));
	light_exposures_measured(
		p->light.exposures, p->settings.exposures ? p->settings.exposure : one,
		p->settings.exposures ? p->settings.exposures : 1, &p->settings.sampler.curve,
		pipeline_gain_of_grey(&p->settings.sampler), pixels);
	free(pixels);
	return 0;
}

/* ---- the lens and the sampler ---- */

/* Takes over the sampler that the thread has made, if it is ready. */
static int take_over(struct pipeline *p, struct fault *fault)
{
	struct relight *r = p->light.relight;
	int err;

	if (!r || !atomic_load(&r->done))
		return 0;
	err = r->err;
	if (err) {
		fault_say(fault, err, "%s", r->fault.text);
	} else {
		light_sampler_destroy(p->light.sampler);
		p->light.sampler = r->sampler;
		p->light.lens = r->lens;
		p->light.lens_width = r->width;
		p->light.lens_height = r->height;
		p->settings.sampler = r->settings;
		p->settings.lens = r->lens_settings;
		r->sampler = NULL;
		mirror_eye_free(&p->mirror.eye);
		p->mirror.eye = r->eye;
		p->mirror.seen = false; /* until this measurement's picture is taken */
		r->eye = (struct mirror_eye){.width = 0};
		err = expect_noise(p, fault);
	}
	pipeline_relight_end(p);
	return err;
}

/* Lens and sampler are made for one size of picture; a camera may come back with another. */
int pipeline_light_prepare(struct pipeline *p, int width, int height, bool wait,
			   struct fault *fault)
{
	int err = take_over(p, fault);

	if (!err && (width != p->light.lens_width || height != p->light.lens_height)) {
		pipeline_relight_end(p);
		light_sampler_destroy(p->light.sampler);
		p->light.sampler = NULL;
		p->light.lens_width = p->light.lens_height = 0;
		err = fisheye_prepare(&p->light.lens, &p->settings.lens, width, height, fault);
		if (!err) {
			p->light.lens_width = width;
			p->light.lens_height = height;
		}
	}
	if (err || p->light.sampler)
		return err;
	if (!p->light.relight)
		err = relight_begin(p, &p->settings, !wait, fault);
	if (!err && wait)
		relight_join(p->light.relight);
	if (!err)
		err = take_over(p, fault);
	return err || p->light.sampler ? err : -EAGAIN;
}

/* ---- a picture ---- */

static double sampled_level(const struct pipeline *p)
{
	const int values = p->dome.count * light_sampler_parts(p->light.sampler);
	const double white = 3 * pipeline_gain_of_grey(&p->settings.sampler) * values;
	const float(*measured)[3] = light_sampler_measured(p->light.sampler);
	double sum = 0;

	for (int i = 0; i < values; i++)
		for (int c = 0; c < 3; c++)
			sum += (double)measured[i][c];
	return white > 0 ? sum / white : 0;
}

void pipeline_expose(struct pipeline *p, int exposure, const double *ratio)
{
	p->light.exposure = exposure;
	if (p->settings.exposures < 2)
		return;
	memcpy(p->settings.exposure, ratio, sizeof(*ratio) * (size_t)p->settings.exposures);
	if (p->light.sampler) /* else they take effect when the sampler is made */
		light_exposures_ratios(p->light.exposures, ratio);
}

/* Makes light of what the sampler has read, if the picture's exposure is known and fits. */
static int take_light(struct pipeline *p)
{
	const float(*measured)[3] = light_sampler_measured(p->light.sampler);
	const float *clipped = light_sampler_clipped(p->light.sampler);

	p->light.level = sampled_level(p);
	if (p->light.exposure < 0)
		return -ESTALE;
	if (!light_exposures_fit(p->light.exposures, p->light.exposure, measured, clipped)) {
		p->light.unfit++;
		return -ESTALE;
	}
	light_exposures_take(p->light.exposures, p->light.exposure, measured,
			     light_sampler_excess(p->light.sampler), clipped, p->light.merged,
			     p->light.left);
	light_sampler_place(p->light.sampler, (const float(*)[3])p->light.merged,
			    p->light.radiance);
	light_sampler_place_shares(p->light.sampler, p->light.left, p->light.left);
	p->light.clipped = 0;
	for (int i = 0; i < p->dome.count; i++)
		p->light.clipped += (double)p->light.left[i] * p->dome.solid_angle_sr[i] /
				    (2 * M_PI);
	p->light.recovery = (struct light_recovery){.recovered = false};
	p->light.lit = true;
	return 0;
}

/* Looks at a picture for lamps, if it is time to; NULL: it is the other kind. */
static void look_for_lamps(struct pipeline *p, const struct frame_reader *frame,
			   const struct image *linear)
{
	const struct lamps_light light = {
		.lens = &p->light.lens,
		.frame = frame,
		.linear = linear,
		.curve = &p->settings.sampler.curve,
		.radiance = (const float(*)[3])p->light.radiance,
		.distant = (const float(*)[3])(p->lamps ? p->distant : p->light.radiance),
		.lamps = &p->settings.lamps,
	};

	if (!p->light.told_due || p->light.exposure + 1 < p->settings.exposures)
		return;
	p->light.told_due = false;
	/* Without memory what was said before stays. */
	(void)lamps_search_look(p->light.lamps_search, &light, &p->light.told);
}

int pipeline_light_frame(struct pipeline *p, const struct frame_reader *fisheye,
			 struct fault *fault)
{
	const int width = fisheye->view.width, height = fisheye->view.height;
	int err = pipeline_light_prepare(p, width, height, true, fault);

	if (err)
		return err;
	light_sampler_exposure(p->light.sampler,
			       light_exposures_longer(p->light.exposures, p->light.exposure),
			       light_exposures_shorter(p->light.exposures, p->light.exposure));
	err = light_sampler_read_frame(p->light.sampler, fisheye, p->pool, NULL, NULL);
	if (err)
		return fault_say(fault, err, "cannot measure the light in a picture of %dx%d",
				 width, height);
	err = take_light(p);
	if (!err)
		err = pipeline_mirror_take(p, fisheye, NULL);
	if (!err)
		look_for_lamps(p, fisheye, NULL);
	return err;
}

int pipeline_light_picture(struct pipeline *p, const struct picture *fisheye, struct fault *fault)
{
	const struct frame_reader reader = frame_reader_of(fisheye);

	return pipeline_light_frame(p, &reader, fault);
}

/* Linear radiance has no reader that could flip and cut it: copies the upright view. */
static int turn_upright(struct pipeline *p, const struct image *camera, const struct view *view)
{
	struct image *to = &p->light.upright;
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
	int err = pipeline_light_prepare(p, view->width, view->height, true, fault);

	if (err)
		return err;
	err = turn_upright(p, camera, view);
	if (!err)
		err = light_sampler_read_linear(p->light.sampler, &p->light.upright, NULL);
	if (err)
		return fault_say(fault, err, "cannot measure the light in a picture of %dx%d: %s",
				 view->width, view->height, strerror(-err));
	err = take_light(p);
	if (!err)
		err = pipeline_mirror_take(p, NULL, &p->light.upright);
	if (!err)
		look_for_lamps(p, NULL, &p->light.upright);
	return err;
}

void pipeline_light_given(struct pipeline *p, const float (*radiance)[3])
{
	memcpy(p->light.radiance, radiance, p->basis->info.lights * sizeof(*radiance));
	p->light.clipped = 0;
	p->light.recovery = (struct light_recovery){.recovered = false};
	p->light.lit = true;
	pipeline_mirror_given(p);
}

void pipeline_forget_light(struct pipeline *p)
{
	p->light.lit = false;
}

void pipeline_find_lamps(struct pipeline *p)
{
	p->light.told_due = true;
	if (p->light.lit)
		coarse_lamp_find(&p->light.lamp, &p->dome, (const float(*)[3])p->light.radiance);
}

const bool *pipeline_missing_lamps(const struct pipeline *p)
{
	return p->light.told.missing;
}

void pipeline_follow(struct pipeline *p, int64_t captured_ns)
{
	light_filter_run(p->light.filter, captured_ns, p->settings.follow_ns, p->light.radiance);
}

/* From grey levels of the fisheye's picture to radiance. */

double pipeline_gain_of_grey(const struct light_sampler_settings *s)
{
	double sum = 0;

	for (int k = 0; k < 9; k++)
		sum += s->colours[k];
	return sum > 0 ? s->gain * sum / 3 : s->gain;
}

double pipeline_linear_level(const struct light_sampler_settings *s, double level)
{
	return transfer_curve_decode(&s->curve, level / 255) * pipeline_gain_of_grey(s);
}

double pipeline_band_below(const struct light_sampler_settings *s, double threshold)
{
	const double below = pipeline_linear_level(s, threshold - 1);
	const double rounding = below * 0x1p-13 + pipeline_gain_of_grey(s) * 0x1p-15;

	return pipeline_linear_level(s, threshold) - below + rounding;
}
