#include "app/bench_frame.h"

#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/bench_lightings.h"
#include "hal/frame_reader.h"
#include "hal/lights/sampler.h"
#include "hal/optics/fisheye.h"

/* What one camera delivers, and the same decoded. */
struct bench_camera {
	uint8_t *yuyv;
	struct frame frame;
	struct frame_reader reader;
	struct frame_decoder *decoder;
	struct canvas canvas;
	struct picture picture;
};

struct bench_frame {
	const struct basis *basis;
	struct dome dome;
	struct fisheye lens;
	struct bench_camera background, fisheye;
	struct light_sampler *sampler;
	float (*radiance)[3];
	struct light_selection lights;
};

static int camera_create(struct bench_camera *camera, int width, int height)
{
	const size_t stride = frame_plane_stride(PIXEL_YUYV, 0, width);
	const size_t bytes = frame_plane_bytes(PIXEL_YUYV, 0, stride, height);
	const struct view whole = {.width = width, .height = height, .squash = 1};
	int err;

	camera->yuyv = calloc(bytes, 1);
	if (!camera->yuyv)
		return -ENOMEM;
	camera->frame = (struct frame){
		.format = PIXEL_YUYV,
		.width = width,
		.height = height,
		.planes = {{camera->yuyv, stride, bytes}},
		.matrix = MATRIX_BT601,
		.range = RANGE_LIMITED,
	};
	err = canvas_create(&camera->canvas, width, height);
	if (err)
		return err;
	camera->picture = view_picture(&whole, camera->canvas.pixels, camera->canvas.stride);
	err = frame_decoder_create(&camera->decoder, DEINTERLACE_WEAVE);
	return err ? err : frame_reader_open(&camera->reader, &camera->frame, &whole, NULL);
}

static void camera_destroy(struct bench_camera *camera)
{
	frame_decoder_destroy(camera->decoder);
	canvas_free(&camera->canvas);
	free(camera->yuyv);
}

static void camera_take(struct bench_camera *camera, const struct canvas *picture)
{
	ARGBToYUY2(picture->pixels, (int)picture->stride, camera->yuyv,
		   (int)camera->frame.planes[0].stride, picture->width, picture->height);
}

static int create_sampler(struct bench_frame *f, struct fault *fault)
{
	const struct fisheye_settings lens = {.field_deg = 90};
	const struct light_sampler_settings settings = {.transfer = TRANSFER_SRGB, .gain = 1};
	const int width = (int)f->basis->info.width, height = (int)f->basis->info.height;
	int err = fisheye_prepare(&f->lens, &lens, width, height, fault);

	return err ? err
		   : light_sampler_create(&f->sampler, &f->dome, &f->lens, width, height, &settings,
					  fault);
}

static int fill(struct bench_frame *f, const struct canvas *background, struct fault *fault)
{
	const struct basis_info_chunk *info = &f->basis->info;
	int err = lightings_dome(&f->dome, f->basis, fault);

	if (err)
		return err;
	f->radiance = calloc(info->lights, sizeof(*f->radiance));
	if (!f->radiance || light_selection_create(&f->lights, f->basis) ||
	    camera_create(&f->background, (int)info->width, (int)info->height) ||
	    camera_create(&f->fisheye, (int)info->width, (int)info->height))
		return fault_say(fault, -ENOMEM, "not enough memory for two cameras of %ux%u",
				 info->width, info->height);
	camera_take(&f->background, background);
	/* for double precision; the compositor takes it from the camera */
	err = frame_decode(f->background.decoder, &f->background.frame, &f->background.canvas,
			   fault);
	return err ? err : create_sampler(f, fault);
}

int bench_frame_create(struct bench_frame **frame, const struct basis *basis,
		       const struct canvas *background, struct fault *fault)
{
	struct bench_frame *f = calloc(1, sizeof(*f));
	int err;

	if (!f)
		return fault_say(fault, -ENOMEM, "not enough memory");
	f->basis = basis;
	err = fill(f, background, fault);
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
	light_selection_free(&f->lights);
	camera_destroy(&f->background);
	camera_destroy(&f->fisheye);
	dome_free(&f->dome);
	free(f->radiance);
	free(f);
}

void bench_frame_light(struct bench_frame *f, const float (*radiance)[3])
{
	const struct canvas *canvas = &f->fisheye.canvas;

	for (int y = 0; y < canvas->height; y++) {
		for (int x = 0; x < canvas->width; x++) {
			uint8_t *to = canvas->pixels + (size_t)y * canvas->stride + (size_t)x * 4;
			const double px[2] = {x + 0.5, y + 0.5};
			double d[3];
			int cell = -1;

			if (fisheye_ray(&f->lens, px, d))
				cell = dome_cell_of(&f->dome, d);
			for (int c = 0; c < 3; c++) {
				const double light = cell < 0 ? 0 : (double)radiance[cell][c];

				to[2 - c] = (uint8_t)lrint(
					255 * transfer_encode(TRANSFER_SRGB, fmin(light, 1)));
			}
		}
	}
	camera_take(&f->fisheye, canvas);
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
	int err = frame_decode(f->fisheye.decoder, &f->fisheye.frame, &f->fisheye.canvas, fault);

	if (err)
		return err;
	err = light_sampler_read(f->sampler, &f->fisheye.picture, f->radiance, NULL);
	if (err)
		return fault_say(fault, err, "whole frame: the light cannot be measured: %s",
				 strerror(-err));
	light_selection_choose(&f->lights, f->basis, 0, (const float(*)[3])f->radiance, threshold,
			       THRESHOLD_AMBIENT, 1);
	err = compositor_run(compositor, 0, &f->lights, &backdrop, out->pixels, out->stride);
	*bytes = compositor_last(compositor).basis_bytes;
	return err ? fault_say(fault, err, "whole frame: the compositor fails: %s", strerror(-err))
		   : 0;
}

struct picture bench_frame_background(const struct bench_frame *f)
{
	return f->background.picture;
}

const struct light_selection *bench_frame_lights(const struct bench_frame *f)
{
	return &f->lights;
}
