/* SPDX-License-Identifier: MIT */
/* People are found, and put in order, in pictures of a floor with a block on it, whose truth is
 * known: while lamps are switched, the camera's exposure jumps, shadows pass, and somebody stands
 * still. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_format.h"
#include "hal/people/people.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define WIDTH 320
#define HEIGHT 240
#define PERIOD 33333333 /* ns */
#define LEARNING 75	/* frames */

#define NORMALS 65536
#define NOISE 0.008f /* of linear light at white */

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

/* Where somebody stands: an upright body with a textured cloth, by the ground under the feet. */
struct body {
	double x, y; /* ground; m */
	double width, height;
	double colour[3];
	bool shadow; /* casts one to the right */
	bool knees;  /* from 0.3 to 0.5 of the height the cloth looks like the floor, */
	bool neck;   /* and along a slanting line below the head */
};

struct place {
	struct dome dome;
	struct tsai_camera camera;
	float (*radiance)[3];
	double floor[HEIGHT][WIDTH][3]; /* albedo of what each pixel sees; < 0: sky */
	double ground[HEIGHT][WIDTH][2];
	uint16_t coverage[HEIGHT * WIDTH];
	uint8_t touched[(HEIGHT / BASIS_TILE) * (WIDTH / BASIS_TILE)];
	uint8_t pixels[HEIGHT * WIDTH * 4];
	uint8_t person[HEIGHT][WIDTH]; /* truth: which body covers a pixel, from 1 on; 0: none */
	float empty[HEIGHT][WIDTH][3]; /* light of the place without people */
	double drawn_for[3];	       /* the lamp, glow and warm of empty */
	float light[HEIGHT][WIDTH][3]; /* of this frame */
	double exposure[3];
	double lamp; /* strength of a lamp in the east */
	double glow; /* of a red lamp close above the object's place, which the dome does not see */
	/* how much redder the light becomes to the east, which the fisheye does not see */
	double warm;
	struct chance chance;
	float normal[NORMALS]; /* normal deviates, from which each row takes a stretch */
	struct transfer_tables tables;
	struct people *people;
	struct people_object object;
	int64_t now_ns;
	struct picture picture;
};

static double texture(double x, double y, double scale)
{
	return sin(x * scale * 3.1 + sin(y * scale * 2.3)) * sin(y * scale * 4.7);
}

/* A camera so high above the ground looks at the origin from 4 m; the object is a box of 0.6 m
 * there, which the picture of the place does not show. */
static struct place *place_begin_from(double eye_m)
{
	struct place *p = calloc(1, sizeof(*p));
	const double eye[3] = {0, -4, eye_m}, target[3] = {0, 0, 0.3};
	struct people_settings settings = {.width = WIDTH, .height = HEIGHT, .curve = srgb};
	static const struct basis_footprint foot = {
		.corner = {-0.3f, -0.3f}, .side = 0.6f, .row = {1}};

	assert_non_null(p);
	assert_int_equal(dome_create(&p->dome, 2, NULL), 0);
	assert_int_equal(tsai_look_at(&p->camera, WIDTH, HEIGHT, eye, target, 60, NULL), 0);
	p->radiance = calloc((size_t)p->dome.count, sizeof(*p->radiance));
	assert_non_null(p->radiance);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const double px[2] = {x + 0.5, y + 0.5};
			double origin[3], dir[3], t;

			assert_int_equal(tsai_ray(&p->camera, px, origin, dir), 0);
			t = dir[2] < -0.05 ? -origin[2] / dir[2] : 30;
			p->ground[y][x][0] = origin[0] + t * dir[0];
			p->ground[y][x][1] = origin[1] + t * dir[1];
			for (int c = 0; c < 3; c++)
				p->floor[y][x][c] = 0.35 + 0.05 * c +
						    0.12 * texture(p->ground[y][x][0],
								   p->ground[y][x][1], 4);
		}
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			/* The front of the box, and its top as seen from above. */
			const double top[3] = {0.3, -0.3, 0.6}, low[3] = {-0.3, -0.3, 0};
			double a[2], b[2];

			assert_int_equal(tsai_project(&p->camera, top, a), 0);
			assert_int_equal(tsai_project(&p->camera, low, b), 0);
			if (x > b[0] && x < a[0] && y > a[1] - 8 && y < b[1]) {
				p->coverage[y * WIDTH + x] = 65535;
				p->touched[y / BASIS_TILE * (WIDTH / BASIS_TILE) + x / BASIS_TILE] =
					1;
			}
		}
	settings.dome = &p->dome;
	assert_int_equal(people_create(&p->people, &settings, NULL), 0);
	p->object = (struct people_object){.foot = &foot,
					   .coverage = p->coverage,
					   .touched = p->touched,
					   .camera = &p->camera};
	people_place(p->people, &p->object);
	p->chance = chance_begin("people");
	for (int n = 0; n < NORMALS; n++)
		p->normal[n] = (float)chance_normal(&p->chance);
	transfer_tables_fill(&p->tables, &srgb);
	p->drawn_for[0] = -1; /* nothing is drawn yet */
	for (int c = 0; c < 3; c++)
		p->exposure[c] = 1;
	p->picture = (struct picture){p->pixels, 4, 4 * WIDTH, WIDTH, HEIGHT};
	return p;
}

