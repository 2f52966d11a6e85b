/* SPDX-License-Identifier: MIT */
/* The studio: its closed forms, its picture, its true light, and what the light sampler measures.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sim/sim.h"
#include "hal/colour/transfer.h"
#include "hal/lights/sampler.h"
#include "hal/optics/vec.h"
#include "tests/support/studio_lights.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

static const double origin[3] = {0, 0, 0};

/* Irradiance on the floor, by brute force over the hemisphere. */
static void brute_irradiance(const double point[3], double rgb[3])
{
	const int rings = 900, sectors = 1800;

	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < rings; i++)
		for (int j = 0; j < sectors; j++) {
			const double theta = (i + 0.5) * M_PI / 2 / rings;
			const double phi = (j + 0.5) * 2 * M_PI / sectors;
			const double dir[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi),
					       cos(theta)};
			const double weight = cos(theta) * sin(theta) * M_PI / 2 / rings * 2 *
					      M_PI / sectors;
			struct studio_hit hit;

			assert_true(studio_hit(point, dir, &hit));
			for (int c = 0; c < 3; c++)
				rgb[c] += weight * hit.emitted[c];
		}
}

/* The constant part cancels in the difference between two places. */
TEST("rectangles irradiate as they shine")
{
	const double places[3][3] = {{0, 0, 0}, {-2.0, -0.4, 0}, {1.2, 0.3, 0}};
	double closed[3][3], brute[3][3];

	for (int i = 0; i < 3; i++) {
		studio_steady_irradiance(places[i], STUDIO_FLOOR, 1, closed[i]);
		brute_irradiance(places[i], brute[i]);
	}
	for (int i = 1; i < 3; i++)
		for (int c = 0; c < 3; c++) {
			const double want = brute[i][c] - brute[0][c];
			const double got = closed[i][c] - closed[0][c];

			/* the closed form spreads the window's bars evenly over the window */
			assert_true(fabs(got - want) < 0.004);
			assert_true(fabs(want) > 0.01);
		}
}

TEST("lanterns irradiate as they shine")
{
	const struct studio_lantern lantern = {{0.7, -0.4, 1.6}, 0.3, {1, 1, 1}};
	const double normal[3] = {0, 0, 1};
	const double distance = sqrt(0.49 + 0.16 + 2.56);
	const int steps = 1500;
	double sum = 0;

	for (int i = 0; i < steps; i++)
		for (int j = 0; j < 2 * steps; j++) {
			const double theta = (i + 0.5) * M_PI / 2 / steps;
			const double phi = (j + 0.5) * M_PI / steps;
			const double dir[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi),
					       cos(theta)};
			const double along = vec_dot(dir, lantern.centre);

			if (along > 0 &&
			    distance * distance - along * along < lantern.radius * lantern.radius)
				sum += cos(theta) * sin(theta) * M_PI / 2 / steps * M_PI / steps;
		}
	assert_true(fabs(studio_lantern_irradiance(&lantern, origin, normal) / sum - 1) < 0.003);
}

TEST("lanterns keep their distance")
{
	struct studio_lamps before = studio_lamps(0, 0);

	for (int step = 1; step < 24000; step++) {
		const struct studio_lamps lamps = studio_lamps(step * 0.01, 0);
		const struct studio_lantern *now = lamps.lantern;
		double apart[3];

		for (int i = 0; i < STUDIO_LANTERNS; i++) {
			const double *c = now[i].centre, r = now[i].radius;

			assert_true(fabs(c[0]) + r < 3 && fabs(c[1]) + r < 2.5);
			assert_true(c[2] - r > 0.9 && c[2] + r < 3);
			for (int k = 0; k < 3; k++)
				assert_true(fabs(c[k] - before.lantern[i].centre[k]) < 0.015);
		}
		for (int k = 0; k < 3; k++)
			apart[k] = now[0].centre[k] - now[1].centre[k];
		assert_true(vec_length(apart) > now[0].radius + now[1].radius + 0.3);
		before = lamps;
	}
}

