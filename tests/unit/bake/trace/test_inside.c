/* SPDX-License-Identifier: MIT */
/* Balls inside objects: a ray that meets one is blocked by the object's triangles. */
#include "bake/base/random.h"
#include "bake/scene/scene.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define RINGS 24
#define RAYS 200000

/* Writes a surface of revolution around Z: two bodies of radius 0.5 with a waist of 0.1 between
 * them. turned: its triangles face inward; holes: faces left out. */
static void write_dumbbell(const char *name, bool turned, int holes)
{
	char text[200000];
	size_t at = 0;

	for (int j = 0; j < RINGS; j++)
		for (int i = 0; i < RINGS; i++) {
			const double z = -1 + 2 * (j + 0.5) / RINGS, a = 2 * M_PI * i / RINGS;
			const double r = 0.1 + 0.4 * fabs(sin(M_PI * z));

			at += (size_t)snprintf(text + at, sizeof(text) - at, "v %.6f %.6f %.6f\n",
					       r * cos(a), r * sin(a), z);
		}
	at += (size_t)snprintf(text + at, sizeof(text) - at, "v 0 0 -1\nv 0 0 1\n");
	for (int j = -1; j < RINGS; j++)
		for (int i = 0; i < RINGS; i++) {
			const int next = (i + 1) % RINGS, bottom = RINGS * RINGS + 1;
			const int a = j < 0 ? bottom : j * RINGS + i + 1;
			const int b = j < 0 ? bottom : j * RINGS + next + 1;
			const int c = j == RINGS - 1 ? bottom + 1 : (j + 1) * RINGS + next + 1;
			const int d = j == RINGS - 1 ? bottom + 1 : (j + 1) * RINGS + i + 1;

			if (holes-- > 0)
				continue;
			if (a != b)
				at += (size_t)snprintf(text + at, sizeof(text) - at, "f %d %d %d\n",
						       turned ? b : a, turned ? a : b, c);
			if (c != d)
				at += (size_t)snprintf(text + at, sizeof(text) - at, "f %d %d %d\n",
						       turned ? c : a, turned ? a : c, d);
		}
	small_scene_write(name, "%s", text);
}

static struct scene *open_objects(const char *first, const char *second)
{
	small_scene_write("objects.ini",
			  "[camera]\nposition = 0 -8 2\nlook_at = 0 0 1\nwidth = 16\nheight = 16\n"
			  "[object first]\nfile = %s\nup = z\nposition = 0 0 1\n"
			  "[object second]\nfile = %s\nup = z\nposition = 0.7 0 1.4\n",
			  first, second);
	return small_scene_open("objects.ini");
}

static struct v3 random_point(struct random *random, float size)
{
	const float x = random_next(random), y = random_next(random);

	return v3_make((x - 0.5f) * size, (y - 0.5f) * size,
		       1 + (random_next(random) - 0.5f) * size);
}

/* Rays from near and far, and from inside. */
TEST("rays")
{
	struct random random = {1};
	const struct inside *inside;
	struct scene *scene;
	int met = 0;

	write_dumbbell("dumbbell.obj", false, 0);
	small_scene_write_sphere("ball.obj", 0.4, 12);
	scene = open_objects("dumbbell.obj", "ball.obj");
	inside = world_inside(scene->world);
	for (int k = 0; k < RAYS; k++) {
		const struct v3 from = random_point(&random, k % 3 == 0 ? 100 : 3);
		const struct v3 d = v3_unit(v3_sub(random_point(&random, 2), from));
		struct inside_view view;

		inside_see(inside, from, &view);
		if (inside_find(&view, d) < 0)
			continue;
		met++;
		expect_that(!world_passage(scene->world, WITH_OBJECTS, from, d, INFINITY).open,
			    "ray %d", k);
	}
	/* most of the rays that are blocked at all */
	expect_above(met, RAYS / 4, "rays of %d", RAYS);
	scene_close(scene);
}

static int balls_of(const char *object)
{
	struct scene *scene = open_objects(object, object);
	const int count = world_inside(scene->world)->count;

	scene_close(scene);
	return count;
}

TEST("not closed")
{
	write_dumbbell("closed.obj", false, 0);
	write_dumbbell("turned.obj", true, 0);
	write_dumbbell("hole.obj", false, 1);
	expect_above(balls_of("closed.obj"), 20, "closed");
	expect_above(balls_of("turned.obj"), 20, "wound inwards: mesh_read() turns it");
	expect_equal(balls_of("hole.obj"), 0, "one face is missing");
}

TEST_GROUP(small_scene_begin, small_scene_end);