static struct place *place_begin(void)
{
	return place_begin_from(1.6);
}

static void place_end(struct place *p)
{
	people_destroy(p->people);
	dome_free(&p->dome);
	free(p->radiance);
	free(p);
}

/* Light on the ground: even, and a lamp near the east wall that is stronger there. */
static double irradiance(const struct place *p, int y, int x)
{
	return 1 + p->lamp / (1 + pow(p->ground[y][x][0] - 3, 2) / 4);
}

static double glow_at(const struct place *p, const double *at, int c)
{
	static const double colour[3] = {1, 0.3, 0.1};

	return p->glow * colour[c] * exp(-(at[0] * at[0] + at[1] * at[1]) / 0.5);
}

static void light_dome(struct place *p)
{
	for (int i = 0; i < p->dome.count; i++) {
		const bool east = p->dome.direction[i][0] > 0.7;

		for (int c = 0; c < 3; c++)
			p->radiance[i][c] = (float)(0.32 + (east ? 1.2 * p->lamp : 0));
	}
}

/* Light of the empty place, which is drawn again where it has changed. */
static void light_floor(struct place *p)
{
	const double lights[3] = {p->lamp, p->glow, p->warm};

	if (memcmp(lights, p->drawn_for, sizeof(lights)) == 0)
		return;
	memcpy(p->drawn_for, lights, sizeof(lights));
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const double *at = p->ground[y][x], even = irradiance(p, y, x);
			const double warm = 1 + p->warm * fmin(fmax(at[0], -1), 1);

			for (int c = 0; c < 3; c++)
				p->empty[y][x][c] = (float)(p->floor[y][x][c] *
							    (even + glow_at(p, at, c)) *
							    (c == 0 ? warm : 1));
		}
}

static void cast_shadow(struct place *p, const struct body *b)
{
	for (int y = 0; b->shadow && y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const double *at = p->ground[y][x], along = at[0] - b->x;
			const double across = (at[1] - b->y) / (0.5 * b->width);

			if (along <= 0 || along >= 1.2 || fabs(across) > 4)
				continue;
			for (int c = 0; c < 3; c++)
				p->light[y][x][c] *= (float)(1 - 0.5 * exp(-across * across) *
									 (1 - along / 1.2));
		}
}

/* u, v: across half of the body's width, and up its height. */
static bool is_like_floor(const struct body *b, double u, double v)
{
	return (b->knees && v > 0.3 && v < 0.5) ||
	       (b->neck && v > 0.81 + 0.15 * u && v < 0.92 + 0.15 * u);
}

static void draw_body(struct place *p, const struct body *b, int number)
{
	const double low[3] = {b->x, b->y, 0}, high[3] = {b->x, b->y, b->height};
	const double side[3] = {b->x + b->width / 2, b->y, b->height / 2};
	double foot[2], head[2], edge[2];

	if (tsai_project(&p->camera, low, foot) || tsai_project(&p->camera, high, head) ||
	    tsai_project(&p->camera, side, edge))
		return;
	for (int y = 0; y < HEIGHT; y++) {
		const double v = (foot[1] - y - 0.5) / (foot[1] - head[1]);
		const double half = 0.6 + 0.4 * sin(M_PI * v);

		for (int x = 0; v >= 0 && v <= 1 && x < WIDTH; x++) {
			const double u = (x + 0.5 - foot[0]) / (edge[0] - foot[0]);
			double cloth;

			if (fabs(u) > half)
				continue;
			cloth = 1 + 0.3 * texture(u, v, 6);
			p->person[y][x] = (uint8_t)number;
			for (int c = 0; c < 3 && !is_like_floor(b, u, v); c++)
				p->light[y][x][c] =
					(float)(b->colour[c] * (1 + p->lamp * 0.3) * cloth);
		}
	}
}

/* Writes what the camera makes of the light. */
static void expose(struct place *p)
{
	for (int y = 0; y < HEIGHT; y++) {
		const int stretch = chance_int(&p->chance, 0, NORMALS - 1);

		for (int x = 0; x < WIDTH; x++)
			for (int c = 0; c < 3; c++) {
				const float lit = p->light[y][x][c] * (float)p->exposure[c];
				const float noisy =
					lit + NOISE * sqrtf(0.05f + lit) *
						      p->normal[(stretch + 3 * x + c) % NORMALS];
				const float code = noisy < 0   ? 0
						   : noisy > 1 ? 65535
							       : 65535 * noisy;

				p->pixels[4 * (y * WIDTH + x) + 2 - c] =
					p->tables.encode[(int)(code + 0.5f)];
			}
	}
}