/* A time when the warm lantern stands at +X or +Y of the middle, as seen from above. */
static double moment(int axis)
{
	double best = 0, best_cosine = -1;

	for (double t = 0; t < 12; t += 0.01) {
		const struct studio_lamps lamps = studio_lamps(t, 0);
		const double *centre = lamps.lantern[0].centre;
		const double cosine = centre[axis] / hypot(centre[0], centre[1]);

		if (cosine > best_cosine) {
			best_cosine = cosine;
			best = t;
		}
	}
	assert_true(best_cosine > 0.99);
	return best;
}

static void prepare_fisheye(struct sim_eye *eye, int side)
{
	const struct fisheye_settings settings = {.field_deg = 90};

	memset(eye, 0, sizeof(*eye));
	eye->width = eye->height = side;
	eye->fisheye = true;
	assert_int_equal(fisheye_prepare(&eye->lens, &settings, side, side, NULL), 0);
}

static void prepare_camera(struct sim_eye *eye, int width, int height, const double from[3],
			   const double to[3], double angle_deg)
{
	memset(eye, 0, sizeof(*eye));
	eye->width = width;
	eye->height = height;
	assert_int_equal(tsai_look_at(&eye->camera, width, height, from, to, angle_deg, NULL), 0);
}

static float *render(const struct sim_eye *eye, double time_s, double switch_s)
{
	float *rgb = calloc((size_t)eye->width * (size_t)eye->height * 3, sizeof(float));
	const struct studio_lamps lamps = studio_lamps(time_s, switch_s);
	struct studio_view *view;

	assert_int_equal(studio_view_create(&view, eye), 0);
	studio_view_render(view, &lamps, rgb);
	studio_view_destroy(view);
	return rgb;
}

/* Place of the warm lantern in the picture: the mean of the pixels as bright as it, relative to the
 * middle. */
static void warm_place(const struct sim_eye *eye, double time_s, double place[2])
{
	float *rgb = render(eye, time_s, 0);
	const struct studio_lamps lamps = studio_lamps(time_s, 0);
	const double *warm = lamps.lantern[0].radiance;
	int count = 0;

	place[0] = place[1] = 0;
	for (int y = 0; y < eye->height; y++)
		for (int x = 0; x < eye->width; x++) {
			const float *p = rgb + 3 * (y * eye->width + x);

			if (fabs(p[0] - warm[0]) > 1e-3 || fabs(p[2] - warm[2]) > 1e-3)
				continue;
			place[0] += x + 0.5;
			place[1] += y + 0.5;
			count++;
		}
	assert_true(count > 20);
	place[0] = place[0] / count - eye->width / 2.0;
	place[1] = place[1] / count - eye->height / 2.0;
	free(rgb);
}

TEST("nothing is mirrored")
{
	const double from[3] = {0, -2.4, 1.5}, to[3] = {0, 2, 1.5};
	struct sim_eye eye;
	double place[2];

	prepare_fisheye(&eye, 200);
	warm_place(&eye, moment(0), place); /* +X: to the right */
	assert_true(place[0] > 20 && fabs(place[1]) < 0.15 * place[0]);
	warm_place(&eye, moment(1), place); /* +Y: below */
	assert_true(place[1] > 20 && fabs(place[0]) < 0.15 * place[1]);
	prepare_camera(&eye, 200, 150, from, to, 80); /* from -Y towards +Y, +X is on the right */
	warm_place(&eye, moment(0), place);
	assert_true(place[0] > 20);
}

/* The perspective view is upright: floor below, ceiling above, the window on the left. */
TEST("nothing is upside down")
{
	const double from[3] = {0, -2.4, 1.5}, to[3] = {0, 2, 1.5};
	struct studio_hit hit;
	double start[3], dir[3];
	struct sim_eye eye;

	prepare_camera(&eye, 200, 150, from, to, 100);
	assert_true(eye_ray(&eye, (double[2]){100, 2}, start, dir));
	assert_true(studio_hit(start, dir, &hit) && hit.surface == STUDIO_CEILING);
	assert_true(eye_ray(&eye, (double[2]){100, 148}, start, dir));
	assert_true(studio_hit(start, dir, &hit) && hit.surface == STUDIO_FLOOR);
	assert_true(eye_ray(&eye, (double[2]){2, 75}, start, dir));
	assert_true(studio_hit(start, dir, &hit) && hit.surface == STUDIO_WALL_WEST);
}

