/* SPDX-License-Identifier: MIT */
/* Footprints of bodies whose outline from above has a closed form. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/scene/footprint.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define TRIANGLES_MAX 4096
#define EYE 1.6 /* height of the camera */

/* A mesh of triangles that are added one by one. */
struct body {
	float position[3 * TRIANGLES_MAX][4];
	uint32_t index[TRIANGLES_MAX][3];
	struct mesh_part part;
	struct mesh mesh;
};

static void add_triangle(struct body *b, const double corner[3][3])
{
	struct mesh_part *part = &b->part;
	const int t = part->triangles++;

	assert_true(t < TRIANGLES_MAX);
	for (int k = 0; k < 3; k++) {
		for (int axis = 0; axis < 3; axis++)
			b->position[3 * t + k][axis] = (float)corner[k][axis];
		b->index[t][k] = (uint32_t)(3 * t + k);
	}
	part->vertices = 3 * part->triangles;
	part->position = b->position;
	part->index = b->index;
	b->mesh = (struct mesh){.parts = part, .part_count = 1};
}

/* The side of a prism over a segment of the ground, and its top as a fan around the middle. */
static void add_side(struct body *b, const double from[2], const double to[2],
		     const double middle[2], double low, double high)
{
	const double wall[2][3][3] = {
		{{from[0], from[1], low}, {to[0], to[1], low}, {to[0], to[1], high}},
		{{from[0], from[1], low}, {to[0], to[1], high}, {from[0], from[1], high}}};
	const double top[3][3] = {
		{from[0], from[1], high}, {to[0], to[1], high}, {middle[0], middle[1], high}};

	add_triangle(b, wall[0]);
	add_triangle(b, wall[1]);
	add_triangle(b, top);
}

/* A prism over a regular polygon of that radius, its first corner turned. */
static void add_prism(struct body *b, double x, double y, double radius, int corners,
		      double turn_rad, double low, double high)
{
	const double middle[2] = {x, y};

	for (int n = 0; n < corners; n++) {
		const double a = turn_rad + 2 * M_PI * n / corners;
		const double c = turn_rad + 2 * M_PI * (n + 1) / corners;
		const double from[2] = {x + radius * cos(a), y + radius * sin(a)};
		const double to[2] = {x + radius * cos(c), y + radius * sin(c)};

		add_side(b, from, to, middle, low, high);
	}
}

static struct body *body_begin(void)
{
	struct body *b = calloc(1, sizeof(*b));

	assert_non_null(b);
	return b;
}

static struct basis_footprint measure(const struct body *b)
{
	const struct mesh *meshes[] = {&b->mesh};
	struct basis_footprint foot;

	footprint_measure(meshes, 1, EYE, &foot);
	return foot;
}

static bool is_set(const struct basis_footprint *foot, double x, double y)
{
	const double i = floor((x - (double)foot->corner[0]) / (double)foot->side);
	const double j = floor((y - (double)foot->corner[1]) / (double)foot->side);

	return i >= 0 && j >= 0 && i < BASIS_FOOT_SQUARES && j < BASIS_FOOT_SQUARES &&
	       foot->row[(int)j] >> (int)i & 1;
}

/* Whether a square within half a side is set: the outline's own, of a point close to it. */
static bool is_near_set(const struct basis_footprint *foot, double x, double y)
{
	const double step = 0.5 * (double)foot->side;

	for (int k = 0; k < 9; k++)
		if (is_set(foot, x + (k % 3 - 1) * step, y + (k / 3 - 1) * step))
			return true;
	return false;
}

/* Compares a footprint with an outline: signed distance of a point of the ground, negative inside.
 * Each point inside by less than half a square is at one that is set, none farther outside than a
 * square's diagonal. reach: how far to look. */
static void expect_outline(const struct basis_footprint *foot, double reach,
			   double (*outside)(double x, double y))
{
	const double diagonal = M_SQRT2 * 1.001 * (double)foot->side;
	int inside = 0;

	for (int v = 0; v < 500; v++)
		for (int u = 0; u < 500; u++) {
			const double x = reach * ((u + 0.5) / 250 - 1);
			const double y = reach * ((v + 0.5) / 250 - 1);
			const double off = outside(x, y);

			inside += off < 0;
			if (off < -1e-5 * reach && off > -0.5 * (double)foot->side &&
			    !is_near_set(foot, x, y))
				fail_msg("%g %g is inside by %g and not set", x, y, -off);
			if (off > diagonal && is_set(foot, x, y))
				fail_msg("%g %g is outside by %g and set", x, y, off);
		}
	assert_true(inside > 100);
}

static double off_box(double x, double y, double turn_rad, double half_x, double half_y)
{
	const double c = cos(turn_rad), n = sin(turn_rad);
	const double u = fabs(c * x + n * y) - half_x, v = fabs(-n * x + c * y) - half_y;

	return u > 0 && v > 0 ? hypot(u, v) : fmax(u, v);
}

static double off_turned(double x, double y)
{
	return off_box(x, y, 0.3, 0.5, 0.5);
}

static double off_straight(double x, double y)
{
	return off_box(x, y, M_PI / 4, 0.5, 0.5);
}

static double off_cylinder(double x, double y)
{
	return hypot(x, y) - 0.7;
}

static double off_pole(double x, double y)
{
	return hypot(x, y) - 0.05;
}