/* Writes the frame with these bodies, the nearest last. */
static void place_expose(struct place *p, const struct body *bodies, int count)
{
	light_floor(p);
	memcpy(p->light, p->empty, sizeof(p->light));
	memset(p->person, 0, sizeof(p->person));
	for (int n = 0; n < count; n++)
		cast_shadow(p, &bodies[n]);
	for (int n = 0; n < count; n++)
		draw_body(p, &bodies[n], n + 1);
	expose(p);
}

static void look_at_pixels(struct place *p)
{
	light_dome(p);
	p->now_ns += PERIOD;
	people_look(p->people, &p->picture, (const float(*)[3])p->radiance, p->now_ns);
}

static void place_look(struct place *p, const struct body *bodies, int count)
{
	place_expose(p, bodies, count);
	look_at_pixels(p);
}

/* Looks at the empty place in its first light, whose pictures all tests share. */
static void learn(struct place *p)
{
	static uint8_t pixels[LEARNING][sizeof(p->pixels)];
	static bool are_drawn;

	for (int n = 0; n < LEARNING; n++) {
		if (!are_drawn) {
			place_expose(p, NULL, 0);
			memcpy(pixels[n], p->pixels, sizeof(p->pixels));
		}
		memcpy(p->pixels, pixels[n], sizeof(p->pixels));
		look_at_pixels(p);
	}
	are_drawn = true;
}

static struct place *place_learned(void)
{
	struct place *p = place_begin();

	learn(p);
	return p;
}

/* Share of the object's pixels in which `anybody` is wrong. */
static double wrong_share(const struct place *p)
{
	const struct veil *veil = people_veil(p->people);
	int wrong = 0, all = 0;

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const int t = y / BASIS_TILE * (WIDTH / BASIS_TILE) + x / BASIS_TILE;

			if (!p->touched[t])
				continue;
			all++;
			wrong += (veil && veil->tile[t] && veil->anybody[y * WIDTH + x] > 127) !=
				 (p->person[y][x] > 0);
		}
	return (double)wrong / all;
}

static struct body walker(double x, double y)
{
	return (struct body){x, y, 0.5, 1.7, {0.5, 0.15, 0.1}, .shadow = true};
}

TEST("a picture too small is said")
{
	const struct people_settings settings = {.width = 640, .height = 7};
	struct people *people;
	struct fault fault = {.text = ""};

	assert_int_equal(people_create(&people, &settings, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "in 640x7 pixels, expected at least 8x8"));
}

TEST("nobody is found where nobody is")
{
	struct place *p = place_begin();

	place_look(p, NULL, 0);
	assert_true(people_report(p->people).learned == 0);
	learn(p);
	expect_above(people_report(p->people).learned, 0.98, "after %d frames", LEARNING);
	for (int n = 0; n < 60; n++) {
		p->lamp = n < 20 ? 0 : n < 40 ? 0.8 : 0.3; /* switched, within one frame */
		p->exposure[0] = n < 30 ? 1 : 0.8;
		p->exposure[1] = p->exposure[2] = n < 30 ? 1 : 0.85;
		place_look(p, NULL, 0);
		expect_at_most(wrong_share(p), 0.01, "frame %d", n);
	}
	place_end(p);
}

/* Its colour is nothing's that the place has, but it fades, and who stands there ends. */
TEST("light that the dome does not see is nobody")
{
	struct place *p = place_learned();

	for (int n = 0; n < 30; n++) {
		p->glow = n % 15 < 5 ? 0.8 : 0;
		place_look(p, NULL, 0);
		assert_int_equal(people_report(p->people).parts, 0);
	}
	place_end(p);
}

TEST("somebody who passes is found in order")
{
	struct place *p = place_learned();
	double sum = 0;
	int frames = 0;

	for (int front = 0; front < 2; front++)
		for (int n = 0; n < 60; n++) {
			const struct body b = walker(-1.5 + 0.05 * n, front ? -1 : 1);
			struct people_report seen;

			p->lamp = n < 30 ? 0 : 0.5;
			place_look(p, &b, 1);
			seen = people_report(p->people);
			sum += wrong_share(p);
			frames++;
			if (fabs(b.x) > 0.3)
				continue;
			expect_above(seen.parts, 0, "frame %d, in front: %d", n, front);
			expect_equal(seen.in_front, front ? seen.parts : 0,
				     "frame %d, in front: %d", n, front);
		}
	print_message("# wrong pixels: %.4f of the object's tiles\n", sum / frames);
	assert_true(sum / frames < 0.03);
	place_end(p);
}

