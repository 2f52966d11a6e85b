/* SPDX-License-Identifier: MIT */
/* Walkers in the studio: their bodies against rays cast much more densely, their shadows, their
 * feet. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sim/sim.h"
#include "hal/optics/vec.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

enum { WIDTH = 160, HEIGHT = 120, PIXELS = WIDTH * HEIGHT };

static const struct studio_lamps lamps_off = {.panels = 0};

static struct studio_view *make_view(struct sim_eye *eye)
{
	const double from[3] = {0, -2.4, 1.35}, to[3] = {0, 0.25, 0.25};
	struct studio_view *view;

	memset(eye, 0, sizeof(*eye));
	eye->width = WIDTH;
	eye->height = HEIGHT;
	assert_int_equal(tsai_look_at(&eye->camera, WIDTH, HEIGHT, from, to, 58, NULL), 0);
	assert_int_equal(studio_view_create(&view, eye), 0);
	return view;
}

/* Share of 16 x 16 rays of a pixel that hit, each part tried. */
static double dense_alpha(const struct sim_eye *eye, const struct walker_body *body, int x, int y)
{
	const int side = 16;
	int hits = 0;

	for (int k = 0; k < side * side; k++) {
		const double px[2] = {x + (k % side + 0.5) / side, y + (k / side + 0.5) / side};
		double origin[3], dir[3];
		struct walker_hit hit;

		assert_true(eye_ray(eye, px, origin, dir));
		hits += walker_hit(body, ~0u, origin, dir, &hit);
	}
	return (double)hits / (side * side);
}

TEST("bodies cover what dense rays hit")
{
	static struct studio_layer layer[PIXELS];
	struct sim_eye eye;
	struct studio_view *view = make_view(&eye);
	double worst = 0, sum = 0;
	const int step = thorough() ? 1 : 7; /* prime to the width: all columns are met */
	int count = 0;

	for (int style = 0; style < WALKER_STYLES; style++) {
		const struct walker walker = {.style = (enum walker_style)style,
					      .place = {0.1 * style - 0.2, 0.3},
					      .heading_rad = 0.7 * style,
					      .walked = 0.17 * style,
					      .pace = 1,
					      .bag_in_hand = style == WALKER_BAG};
		struct walker_body body;

		walker_pose(&walker, &body);
		studio_people_draw(view, &lamps_off, &walker, 1, layer);
		for (int k = style; k < PIXELS; k += step, count++) {
			const double alpha = dense_alpha(&eye, &body, k % WIDTH, k / WIDTH);
			const double off = fabs(alpha - layer[k].alpha);

			worst = fmax(worst, off);
			sum += off * off;
			assert_int_equal(layer[k].walker, layer[k].alpha > 0 ? 0 : -1);
		}
	}
	sum = sqrt(sum / count);
	print_message("# alpha of 4 x 4 against 16 x 16 rays: RMS %.4f, largest %.3f\n", sum,
		      worst);
	assert_true(sum < 0.01);
	assert_true(worst < 0.3);
	studio_view_destroy(view);
}

/* A single lantern to the left: ground to the right is darker, ground to the left is as before. */
TEST("shadows fall away from the light")
{
	static float empty[PIXELS * 3], shaded[PIXELS * 3];
	struct studio_lamps lamps = studio_lamps(0, 0);
	const struct walker walker = {.style = WALKER_SUIT, .place = {0, 0.2}};
	struct sim_eye eye;
	struct studio_view *view = make_view(&eye);
	double kept[2] = {0, 0}, had[2] = {0, 0};

	lamps.panels = 0;
	for (int i = 0; i < STUDIO_LANTERNS; i++) {
		lamps.lantern[i].centre[0] = -1.2;
		lamps.lantern[i].centre[1] = 0.2;
		lamps.lantern[i].centre[2] = 1.3;
	}
	studio_view_render(view, &lamps, empty);
	memcpy(shaded, empty, sizeof(empty));
	studio_people_shade(view, &lamps, &walker, 1, shaded);
	for (int k = 0; k < PIXELS; k++) {
		const struct studio_ground at = studio_view_ground(view, k % WIDTH, k / WIDTH);

		assert_true(shaded[3 * k] <= empty[3 * k]);
		if (at.normal[2] < 0.5 || fabs(at.point[1] - 0.2) > 0.1)
			continue;
		for (int side = 0; side < 2; side++) /* left, right; 0.4 m to 0.9 m from the feet */
			if (fabs(at.point[0] - (side ? 0.65 : -0.65)) < 0.25) {
				kept[side] += (double)shaded[3 * k];
				had[side] += (double)empty[3 * k];
			}
	}
	print_message("# light kept: %.2f before the walker, %.2f behind\n", kept[0] / had[0],
		      kept[1] / had[1]);
	/* The window's and the ambient light stay. */
	assert_true(kept[0] > 0.9 * had[0]);
	assert_true(kept[1] < 0.75 * had[1]);
	studio_view_destroy(view);
}

/* Share of the rays from a point to the disc that a lantern shows it which a body stops. */
static double dense_hidden(const struct walker_body *body, const double point[3],
			   const double lamp[3], double radius)
{
	const int side = 24;
	double to[3], across[3] = {0, 0, 1}, up[3];
	int cast = 0, hidden = 0;

	for (int i = 0; i < 3; i++)
		to[i] = lamp[i] - point[i];
	vec_cross(across, to, up);
	memcpy(across, up, sizeof(up));
	vec_normalize(across);
	vec_cross(to, across, up);
	vec_normalize(up);
	for (int k = 0; k < side * side; k++) {
		const double u = (k % side + 0.5) / side * 2 - 1,
			     v = (k / side + 0.5) / side * 2 - 1;
		struct walker_hit hit;
		double dir[3];

		if (u * u + v * v > 1)
			continue;
		for (int i = 0; i < 3; i++)
			dir[i] = to[i] + radius * (u * across[i] + v * up[i]);
		vec_normalize(dir);
		cast++;
		hidden += walker_hit(body, ~0u, point, dir, &hit);
	}
	return (double)hidden / cast;
}