static double off_two(double x, double y)
{
	return fmin(off_box(x - 1, y, 0.3, 0.2, 0.2), hypot(x + 1, y - 0.4) - 0.3);
}

/* A square prism has its corners at sqrt(2) of its half side, at 45 degrees. */
static const double corner = M_PI / 4;

TEST("a box turned and straight")
{
	struct body *b = body_begin();
	struct basis_footprint foot;

	add_prism(b, 0, 0, 0.5 * M_SQRT2, 4, 0.3 + corner, 0, 0.6);
	foot = measure(b);
	expect_outline(&foot, 1, off_turned);
	free(b);
	b = body_begin();
	add_prism(b, 0, 0, 0.5 * M_SQRT2, 4, 2 * corner, -0.2, 5); /* as high as a tower, sunk */
	foot = measure(b);
	expect_outline(&foot, 1, off_straight);
	expect_at_most((double)foot.side, 1.42 / 64, "squares as small as the box has room for");
	free(b);
}

TEST("a cylinder that stands or floats")
{
	for (int floats = 0; floats < 2; floats++) {
		struct body *b = body_begin();
		struct basis_footprint foot;

		add_prism(b, 0, 0, 0.7, 400, 0, floats ? 0.9 : 0, 1.4);
		foot = measure(b);
		expect_outline(&foot, 1, off_cylinder);
		free(b);
	}
}

TEST("two parts have a gap")
{
	struct body *b = body_begin();
	struct basis_footprint foot;

	add_prism(b, 1, 0, 0.2 * M_SQRT2, 4, 0.3 + corner, 0, 0.6);
	add_prism(b, -1, 0.4, 0.3, 400, 0, 0, 0.6);
	foot = measure(b);
	expect_outline(&foot, 2, off_two);
	free(b);
}

/* People walk below what is above the camera's height: of a parasol counts its pole. */
TEST("what is high does not count")
{
	struct body *b = body_begin();
	struct basis_footprint foot;

	add_prism(b, 0, 0, 0.05, 100, 0, 0, 2.4);
	add_prism(b, 0, 0, 0.7, 400, 0, 2.2, 2.4);
	foot = measure(b);
	expect_outline(&foot, 0.3, off_pole);
	free(b);
}

/* All of it counts where it is high up or below the ground. */
TEST("what is all high or low counts")
{
	for (int low = 0; low < 2; low++) {
		struct body *b = body_begin();
		struct basis_footprint foot;

		add_prism(b, 0, 0, 0.7, 400, 0, low ? -2 : 3, low ? -1 : 4);
		foot = measure(b);
		expect_outline(&foot, 1, off_cylinder);
		free(b);
	}
}

TEST("what is thin is not lost")
{
	static const double wall[3][3] = {{0, -1, 0}, {0, 1, 0}, {0, 0, 1}};
	struct body *b = body_begin();
	struct basis_footprint foot;

	add_triangle(b, wall);
	foot = measure(b);
	for (int n = 0; n <= 20; n++)
		assert_true(is_set(&foot, 0, -1 + 0.1 * n));
	free(b);
	b = body_begin();
	foot = measure(b); /* nothing */
	assert_true(foot.side == 0 && !foot.row[0]);
	free(b);
}

/* ---- a bake ---- */

static void write_scene(int poses)
{
	small_scene_write("ball.scene",
			  "[camera]\nposition = 0 -5 2\nlook_at = 0 0 0.5\nfield_deg = 40\n"
			  "width = 48\nheight = 32\n[dome]\nfrequency = 1\n[render]\nsamples = 1\n"
			  "bounces = 0\n[ground]\n[poses]\ncount = %d\n[object ball]\n"
			  "file = ball.obj\nmaterial = white\nstand = yes\n[standin table]\n"
			  "file = ball.obj\nmaterial = white\nposition = 3 3 0\n[material white]\n"
			  "[keyframe a]\nobject = ball\npose = 0\nposition = 0 0 0\nscale = 1\n"
			  "[keyframe b]\nobject = ball\npose = 1\nposition = 2 1 0\nscale = 0.5\n",
			  poses);
	small_scene_write_sphere("ball.obj", 0.4, 12);
}

TEST("each pose of a bake has its own")
{
	struct fault fault = {.text = ""};
	struct basis basis;
	struct scene *scene;

	write_scene(2);
	scene = small_scene_open("ball.scene");
	small_scene_render(scene, "ball.inlay", 1);
	scene_close(scene);
	expect_success(basis_open(&basis, small_scene_path("ball.inlay"), BASIS_SHOWN, &fault),
		       &fault);
	assert_non_null(basis.feet);
	for (int p = 0; p < 2; p++) {
		const double middle[2] = {p * 2, p * 1}, radius = p ? 0.2 : 0.4;

		expect_at_most(fabs((double)basis.feet[p].side * 64 / (2 * radius) - 1), 0.03,
			       "pose %d", p);
		assert_true(is_set(&basis.feet[p], middle[0], middle[1]));
		assert_true(is_set(&basis.feet[p], middle[0] + 0.95 * radius, middle[1]));
		assert_false(
			is_set(&basis.feet[p], middle[0] + 0.8 * radius, middle[1] + 0.8 * radius));
	}
	basis_close(&basis);
}

TEST_GROUP(small_scene_begin, small_scene_end);