/* Cells that the edge cuts, and the shadow at the feet, make nobody wider. */
TEST("an outline is neither wide nor narrow")
{
	struct place *p = place_learned();
	int found = 0, there = 0;

	for (int n = 0; n < 30; n++) {
		struct body b = walker(-0.4 + 0.02 * n, -0.5);
		const struct veil *veil;

		b.width = 0.25;
		place_look(p, &b, 1);
		veil = people_veil(p->people);
		assert_non_null(veil);
		for (int at = 0; at < WIDTH * HEIGHT; at++) {
			const int t = at / WIDTH / BASIS_TILE * (WIDTH / BASIS_TILE) +
				      at % WIDTH / BASIS_TILE;

			there += p->touched[t] && p->person[at / WIDTH][at % WIDTH] > 0;
			found += p->touched[t] && veil->tile[t] && veil->anybody[at] > 127;
		}
	}
	print_message("# found: %d of %d pixels\n", found, there);
	expect_at_most(fabs(found / (double)there - 1), 0.02, "%d of %d pixels", found, there);
	place_end(p);
}

TEST("somebody who stands still is not learned")
{
	struct place *p = place_learned();

	for (int n = 0; n < (thorough() ? 600 : 200); n++) {
		const struct body b = walker(0.1, -1);

		place_look(p, &b, 1);
	}
	assert_int_equal(people_report(p->people).in_front, 1);
	expect_at_most(wrong_share(p), 0.03, "after standing");
	place_look(p, NULL, 0);
	place_look(p, NULL, 0);
	expect_at_most(wrong_share(p), 0.01, "after leaving");
	place_end(p);
}

static void ghost_goes(double exposure)
{
	struct place *p = place_begin();
	const struct body b = walker(0.1, -1);

	for (int n = 0; n < LEARNING; n++)
		place_look(p, &b, 1); /* is taken for the place */
	for (int c = 0; c < 3; c++)
		p->exposure[c] = exposure;
	for (int n = 0; n < 5; n++)
		place_look(p, NULL, 0);
	expect_at_most(wrong_share(p), 0.02, "five frames after leaving, exposure %g", exposure);
	place_end(p);
}

TEST("a ghost goes")
{
	ghost_goes(1);
	ghost_goes(0.4);
	ghost_goes(1.4);
}

TEST("exposure is followed")
{
	struct place *p = place_learned();

	p->exposure[0] = 0.7;
	p->exposure[1] = 1.2;
	place_look(p, NULL, 0);
	place_look(p, NULL, 0);
	for (int c = 0; c < 3; c++)
		expect_below(fabs(people_report(p->people).gain[c] / p->exposure[c] - 1), 0.01,
			     "channel %d", c);
	p->lamp = 0.5; /* light, which both eyes see */
	place_look(p, NULL, 0);
	for (int c = 0; c < 3; c++)
		expect_below(fabs(people_report(p->people).gain[c] / p->exposure[c] - 1), 0.15,
			     "channel %d", c);
	place_end(p);
}

TEST("an exposure that lasts becomes the place's")
{
	struct place *p = place_learned();

	for (int c = 0; c < 3; c++)
		p->exposure[c] = 1.2;
	for (int n = 0; n < 240; n++)
		place_look(p, NULL, 0);
	for (int c = 0; c < 3; c++)
		expect_below(people_report(p->people).gain[c], 1.15, "channel %d", c);
	expect_at_most(wrong_share(p), 0.01, "meanwhile");
	place_end(p);
}

/* Saves what was learned, part by part; *bytes: its length. The caller frees it. */
static uint8_t *save(const struct people *people, size_t *bytes)
{
	size_t done = 0;
	uint8_t *saved;

	*bytes = people_saved_bytes(people);
	saved = malloc(*bytes);
	assert_non_null(saved);
	for (int parts = 0; done < *bytes; parts++) {
		const size_t before = done;

		done = people_save(people, saved, done);
		assert_true(done > before && parts < 1000);
	}
	assert_int_equal(done, *bytes);
	people_seal(saved, *bytes);
	return saved;
}

TEST("what was learned survives")
{
	struct place *p = place_learned();
	struct fault fault = {.text = ""};
	uint8_t *saved;
	size_t bytes;

	saved = save(p->people, &bytes);
	people_forget(p->people);
	place_look(p, NULL, 0);
	assert_true(people_report(p->people).learned < 0.5);
	for (size_t at = 0; at < bytes; at += 1 + bytes / 50) {
		saved[at] ^= 4;
		assert_int_equal(people_restore(p->people, saved, bytes, &fault), -EBADMSG);
		saved[at] ^= 4;
	}
	assert_int_equal(people_restore(p->people, saved, bytes - 1, &fault), -EBADMSG);
	assert_int_equal(people_restore(p->people, saved, 3, &fault), -EBADMSG);
	expect_success(people_restore(p->people, saved, bytes, &fault), &fault);
	place_look(p, NULL, 0);
	expect_above(people_report(p->people).learned, 0.98, "restored");
	expect_at_most(wrong_share(p), 0.01, "restored");
	free(saved);
	place_end(p);
}

