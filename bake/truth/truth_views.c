/* SPDX-License-Identifier: MIT */
#include "bake/truth/truth_views.h"

#include "bake/truth/truth_paths.h"
#include "hal/base/pool.h"

#define SUBSAMPLES 4	  /* per side of a pixel */
#define SUBSAMPLES_MAX 64 /* of the fisheye, whose pixels may be coarser than texels */
/* Per radius of a lamp: so many points count a circle's area to 0.5 % (Gauss's circle problem). */
#define LAMP_SUBSAMPLES 16

struct truth_seeing {
	const struct scene *scene;
	const struct sky *sky;		 /* of the real scene */
	const struct panorama *panorama; /* what is seen; NULL: the real scene */
	const struct truth_eye *eye;	 /* NULL: the scene's camera */
	const struct truth_settings *settings;
	struct image *out;
	double turn; /* of a fisheye, rad per pixel at most */
};

/* Light of the real scene from a direction. */
static struct rgb real_light(struct tracer *t, struct v3 origin, struct v3 direction)
{
	struct rgb light = sky_radiance(t->sky, direction);
	struct surface surface;
	float far = INFINITY;

	if (world_nearest(t->scene->world, WITHOUT_OBJECTS, origin, direction, &surface)) {
		far = v3_length(v3_sub(surface.position, origin));
		light = truth_real_light(t, &surface, v3_scale(direction, -1));
	}
	return rgb_add(light, sky_lamps(t->sky, origin, direction, far));
}

/* Finds the direction of a point in the picture. Returns its weight; 0: nothing is seen there. */
static double seeing_ray(const struct truth_seeing *s, const double px[2],
			 struct fisheye_pixel *pixel)
{
	double origin[3];

	*pixel = (struct fisheye_pixel){.sr = 1, .falloff = 1};
	if (s->eye ? !fisheye_pixel_of(&s->eye->lens, px, pixel)
		   : tsai_ray(&s->scene->camera, px, origin, pixel->dir) < 0)
		return 0;
	return pixel->sr;
}

/* Samples per side of a pixel of a fisheye: more where a lamp is, whose light counts in full. */
static int eye_fineness(const struct truth_seeing *s, int x, int y)
{
	const struct image *image = s->panorama ? s->panorama->image : s->sky->panorama.image;
	const double px[2] = {x + 0.5, y + 0.5};
	/* four points a texel, so that a sun of one texel is not missed or counted twice */
	double fineness = image ? ceil(2.0 * image->width / s->eye->side) : 0;
	struct fisheye_pixel pixel;

	for (int k = 0; !s->panorama && k < s->sky->lamp_count; k++) {
		const struct truth_lamp *lamp = &s->sky->lamps[k];
		const struct v3 way = v3_unit(v3_sub(lamp->centre, s->eye->place));
		const double angle = lamp_angle(lamp, s->eye->place);

		if (seeing_ray(s, px, &pixel) > 0 &&
		    pixel.dir[0] * way.x + pixel.dir[1] * way.y + pixel.dir[2] * way.z >=
			    cos(fmin(angle + s->turn, M_PI)))
			fineness = fmax(fineness, ceil(LAMP_SUBSAMPLES * s->turn / angle));
	}
	return (int)fmin(fmax(fineness, SUBSAMPLES), SUBSAMPLES_MAX);
}

static void seeing_pixel(const struct truth_seeing *s, int x, int y)
{
	const uint64_t pixel = (uint64_t)y * (uint64_t)s->out->width + (uint64_t)x;
	const uint64_t scramble = random_hash((uint64_t)s->settings->seed, pixel, 0x7365);
	const int fineness = s->eye ? eye_fineness(s, x, y) : (int)ceil(sqrt(s->settings->samples));
	struct tracer t = {.scene = s->scene,
			   .sky = s->sky,
			   .bounces = s->settings->bounces,
			   .random = {scramble}};
	double sum[3] = {0, 0, 0}, all = 0;

	for (int k = 0; k < fineness * fineness; k++) {
		const double px[2] = {x + (k % fineness + 0.5) / fineness,
				      y + (k / fineness + 0.5) / fineness};
		struct fisheye_pixel at;
		const double weight = seeing_ray(s, px, &at);
		double rgb[3];

		if (weight <= 0)
			continue;
		if (s->panorama) {
			panorama_radiance(s->panorama, at.dir, rgb);
		} else {
			const struct v3 d = v3_make((float)at.dir[0], (float)at.dir[1],
						    (float)at.dir[2]);
			struct rgb light;

			t.first[0] = random_unit(sobol_first((uint32_t)k) ^ (uint32_t)scramble);
			t.first[1] = random_unit(sobol_second((uint32_t)k) ^
						 (uint32_t)(scramble >> 32));
			light = real_light(&t, s->eye ? s->eye->place : s->scene->eye, d);
			for (int c = 0; c < 3; c++)
				rgb[c] = (double)light.c[c];
		}
		all += weight;
		for (int c = 0; c < 3; c++)
			sum[c] += weight * at.falloff * rgb[c];
	}
	for (size_t c = 0; c < 3; c++)
		s->out->f32[3 * pixel + c] = all > 0 ? (float)(sum[c] / all) : 0;
}

static void seeing_row(void *context, int y, int worker)
{
	const struct truth_seeing *s = context;

	(void)worker;
	for (int x = 0; x < s->out->width; x++)
		seeing_pixel(s, x, y);
}

static int see(struct truth_seeing *s)
{
	const int width = s->eye ? s->eye->side : s->scene->camera.width;
	const int height = s->eye ? s->eye->side : s->scene->camera.height;
	struct pool *pool;
	int err = pool_create(&pool, s->settings->threads);

	if (err)
		return err;
	s->turn = s->eye ? fisheye_turn_per_pixel(&s->eye->lens) : 0;
	err = image_create_f32(s->out, width, height);
	if (!err)
		pool_run(pool, height, seeing_row, s);
	pool_destroy(pool);
	return err;
}

int truth_background(const struct scene *scene, const struct panorama *panorama, struct image *out)
{
	const struct truth_settings settings = {.samples = SUBSAMPLES * SUBSAMPLES};

	return see(&(struct truth_seeing){
		.scene = scene, .panorama = panorama, .settings = &settings, .out = out});
}

int truth_fisheye(const struct panorama *panorama, int side, struct image *out)
{
	const struct truth_settings settings = {.threads = 0};
	const struct fisheye_settings lens = {.field_deg = 90};
	struct truth_eye eye = {.side = side};
	const int err = fisheye_prepare(&eye.lens, &lens, side, side, NULL);

	return err ? err
		   : see(&(struct truth_seeing){
			     .panorama = panorama, .eye = &eye, .settings = &settings, .out = out});
}

int truth_see(const struct scene *scene, const struct sky *sky, const struct truth_eye *eye,
	      const struct truth_settings *settings, struct image *out)
{
	return see(&(struct truth_seeing){scene, sky, NULL, eye, settings, out, 0});
}