/* Mean of 10 x 10 traced rays through the pixel; dark where there is no ray. */
static void traced_pixel(const struct sim_eye *eye, int x, int y, const struct studio_lamps *lamps,
			 double rgb[3])
{
	const int side = 10;

	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int i = 0; i < side * side; i++) {
		const double px[2] = {x + (i % side + 0.5) / side, y + (i / side + 0.5) / side};
		double start[3], dir[3], one[3];

		if (!eye_ray(eye, px, start, dir))
			continue;
		studio_radiance(start, dir, lamps, one);
		for (int c = 0; c < 3; c++)
			rgb[c] += one[c];
	}
	for (int c = 0; c < 3; c++)
		rgb[c] /= side * side;
}

static void check_view(const struct sim_eye *eye, double switch_s, const char *name)
{
	const struct studio_lamps lamps = studio_lamps(3.7, switch_s);
	/* Neither side of a picture is a multiple of 7, so that rows begin in all of its
	 * columns. */
	const int stride = thorough() ? 1 : 7;
	double worst = 0, sum = 0;
	float *rgb = render(eye, 3.7, switch_s);
	long count = 0;

	for (int p = 0; p < eye->width * eye->height; p += stride) {
		const int x = p % eye->width, y = p / eye->width;
		double want[3];

		traced_pixel(eye, x, y, &lamps, want);
		for (int c = 0; c < 3; c++) {
			const double error = fabs((double)rgb[3 * p + c] - want[c]);

			worst = fmax(worst, error);
			sum += error * error;
			count++;
		}
	}
	free(rgb);
	sum = sqrt(sum / (double)count);
	print_message("# %s against traced rays: RMS %.4f, largest %.3f of 5.2\n", name, sum,
		      worst);
	/* the driver samples edges less densely; the window's bars are as fine as a pixel */
	assert_true(sum < 0.02);
	assert_true(worst < 0.8);
}

TEST("views match traced rays")
{
	const double from[3] = {0.3, -1.9, 1.4}, to[3] = {0.1, 0.5, 1.1};
	struct sim_eye eye;

	prepare_fisheye(&eye, 240);
	check_view(&eye, 0, "fisheye");
	prepare_camera(&eye, 240, 180, from, to, 70);
	check_view(&eye, 0, "perspective");
	check_view(&eye, 3, "perspective, the panels off");
}

TEST("panels are switched")
{
	double on[3], off[3];

	assert_true(studio_lamps(2.9, 3).panels == 1 && studio_lamps(3, 3).panels == 0);
	assert_true(studio_lamps(6, 3).panels == 1 && studio_lamps(3, 0).panels == 1);
	studio_steady_irradiance(origin, STUDIO_FLOOR, 1, on);
	studio_steady_irradiance(origin, STUDIO_FLOOR, 0, off);
	for (int c = 0; c < 3; c++)
		assert_true(off[c] < 0.8 * on[c] && off[c] > 0.3);
}

TEST("exposure suits a camera")
{
	static const double eye[3] = {0, -1.7, 0.95};

	for (double t = 0; t < 60; t += 1.3) {
		const struct studio_lamps lamps = studio_lamps(t, 0);

		for (int x = -2; x <= 2; x++) {
			double dir[3] = {0.15 * x - eye[0], 0.1 - eye[1], -eye[2]}, rgb[3], code;

			vec_normalize(dir);
			studio_radiance(eye, dir, &lamps, rgb);
			code = 255 * transfer_encode(TRANSFER_SRGB, rgb[1]);
			assert_true(code > 90 && code < 170);
		}
	}
}

static double random_unit(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) / 9007199254740992.0;
}