TEST("learn and forget act at once")
{
	struct place *p = place_begin();

	people_learn(p->people);
	place_look(p, NULL, 0);
	expect_equal(people_report(p->people).learned, 1, "after learn");
	people_forget(p->people);
	place_look(p, NULL, 0);
	expect_equal(people_report(p->people).learned, 0, "after forget");
	place_end(p);
}

TEST("nobody is reported in the dark")
{
	struct place *p = place_learned();
	const struct body b = walker(0.1, -1);

	place_look(p, &b, 1);
	assert_true(people_report(p->people).parts > 0);
	memset(p->radiance, 0, (size_t)p->dome.count * sizeof(*p->radiance));
	people_look(p->people, &p->picture, (const float(*)[3])p->radiance, p->now_ns + PERIOD);
	assert_null(people_veil(p->people));
	assert_int_equal(people_report(p->people).parts, 0);
	assert_int_equal(people_report(p->people).in_front, 0);
	place_end(p);
}

TEST("somebody who hides everything is not learned")
{
	struct place *p = place_learned();
	const struct body b = {0, -2, 1.6, 1.9, {0.5, 0.15, 0.1}, .shadow = false};

	for (int n = 0; n < (thorough() ? 300 : 100); n++) {
		const struct body comes = walker(-3 + 0.1 * n, -2);

		place_look(p, n < 30 ? &comes : &b, 1);
	}
	expect_at_most(wrong_share(p), 0.03, "after standing");
	/* Who is as wide as two may be taken for two. */
	expect_above(people_report(p->people).in_front, 0, "after standing");
	place_look(p, NULL, 0);
	place_look(p, NULL, 0);
	expect_at_most(wrong_share(p), 0.01, "after leaving");
	place_end(p);
}

/* Light changes while somebody stands there: the ground that he hid is known when it comes back. */
TEST("hidden ground follows its surroundings")
{
	struct place *p = place_learned();
	const struct body b = walker(0.3, -0.7);

	for (int n = 0; n < 90; n++) {
		p->warm = 0.7 * n / 90;
		place_look(p, &b, 1);
	}
	place_look(p, NULL, 0);
	place_look(p, NULL, 0);
	print_message("# wrong pixels: %.4f\n", wrong_share(p));
	expect_at_most(wrong_share(p), 0.01, "after leaving");
	place_end(p);
}

static void cross(struct place *p, bool knees, bool neck)
{
	for (int n = 0; n < 12; n++) {
		struct body b = walker(-0.2 + 0.03 * n, -0.7);
		struct people_report seen;

		b.knees = knees;
		b.neck = neck;
		b.height = neck ? 0.9 : b.height;
		place_look(p, &b, 1);
		seen = people_report(p->people);
		expect_equal(seen.parts, 1, "frame %d", n);
		expect_equal(seen.in_front, 1, "frame %d", n);
	}
	place_end(p);
}

TEST("a body keeps the order of its feet")
{
	cross(place_learned(), true, false);
}

TEST("a head beside a shoulder is of the same body")
{
	cross(place_learned(), false, true);
}

TEST("somebody cut by the lower edge is in front")
{
	static const struct basis_footprint foot = {
		.corner = {-0.3f, -3.9f}, .side = 0.2f, .row = {7}};
	struct place *p = place_begin();

	memset(p->touched, 1, sizeof(p->touched));
	p->object.foot = &foot;
	people_place(p->people, &p->object);
	learn(p);
	for (int n = 0; n < 20; n++) {
		const struct body b = walker(-0.2 + 0.02 * n, -3);

		place_look(p, &b, 1);
		expect_equal(people_report(p->people).in_front, 1, "frame %d", n);
		for (int x = 0; x < WIDTH; x++)
			if (x > 1 && x < WIDTH - 2 && p->person[HEIGHT - 1][x - 2] &&
			    p->person[HEIGHT - 1][x + 2])
				expect_equal(
					people_veil(p->people)->front[(HEIGHT - 1) * WIDTH + x],
					255, "frame %d, column %d", n, x);
	}
	place_end(p);
}

/* ---- several, and their order ---- */

/* A place that is watched, and known, everywhere. */
static struct place *place_of_several(double eye_m)
{
	struct place *p = place_begin_from(eye_m);

	memset(p->touched, 1, sizeof(p->touched));
	people_place(p->people, &p->object);
	people_learn(p->people);
	for (int n = 0; n < 10; n++)
		place_look(p, NULL, 0);
	return p;
}

