/* SPDX-License-Identifier: MIT */
#include "app/bench/bench.h"

#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/frame/frame_reader.h"
#include "hal/lights/lamp/lamp_light.h"
#include "hal/lights/sampler.h"
#include "hal/measure/measure.h"
#include "hal/optics/fisheye.h"

const struct lamps bench_lamps = {.count = 4,
				  .lamp = {{{0.9, 0, 1.2}, 0.08},
					   {{0, 0.9, 1.2}, 0.08},
					   {{-0.9, 0, 1.2}, 0.08},
					   {{0, -0.9, 1.2}, 0.08}}};

/* The pictures of one camera. */
struct bench_camera {
	uint8_t *yuyv[BENCH_CAMERA_BUFFERS];
	int turn; /* index of the present buffer */
	struct frame frame;
	struct frame_reader reader;
};

struct bench_frame {
	const struct basis *basis;
	struct pool *pool;
	struct dome dome;
	struct fisheye lens;
	struct bench_camera background, fisheye;
	struct canvas canvas; /* the background read from its camera, for double precision */
	struct light_sampler *sampler;
	struct dome_placed *placed;
	struct lamp_light *lamps;
	float (*radiance)[3];
	struct light_selection lights;
};

static int camera_show(struct bench_camera *camera, int turn)
{
	const struct view whole = {
		.width = camera->frame.width, .height = camera->frame.height, .squash = 1};

	camera->turn = turn;
	camera->frame.planes[0].data = camera->yuyv[turn];
	return frame_reader_open(&camera->reader, &camera->frame, &whole, NULL);
}

static int camera_create(struct bench_camera *camera, int width, int height)
{
	const size_t stride = frame_plane_stride(PIXEL_YUYV, 0, width);
	const size_t bytes = frame_plane_bytes(PIXEL_YUYV, 0, stride, height);

	for (int k = 0; k < BENCH_CAMERA_BUFFERS; k++) {
		camera->yuyv[k] = calloc(bytes, 1);
		if (!camera->yuyv[k])
			return -ENOMEM;
	}
	camera->frame = (struct frame){
		.format = PIXEL_YUYV,
		.width = width,
		.height = height,
		.planes = {{camera->yuyv[0], stride, bytes}},
		.matrix = MATRIX_BT601,
		.range = RANGE_LIMITED,
	};
	return camera_show(camera, 0);
}

static void camera_free(struct bench_camera *camera)
{
	for (int k = 0; k < BENCH_CAMERA_BUFFERS; k++)
		free(camera->yuyv[k]);
}

static void camera_take(struct bench_camera *camera, const struct canvas *picture)
{
	for (int k = 0; k < BENCH_CAMERA_BUFFERS; k++)
		ARGBToYUY2(picture->pixels, (int)picture->stride, camera->yuyv[k],
			   (int)camera->frame.planes[0].stride, picture->width, picture->height);
}

static int create_sampler(struct bench_frame *f, struct fault *fault)
{
	const struct fisheye_settings lens = {.field_deg = 90};
	const struct light_sampler_settings settings = {
		.placed = true, .curve = {.named = TRANSFER_SRGB}, .gain = 1};
	const int width = (int)f->basis->info.width, height = (int)f->basis->info.height;
	int err = fisheye_prepare(&f->lens, &lens, width, height, fault);

	return err ? err
		   : light_sampler_create(&f->sampler, &f->dome, &f->lens, width, height, &settings,
					  fault);
}

static int frame_fill(struct bench_frame *f, const struct canvas *background, struct fault *fault)
{
	const struct basis_info_chunk *info = &f->basis->info;
	int err = lightings_dome(&f->dome, f->basis, fault);

	if (err)
		return err;
	f->radiance = calloc(info->lights, sizeof(*f->radiance));
	if (!f->radiance || dome_placed_create(&f->placed, &f->dome) == -ENOMEM ||
	    lamp_light_create(&f->lamps, &f->dome, f->placed, &bench_lamps) ||
	    light_selection_create(&f->lights, f->basis) ||
	    canvas_create(&f->canvas, background->width, background->height) ||
	    camera_create(&f->background, (int)info->width, (int)info->height) ||
	    camera_create(&f->fisheye, (int)info->width, (int)info->height))
		return fault_say(fault, -ENOMEM, "not enough memory for two cameras of %ux%u",
				 info->width, info->height);
	camera_take(&f->background, background);
	frame_reader_make(&f->background.reader, 0, 0, f->canvas.width, f->canvas.height,
			  f->canvas.pixels, f->canvas.stride);
	return create_sampler(f, fault);
}