/* Random directions in each light, independent of the driver's tiles. */
TEST("lights match random sampling")
{
	const int side = 220;
	const struct studio_lamps lamps = studio_lamps(5.1, 0);
	uint64_t seed = 20261120;
	struct dome dome;
	double(*lights)[3];
	double worst = 0;

	print_message("# seed %llu\n", (unsigned long long)seed);
	assert_int_equal(dome_create(&dome, 3, NULL), 0);
	lights = calloc((size_t)dome.count, sizeof(*lights));
	assert_int_equal(studio_lights(&dome, origin, &lamps, lights), 0);
	for (int i = 0; i < dome.count; i += thorough() ? 1 : 3) {
		double sum[3] = {0, 0, 0};

		for (int j = 0; j < side * side; j++) {
			const double u = (j % side + random_unit(&seed)) / side;
			const double v = (j / side + random_unit(&seed)) / side;
			double dir[3], rgb[3];

			dome_cell_sample(&dome, i, u, v, dir);
			studio_radiance(origin, dir, &lamps, rgb);
			for (int c = 0; c < 3; c++)
				sum[c] += rgb[c] / (side * side);
		}
		for (int c = 0; c < 3; c++)
			worst = fmax(worst, fabs(sum[c] - lights[i][c]));
	}
	print_message("# true lights against random sampling: largest %.5f of 5.2\n", worst);
	assert_true(worst < 0.004);
	free(lights);
	dome_free(&dome);
}

struct sampled {
	double rms, worst, energy; /* relative to the largest light */
};

static struct sampled sample(int frequency, int side, double t)
{
	const struct light_sampler_settings settings = {.curve = {.named = TRANSFER_LINEAR},
							.gain = 1};
	const struct studio_lamps lamps = studio_lamps(t, 0);
	struct sampled s = {0, 0, 0};
	double largest = 0, true_energy = 0, energy = 0;
	struct light_sampler *sampler;
	struct dome dome;
	struct sim_eye eye;
	struct image image = {.width = side, .height = side};
	double(*truth)[3];
	float(*got)[3];

	assert_int_equal(dome_create(&dome, frequency, NULL), 0);
	truth = calloc((size_t)dome.count, sizeof(*truth));
	got = calloc((size_t)dome.count, sizeof(*got));
	prepare_fisheye(&eye, side);
	image.f32 = render(&eye, t, 0);
	assert_int_equal(studio_lights(&dome, origin, &lamps, truth), 0);
	assert_int_equal(
		light_sampler_create(&sampler, &dome, &eye.lens, side, side, &settings, NULL), 0);
	assert_int_equal(light_sampler_read_linear(sampler, &image, got), 0);
	for (int i = 0; i < dome.count; i++)
		for (int c = 0; c < 3; c++) {
			const double error = got[i][c] - truth[i][c];

			s.rms += error * error / (3.0 * dome.count);
			s.worst = fmax(s.worst, fabs(error));
			largest = fmax(largest, truth[i][c]);
			true_energy += truth[i][c] * dome.projected_sr[i];
			energy += got[i][c] * dome.projected_sr[i];
		}
	s.rms = sqrt(s.rms) / largest;
	s.worst /= largest;
	s.energy = energy / true_energy - 1;
	light_sampler_destroy(sampler);
	free(image.f32);
	free(truth);
	free(got);
	dome_free(&dome);
	return s;
}

/* The light sampler on the studio's fisheye picture, against the true light. */
TEST("the light sampler finds the true lights")
{
	static const struct {
		int frequency, side;
		double worst, energy;
	} cases[] = {{2, 480, 0.005, 0.003},
		     {9, 480, 0.03, 0.003},
		     {4, 480, 0.01, 0.003},
		     {9, 960, 0.015, 0.002}};

	for (size_t i = 0; i < (thorough() ? 4 : 2); i++) {
		const struct sampled cell = sample(cases[i].frequency, cases[i].side, 2.0);

		print_message(
			"# f %d, fisheye %d px: cell RMS %.2f %% largest %.2f %% irradiance %+.3f %%\n",
			cases[i].frequency, cases[i].side, 100 * cell.rms, 100 * cell.worst,
			100 * cell.energy);
		assert_true(cell.worst < cases[i].worst);
		assert_true(fabs(cell.energy) < cases[i].energy);
	}
}