/* Share of the pixels of two bodies in which not the second alone is in front. */
static double misordered(const struct place *p)
{
	const struct veil *veil = people_veil(p->people);
	int wrong = 0, all = 0;

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			all += p->person[y][x] > 0;
			wrong += p->person[y][x] > 0 &&
				 (veil->front[y * WIDTH + x] > 127) != (p->person[y][x] == 2);
		}
	return (double)wrong / all;
}

/* Whether two bodies touch in the picture, and so are one group. */
static bool are_joined(const struct place *p)
{
	bool joined = false;

	for (int y = 1; y < HEIGHT; y++)
		for (int x = 1; x < WIDTH; x++)
			joined |= p->person[y][x] + p->person[y][x - 1] == 3 ||
				  p->person[y][x] + p->person[y - 1][x] == 3;
	return joined;
}

/* Looks at a frame of a body behind the object and one before it, each of whom is in his order. */
static void see_both(struct place *p, const struct body both[2], int n)
{
	struct people_report seen;

	place_look(p, both, 2);
	seen = people_report(p->people);
	expect_equal(seen.parts, 2, "frame %d", n);
	expect_equal(seen.in_front, 1, "frame %d", n);
}

TEST("two who meet before and behind the object keep each his order")
{
	struct place *p = place_of_several(1.6);

	for (int n = 0; n < 40; n++) {
		const double off = 0.05 + 0.05 * (n < 15 ? 15 - n : n < 25 ? 0 : n - 25);
		struct body both[] = {walker(0.24 + off, 1), walker(-0.07 - off, -1)};

		both[1].width = 0.3; /* so wide in the picture as the other */
		see_both(p, both, n);
		if (n < 10 || n > 30)
			expect_at_most(misordered(p), 0.01, "frame %d", n);
		if (n > 15 && n < 25)
			assert_true(are_joined(p));
	}
	place_end(p);
}

/* The near one's head hides the far one's feet. */
TEST("one above another is another")
{
	struct place *p = place_of_several(3.2);

	for (int n = 0; n < 25; n++) {
		const double off = n < 15 ? 0.08 * (15 - n) : 0;
		const struct body both[] = {walker(off, 1.5), walker(-off, -1)};

		see_both(p, both, n);
		expect_at_most(misordered(p), 0.1, "frame %d", n);
	}
	assert_true(are_joined(p));
	place_end(p);
}

/* Somebody near hides, or takes the place of, somebody far: his order is that of his own feet, and
 * that at once. */
TEST("somebody whose feet are suddenly much nearer is another")
{
	struct place *p = place_of_several(1.6);
	const struct body far = walker(0.1, 1.5), near = walker(0.05, -1);

	for (int n = 0; n < 10; n++)
		place_look(p, &far, 1);
	expect_equal(people_report(p->people).in_front, 0, "the far one");
	for (int n = 0; n < 3; n++) {
		place_look(p, &near, 1);
		expect_equal(people_report(p->people).in_front, 1, "frame %d of the near one", n);
	}
	place_end(p);
}

/* Somebody passes before somebody who stands behind the object: one order for both would be wrong
 * for a third of their pixels. */
TEST("a group has the orders of its members")
{
	struct place *p = place_of_several(1.6);
	double sum = 0;
	int frames = 0;

	for (int n = 0; n < 40; n++) {
		const double x = -1 + 0.05 * n;
		const struct body both[] = {walker(0.1, 1.2), walker(x, -1)};

		place_look(p, both, 2);
		if (!are_joined(p))
			continue;
		sum += misordered(p);
		frames++;
	}
	expect_at_most(sum / frames, 0.15, "pixels out of order, in %d frames", frames);
	place_end(p);
}

/* The far side of the object is at 0.3 m, where a cell's height is 0.08 m of ground. */
TEST("feet that jitter across the border do not change the order")
{
	struct place *p = place_of_several(1.6);

	for (int front = 0; front < 2; front++) {
		for (int n = 0; n < 40; n++) {
			const double x = -1.2 + 0.06 * n, beside = front ? 0 : 0.6;
			const double jitter = n % 6 < 3 ? 0.22 : 0.38;
			const struct body b = walker(x, fabs(x) < 0.5 ? jitter : beside);

			place_look(p, &b, 1);
			expect_equal(people_report(p->people).parts, 1, "frame %d", n);
			expect_equal(people_report(p->people).in_front, front, "frame %d", n);
		}
		for (int n = 0; n < 4; n++) { /* longer than anybody is missed */
			p->now_ns += 500000000;
			place_look(p, NULL, 0);
		}
	}
	place_end(p);
}