int bench_frame_create(struct bench_frame **frame, const struct basis *basis,
		       const struct canvas *background, struct pool *pool, struct fault *fault)
{
	struct bench_frame *f = calloc(1, sizeof(*f));
	int err;

	if (!f)
		return fault_say(fault, -ENOMEM, "not enough memory");
	f->basis = basis;
	f->pool = pool;
	err = frame_fill(f, background, fault);
	if (err)
		bench_frame_destroy(f);
	else
		*frame = f;
	return err;
}

void bench_frame_destroy(struct bench_frame *f)
{
	if (!f)
		return;
	light_sampler_destroy(f->sampler);
	lamp_light_destroy(f->lamps);
	dome_placed_destroy(f->placed);
	light_selection_free(&f->lights);
	canvas_free(&f->canvas);
	camera_free(&f->background);
	camera_free(&f->fisheye);
	dome_free(&f->dome);
	free(f->radiance);
	free(f);
}

int bench_frame_light(struct bench_frame *f, const float (*radiance)[3])
{
	struct canvas picture;
	const struct canvas *canvas = &picture;
	const int err = canvas_create(&picture, f->canvas.width, f->canvas.height);

	if (err)
		return err;
	for (int y = 0; y < canvas->height; y++) {
		for (int x = 0; x < canvas->width; x++) {
			uint8_t *to = canvas->pixels + (size_t)y * canvas->stride + (size_t)x * 4;
			const double px[2] = {x + 0.5, y + 0.5};
			double d[3];
			const int cell = fisheye_ray(&f->lens, px, d) ? dome_cell_of(&f->dome, d)
								      : -1;

			for (int c = 0; c < 3; c++) {
				const double seen = cell < 0 ? 0 : (double)radiance[cell][c];

				to[2 - c] = (uint8_t)lrint(
					255 * transfer_encode(TRANSFER_SRGB, fmin(seen, 1)));
			}
		}
	}
	camera_take(&f->fisheye, canvas);
	canvas_free(&picture);
	return 0;
}

void bench_frame_budget(struct bench_frame *f, double budget)
{
	f->lights.budget = budget;
}

void bench_frame_next(struct bench_frame *f)
{
	/* cannot fail: only the address has changed since the last time */
	(void)camera_show(&f->background, (f->background.turn + 1) % BENCH_CAMERA_BUFFERS);
	(void)camera_show(&f->fisheye, (f->fisheye.turn + 1) % BENCH_CAMERA_BUFFERS);
}

int bench_frame_measure(struct bench_frame *f, bool lamps, double threshold, struct fault *fault)
{
	const int err = light_sampler_read_frame(f->sampler, &f->fisheye.reader, f->pool,
						 f->radiance, NULL);

	if (err)
		return fault_say(fault, err, "the light cannot be measured: %s", strerror(-err));
	if (lamps)
		lamp_light_take(f->lamps, f->radiance, f->lights.lamp);
	/* The lightings have no light where the lamps are. */
	for (int l = 0; l < LAMPS_MAX; l++)
		for (int c = 0; c < 3; c++)
			f->lights.lamp[l][c] = lamps && l < bench_lamps.count ? 0.4 : 0;
	light_selection_choose(&f->lights, f->basis, 0, (const float(*)[3])f->radiance, threshold,
			       THRESHOLD_AMBIENT, 1);
	return 0;
}

void bench_frame_convert(const struct bench_frame *f, struct canvas *out)
{
	frame_reader_make(&f->background.reader, 0, 0, out->width, out->height, out->pixels,
			  out->stride);
}

int bench_frame_run(struct bench_frame *f, struct compositor *compositor, double threshold,
		    struct canvas *out, uint64_t *bytes, struct fault *fault)
{
	const struct backdrop backdrop = {
		.width = f->background.frame.width,
		.height = f->background.frame.height,
		.make = frame_reader_make,
		.context = &f->background.reader,
	};
	int err = bench_frame_measure(f, compositor_lamps(compositor) > 0, threshold, fault);

	if (err)
		return err;
	err = compositor_run(compositor, 0, &f->lights, &backdrop, out->pixels, out->stride);
	*bytes = compositor_last(compositor).basis_bytes;
	return err ? fault_say(fault, err, "whole frame: the compositor fails: %s", strerror(-err))
		   : 0;
}

struct picture bench_frame_background(const struct bench_frame *f)
{
	const struct view whole = {
		.width = f->canvas.width, .height = f->canvas.height, .squash = 1};

	return view_picture(&whole, f->canvas.pixels, f->canvas.stride);
}

const struct light_selection *bench_frame_lights(const struct bench_frame *f)
{
	return &f->lights;
}