/* What stands in for the rays of a lamp is off by this. */
TEST("shadows are as deep as dense rays say")
{
	const struct walker walker = {.style = WALKER_CHECKS, .walked = 0.2, .pace = 1};
	const double lamp[3] = {-1.2, 0.2, 1.6}, radius = 0.3;
	struct walker_body body;
	double sum = 0, mean = 0, truth = 0;
	int count = 0;

	walker_pose(&walker, &body);
	for (double x = -0.8; x < 1.6; x += 0.05)
		for (double y = -0.8; y < 0.8; y += 0.05) {
			const double point[3] = {x, y, 0};
			const double want = dense_hidden(&body, point, lamp, radius);
			const double got = walker_hides(&body, point, lamp, radius);

			sum += (got - want) * (got - want);
			mean += got;
			truth += want;
			count++;
		}
	sum = sqrt(sum / count);
	print_message("# hidden share of a lantern: RMS off by %.3f; mean %.3f, truth %.3f\n", sum,
		      mean / count, truth / count);
	assert_true(sum < 0.1); /* as walker_body.h says */
	assert_true(fabs(mean - truth) < 0.15 * truth);
}

TEST("a walker may have another height and other clothes, and a surface another colour")
{
	static float as_built[PIXELS * 3], painted[PIXELS * 3];
	static const double cloth[6][3] = {{.1}, {.2}, {.3}, {.4}, {.5}, {.6}};
	const double up[3] = {0, 0, 1}, factor[3] = {0.5, 0.25, 2}, below[3] = {0, 0, -0.1};
	const struct studio_lamps lamps = studio_lamps(3, 0);
	struct walker walker = {.style = WALKER_SUIT, .height = 0.7, .cloth = cloth};
	struct walker_body body;
	struct walker_hit hit;
	struct sim_eye eye;
	struct studio_view *view = make_view(&eye);
	const int k = WIDTH / 2;

	walker_pose(&walker, &body);
	assert_true(fabs(body.low[2] + body.up[2] - 0.7 * 1.735) < 0.01); /* crown and hair */
	assert_true(walker_hit(&body, ~0u, below, up, &hit));
	assert_true(body.part[hit.part].cloth >= CLOTH_LEGS);
	assert_true(hit.albedo[0] > 0.35 && hit.albedo[1] == 0);
	studio_view_render(view, &lamps, as_built);
	studio_view_paint(view, k, HEIGHT - 1, factor);
	studio_view_render(view, &lamps, painted);
	for (int c = 0; c < 3; c++) {
		const int at = 3 * ((HEIGHT - 1) * WIDTH + k) + c;

		assert_true(fabs((double)painted[at] - factor[c] * (double)as_built[at]) < 1e-5);
		assert_true(painted[at - 3] == as_built[at - 3]);
	}
	studio_view_destroy(view);
}

TEST("nobody changes nothing")
{
	static float before[PIXELS * 3], after[PIXELS * 3];
	static struct studio_layer layer[PIXELS];
	const struct studio_lamps lamps = studio_lamps(3, 0);
	struct walker list[WALKER_STYLES];
	struct sim_eye eye;
	struct studio_view *view = make_view(&eye);

	assert_int_equal(walkers_at(3, 0, list), 0);
	studio_view_render(view, &lamps, before);
	memcpy(after, before, sizeof(after));
	studio_people_shade(view, &lamps, list, 0, after);
	studio_people_draw(view, &lamps, list, 0, layer);
	studio_people_over(view, layer, after);
	assert_memory_equal(before, after, sizeof(after));
	studio_view_destroy(view);
}

/* Height of the lowest point of a shoe. */
static double shoe_bottom(const struct walker_part *shoe)
{
	return fmin(shoe->from[2], shoe->from[2] + shoe->along[2]) - shoe->radius;
}

/* One foot is on the ground at any time, none is below it, and the one that stands does not
 * slide. */
TEST("feet stand on the ground")
{
	for (double walked = 0; walked < 2; walked += 0.01) {
		const struct walker walker = {
			.walked = walked, .place = {walked * WALKER_STRIDE_M, 0}, .pace = 1};
		struct walker_body body;
		double lowest = 1;

		walker_pose(&walker, &body);
		for (int p = 0; p < body.count; p++)
			if (body.part[p].cloth == CLOTH_SHOES)
				lowest = fmin(lowest, shoe_bottom(&body.part[p]));
		assert_true(lowest > -0.002 && lowest < 0.01);
	}
}

TEST("walkers walk without jumps")
{
	struct walker before[WALKER_STYLES], now[WALKER_STYLES];
	const double step_s = 0.02;
	int count = walkers_at(0, WALKER_STYLES, before), seen = 0;

	for (double t = step_s; t < 60; t += step_s) {
		const int present = walkers_at(t, WALKER_STYLES, now);

		for (int i = 0; i < present; i++)
			for (int k = 0; k < count; k++) {
				const double way = hypot(now[i].place[0] - before[k].place[0],
							 now[i].place[1] - before[k].place[1]);

				if (now[i].style != before[k].style || now[i].absent ||
				    before[k].absent)
					continue;
				seen++;
				assert_true(way < 1.4 * step_s);
			}
		memcpy(before, now, sizeof(now));
		count = present;
	}
	assert_true(seen > 3000);
}