TEST("somebody who goes behind the object is behind it soon")
{
	struct place *p = place_of_several(1.6);

	for (int n = 0; n < 40; n++) {
		const struct body b = walker(0.2, -0.8 + 0.05 * n);

		place_look(p, &b, 1);
		if (b.y < 0.3 || b.y > 0.9)
			expect_equal(people_report(p->people).in_front, b.y < 0.3, "at %g m", b.y);
	}
	place_end(p);
}

TEST("another place is refused")
{
	struct place *p = place_begin();
	struct people_settings settings = {.width = WIDTH, .height = HEIGHT, .curve = srgb};
	struct people *other = NULL;
	struct dome finer;
	uint8_t *saved;
	size_t bytes;

	place_look(p, NULL, 0);
	saved = save(p->people, &bytes);
	assert_int_equal(dome_create(&finer, 3, NULL), 0);
	for (int n = 0; n < 5; n++) {
		settings.dome = n == 0 ? &finer : &p->dome;
		settings.curve.named = n == 1 ? TRANSFER_LINEAR : TRANSFER_SRGB;
		settings.width = n == 2 ? WIDTH - 1 : WIDTH; /* of as many cells */
		settings.camera = n == 3 ? "another" : NULL;
		settings.calibration = n == 4 ? "moved" : NULL;
		assert_int_equal(people_create(&other, &settings, NULL), 0);
		expect_equal(people_restore(other, saved, bytes, NULL), -EBADMSG, "case %d", n);
		people_destroy(other);
	}
	dome_free(&finer);
	free(saved);
	place_end(p);
}

/* Somebody stands where the object is, which goes elsewhere; meanwhile he goes. Where it comes back
 * nobody is, from the first look on; and a second look at a frame, as after a pose has come, tells
 * the same. */
TEST("cells that come back are judged anew")
{
	struct place *p = place_learned();
	static uint8_t elsewhere[sizeof(p->touched)] = {[0] = 1};
	struct people_object object = {.camera = &p->camera};
	const struct body b = walker(0.1, -1);

	for (int n = 0; n < 5; n++)
		place_look(p, &b, 1);
	expect_equal(people_report(p->people).parts, 1, "while he is there");
	object.coverage = p->coverage;
	object.touched = elsewhere;
	people_place(p->people, &object);
	for (int n = 0; n < 5; n++)
		place_look(p, NULL, 0);
	object.touched = p->touched;
	people_place(p->people, &object);
	place_look(p, NULL, 0);
	expect_equal(people_report(p->people).parts, 0, "back again");
	assert_null(people_veil(p->people));
	people_look(p->people, &p->picture, (const float(*)[3])p->radiance, p->now_ns);
	assert_null(people_veil(p->people));
	place_end(p);
}

/* Looks as somebody stands before the object; whether anybody is seen at x from first on, and
 * before. */
static void see_sides(struct place *p, int first, bool *before, bool *after)
{
	const struct body body = walker(0, -1);
	const struct veil *veil;

	for (int n = 0; n < 10; n++)
		place_look(p, &body, 1);
	veil = people_veil(p->people);
	*before = *after = false;
	for (int y = 0; veil && y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			if (veil->tile[y / BASIS_TILE * (WIDTH / BASIS_TILE) + x / BASIS_TILE] &&
			    veil->anybody[y * WIDTH + x])
				*(x < first ? before : after) = true;
}

TEST("nobody is looked for in a mask")
{
	struct place *p = place_begin();
	uint8_t *shown = calloc(WIDTH * HEIGHT, 1);
	bool left, right;

	assert_non_null(shown);
	learn(p);
	see_sides(p, WIDTH / 2, &left, &right);
	assert_true(left && right);

	for (int at = 0; at < WIDTH * HEIGHT; at++)
		shown[at] = at % WIDTH < WIDTH / 2;
	p->object.shown = shown;
	people_place(p->people, &p->object);
	see_sides(p, WIDTH / 2, &left, &right);
	assert_true(left);
	assert_false(right);

	memset(shown, 0, WIDTH * HEIGHT);
	people_place(p->people, &p->object);
	see_sides(p, WIDTH / 2, &left, &right);
	assert_false(left || right);
	assert_int_equal(people_report(p->people).parts, 0);
	free(shown);
	place_end(p);
}

/* The noise that is measured is the camera's, also where frames are looked at twice. */
TEST("noise is measured once a frame")
{
	struct sensor_noise_model model[2];

	for (int twice = 0; twice < 2; twice++) {
		struct place *p = place_begin();

		for (int n = 0; n < LEARNING; n++) {
			place_look(p, NULL, 0);
			for (int again = 0; again < 2 * twice; again++)
				people_look(p->people, &p->picture, (const float(*)[3])p->radiance,
					    p->now_ns);
		}
		assert_true(sensor_noise_fit(people_noise(p->people), &model[twice]));
		place_end(p);
	}
	for (int c = 0; c < 3; c++) {
		expect_above(model[0].floor[c] + 0.3 * model[0].slope[c], 0, "channel %d", c);
		expect_equal(model[1].floor[c], model[0].floor[c], "channel %d", c);
		expect_equal(model[1].slope[c], model[0].slope[c], "channel %d", c);
	}
}

/* Looks at the place through a camera that is turned by so many pixels. */
static void look_turned(struct place *p, const struct body *bodies, int count, int right, int down)
{
	static uint8_t was[HEIGHT][WIDTH][4];

	place_expose(p, bodies, count);
	memcpy(was, p->pixels, sizeof(was));
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const int u = x - right, v = y - down;

			if (u >= 0 && v >= 0 && u < WIDTH && v < HEIGHT)
				memcpy(&p->pixels[4 * (y * WIDTH + x)], was[v][u], 4);
		}
	look_at_pixels(p);
}

TEST("the place moves along with a camera that is nudged a little")
{
	struct place *p = place_learned();
	const struct body b = walker(0.3, -1);
	double right, down;
	uint8_t *saved;
	size_t bytes;

	for (int n = 0; n < 150; n++) {
		p->lamp = n < 30 || n > 60 ? 0 : 0.5; /* a lamp moves nothing */
		look_turned(p, &b, 1, 0, 0);
	}
	right = people_report(p->people).moved_px[0];
	expect_below(fabs(right), 0.3, "right, of nothing");
	for (int n = 0; n < 60; n++)
		look_turned(p, NULL, 0, -2, 2);
	right = people_report(p->people).moved_px[0];
	down = people_report(p->people).moved_px[1];
	expect_below(fabs(right + 2), 0.3, "right: %g", right);
	expect_below(fabs(down - 2), 0.3, "down: %g", down);
	assert_false(people_report(p->people).lost);
	expect_at_most(wrong_share(p), 0.005, "when the place has moved along");
	saved = save(p->people, &bytes);
	people_forget(p->people);
	expect_success(people_restore(p->people, saved, bytes, NULL), NULL);
	free(saved);
	for (int n = 0; n < 60; n++)
		look_turned(p, NULL, 0, -2, 2);
	expect_below(fabs(people_report(p->people).moved_px[0] - right), 0.3, "right, as saved");
	place_end(p);
}

TEST("people are left alone until a camera that is nudged far is back, or the place learned anew")
{
	struct place *p = place_learned();
	const struct body b = walker(0.1, -1);

	for (int n = 0; n < 60; n++)
		look_turned(p, NULL, 0, 8, -4);
	assert_true(people_report(p->people).lost);
	expect_below(fabs(people_report(p->people).moved_px[0] - 8), 0.5, "right");
	expect_below(fabs(people_report(p->people).moved_px[1] + 4), 0.5, "down");
	look_turned(p, &b, 1, 8, -4);
	assert_null(people_veil(p->people));
	for (int n = 0; n < 60; n++)
		look_turned(p, NULL, 0, 0, 0);
	assert_false(people_report(p->people).lost);
	place_look(p, &b, 1);
	assert_int_equal(people_report(p->people).in_front, 1);
	for (int n = 0; n < 60; n++)
		look_turned(p, NULL, 0, 8, -4);
	people_learn(p->people);
	look_turned(p, NULL, 0, 8, -4);
	assert_false(people_report(p->people).lost);
	look_turned(p, &b, 1, 8, -4);
	assert_non_null(people_veil(p->people));
	place_end(p);
}

/* Share of the object that people hide. */
static double hidden_share(const struct place *p)
{
	const struct veil *veil = people_veil(p->people);
	int hidden = 0, all = 0;

	for (int at = 0; at < WIDTH * HEIGHT; at++) {
		const int t = at / WIDTH / BASIS_TILE * (WIDTH / BASIS_TILE) +
			      at % WIDTH / BASIS_TILE;

		all += p->coverage[at] > 0;
		hidden += p->coverage[at] && veil && veil->tile[t] && veil->front[at] > 127;
	}
	return (double)hidden / all;
}

/* Another floor is laid: what is not recognized hides nothing, but who walks. */
TEST("in a place that is not recognized only who moves is in front")
{
	struct place *p = place_learned();
	double sure = 1;

	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			for (int c = 0; c < 3; c++)
				p->floor[y][x][c] = 0.4 + 0.35 * texture(p->ground[y][x][1] + c,
									 p->ground[y][x][0], 5);
	p->drawn_for[0] = -1;
	for (int n = 0; n < 30; n++) {
		place_look(p, NULL, 0);
		sure = fmin(sure, people_report(p->people).sure);
		if (n >= 15) /* half a second, in which all patches are asked */
			expect_equal(hidden_share(p) > 0, 0, "frame %d", n);
	}
	expect_below(sure, PEOPLE_SURE_LEAST, "sure");
	place_end(p);
}
