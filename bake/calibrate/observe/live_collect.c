/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/live_collect.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/live_screen.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

#define FRAME_MS 2000
#define STILL_NS (NS_PER_S / 2)
#define STILL 0.004 /* of the picture's width: movement that counts as a still hand */
/* of the width: boards nearer than this are in the same place, unless reshaped */
#define APART 0.05
#define RESHAPED 0.045	  /* of a board's extent: the change of shape from a tilt by 25 degrees */
#define FORESHORTENED 0.9 /* ratio of scales of a board tilted by 25 degrees */
#define TILTS 2
#define ENOUGH_VIEWS 4

struct collecting {
	struct board *board;
	const struct collect_settings *settings;
	struct observations *all;
	int first; /* index of the first collected view in all */
	struct image *picture;
	int count;
	struct live_screen screen;
	bool has_screen;
	char said[128]; /* last text in the log */
	bool covered[COVER_ROWS][COVER_COLUMNS];
	int tilts;
	struct observations held; /* position of the board since held_ns */
	int64_t held_ns, taken_ns;
};

/* ---- places ---- */

/* The points of one picture. */
struct points {
	const struct observation *point;
	int count;
};

static struct points points_of(const struct observations *seen)
{
	return (struct points){seen->point, seen->count};
}

/* Difference of two pictures of the board. Infinite where they share fewer than half of the
 * points. */
struct view_difference {
	double moved; /* mean distance between the same points, px */
	/* residual of the best similarity (shift, rotation, scale), relative to the board's
	 * extent */
	double reshaped;
};

/* Sums over the points in both pictures, as complex numbers p and q. */
struct pairs {
	int count;
	double distance, p[2], q[2];
	double pp, qq, pq[2]; /* |p|^2, |q|^2, conj(p) q */
};

static void add_pair(struct pairs *sum, const double p[2], const double q[2])
{
	sum->count++;
	sum->distance += hypot(p[0] - q[0], p[1] - q[1]);
	for (int k = 0; k < 2; k++) {
		sum->p[k] += p[k];
		sum->q[k] += q[k];
		sum->pp += p[k] * p[k];
		sum->qq += q[k] * q[k];
	}
	sum->pq[0] += p[0] * q[0] + p[1] * q[1];
	sum->pq[1] += p[0] * q[1] - p[1] * q[0];
}

/*
 * Least squares of the similarity q = s p, both from their means, leave a share of q:
 *     sqrt(1 - |cov(p, q)|^2 / (var(p) var(q)))
 */
static double reshaped_share(const struct pairs *sum)
{
	const double n = sum->count, *p = sum->p, *q = sum->q;
	const double pp = sum->pp - (p[0] * p[0] + p[1] * p[1]) / n;
	const double qq = sum->qq - (q[0] * q[0] + q[1] * q[1]) / n;
	const double even = sum->pq[0] - (p[0] * q[0] + p[1] * q[1]) / n;
	const double turned = sum->pq[1] - (p[0] * q[1] - p[1] * q[0]) / n;

	return pp > 0 && qq > 0 ? sqrt(fmax(0, 1 - (even * even + turned * turned) / (pp * qq)))
				: 0;
}

static struct view_difference find_difference(struct points a, struct points b)
{
	const int most = a.count > b.count ? a.count : b.count;
	struct pairs sum = {.count = 0};

	for (int i = 0; i < a.count; i++)
		for (int j = 0; j < b.count; j++)
			if (!memcmp(a.point[i].world, b.point[j].world, sizeof(a.point[i].world)))
				add_pair(&sum, a.point[i].px, b.point[j].px);
	if (!sum.count || 2 * sum.count < most)
		return (struct view_difference){INFINITY, INFINITY};
	return (struct view_difference){sum.distance / sum.count, reshaped_share(&sum)};
}

static bool is_new_place(const struct collecting *c, const struct observations *now)
{
	for (int v = c->first; v < c->all->views; v++) {
		const struct observed_view *view = &c->all->view[v];
		const struct points taken = {c->all->point + view->first, view->count};
		const struct view_difference d = find_difference(taken, points_of(now));

		if (d.moved < APART * now->width && d.reshaped < RESHAPED)
			return false;
	}
	return true;
}

/* Ratio of the smallest to the largest scale of the board in the picture (an affine fit): 1 where
 * board and picture are parallel. */
static double foreshortening_of(const struct observations *now)
{
	double mean[4] = {0}, s[3] = {0}, t[2][2] = {{0}}, a[4], det, p, q;

	for (int i = 0; i < now->count; i++)
		for (int k = 0; k < 4; k++)
			mean[k] += (k < 2 ? now->point[i].world[k] : now->point[i].px[k - 2]) /
				   now->count;
	for (int i = 0; i < now->count; i++) {
		const double x = now->point[i].world[0] - mean[0];
		const double y = now->point[i].world[1] - mean[1];

		s[0] += x * x;
		s[1] += x * y;
		s[2] += y * y;
		for (int k = 0; k < 2; k++) {
			t[k][0] += x * (now->point[i].px[k] - mean[2 + k]);
			t[k][1] += y * (now->point[i].px[k] - mean[2 + k]);
		}
	}
	det = s[0] * s[2] - s[1] * s[1];
	if (!(det > 0))
		return 1;
	for (int k = 0; k < 2; k++) {
		a[2 * k] = (t[k][0] * s[2] - t[k][1] * s[1]) / det;
		a[2 * k + 1] = (t[k][1] * s[0] - t[k][0] * s[1]) / det;
	}
	/* Singular values of a 2x2 matrix: p + q and |p - q|. */
	p = hypot(a[0] + a[3], a[2] - a[1]);
	q = hypot(a[0] - a[3], a[2] + a[1]);
	return fabs(p - q) / (p + q);
}

static bool is_tilted(const struct observations *now)
{
	return foreshortening_of(now) < FORESHORTENED;
}

static void cover_cells(struct collecting *c, const struct observations *now)
{
	for (int i = 0; i < now->count; i++) {
		const double *px = now->point[i].px;
		const int column = (int)(px[0] / now->width * COVER_COLUMNS);
		const int row = (int)(px[1] / now->height * COVER_ROWS);

		if (column >= 0 && column < COVER_COLUMNS && row >= 0 && row < COVER_ROWS)
			c->covered[row][column] = true;
	}
}

/* ---- what is missing ---- */

/* A round picture does not reach its corners. */
static bool is_beyond(const struct collecting *c, int row, int column)
{
	return c->settings->round && row % (COVER_ROWS - 1) == 0 &&
	       column % (COVER_COLUMNS - 1) == 0;
}

/* Whether the next view is the one that fixes the world. */
static bool is_world_next(const struct collecting *c)
{
	return c->count + 1 == c->settings->world;
}

/* Writes what the person shall do next. False: nothing is missing. */
static bool say_missing(const struct collecting *c, char *text, size_t room)
{
	static const char *const rows[COVER_ROWS] = {"upper", "middle", "lower"};

	if (is_world_next(c)) {
		snprintf(text, room, "%s %s: this view is the world", c->count ? "now" : "first",
			 c->settings->round ? "hold the board level, its rows along world X"
					    : "lay the board on the ground");
		return true;
	}
	for (int r = 0; r < COVER_ROWS; r++)
		for (int k = 0; k < COVER_COLUMNS; k++)
			if (!c->covered[r][k] && !is_beyond(c, r, k)) {
				snprintf(text, room, "%d of %d: show the board at the %s %s",
					 c->count, c->settings->views, rows[r],
					 k < COVER_COLUMNS / 2 ? "left" : "right");
				return true;
			}
	if (c->tilts < TILTS) {
		snprintf(text, room, "%d of %d: tilt the board", c->count, c->settings->views);
		return true;
	}
	snprintf(text, room, "%d of %d: show the board in another place", c->count,
		 c->settings->views);
	return c->count < ENOUGH_VIEWS || c->count < c->settings->world;
}

static bool is_done(const struct collecting *c)
{
	char text[128];

	return c->count >= c->settings->views || !say_missing(c, text, sizeof(text));
}

/* ---- taking ---- */

static int keep_picture(struct collecting *c, const struct image *picture)
{
	struct image *more = realloc(c->picture, (size_t)(c->count + 1) * sizeof(*more));

	if (!more)
		return -ENOMEM;
	c->picture = more;
	if (image_create_u8(&more[c->count], picture->width, picture->height))
		return -ENOMEM;
	memcpy(more[c->count].u8, picture->u8,
	       3 * (size_t)picture->width * (size_t)picture->height);
	c->count++;
	return 0;
}

static int collect_view(struct collecting *c, const struct observations *now,
			const struct image *picture)
{
	int err = observations_begin_view(c->all, now->view[0].name);

	for (int i = 0; !err && i < now->count; i++)
		err = observations_add(c->all, now->point[i].world, now->point[i].px, "%s",
				       now->point[i].name);
	if (!err)
		err = keep_picture(c, picture);
	if (err)
		return err;
	c->all->width = now->width;
	c->all->height = now->height;
	c->tilts += is_tilted(now);
	cover_cells(c, now);
	return 0;
}

static bool has_moved(const struct collecting *c, const struct observations *now)
{
	return !(find_difference(points_of(&c->held), points_of(now)).moved < STILL * now->width);
}

/* Returns whether to take the board that was found as a view, and writes the text for the
 * screen. */
static bool judge_view(struct collecting *c, const struct observations *now, int64_t captured_ns,
		       char *text, size_t room)
{
	bool still;

	if (has_moved(c, now))
		c->held_ns = captured_ns;
	still = captured_ns - c->held_ns >= STILL_NS;
	if (!is_new_place(c, now))
		(void)say_missing(c, text, room);
	else
		snprintf(text, room, "%s%s", still ? "taken" : "hold the board still",
			 is_world_next(c) ? ": this view is the world" : "");
	return still && is_new_place(c, now);
}

/* Goes on without a screen: a kiosk whose screen is off, in use or unplugged can still be
 * calibrated. */
static int lose_screen(struct collecting *c, int err, const struct fault *why, struct fault *fault)
{
	c->has_screen = false;
	if (err == -EINVAL || err == -ENOMEM || err == -ECANCELED)
		return fault_say(fault, err, "%s", why->text);
	log_warning("%s: what is missing is said here instead", why->text);
	return 0;
}

/* Shows the scene on the screen. The log gets each view that is taken and, without a screen, each
 * new text. */
static int tell_state(struct collecting *c, const struct live_scene *scene, struct fault *fault)
{
	if (scene->taken)
		log_info("%s of %d: %d points", c->all->view[c->all->views - 1].name,
			 c->settings->views, scene->corners);
	if (c->has_screen) {
		struct fault why = {{0}};
		const int err = live_screen_show(&c->screen, scene, &why);

		return err ? lose_screen(c, err, &why, fault) : 0;
	}
	if (!scene->taken && strcmp(c->said, scene->text) != 0)
		log_info("%s", scene->text);
	snprintf(c->said, sizeof(c->said), "%s", scene->text);
	return 0;
}

/* Handles one picture: finds the board, perhaps takes a view, shows the result. */
static int look_at_picture(struct collecting *c, const struct image *picture, int64_t captured_ns,
			   struct fault *fault)
{
	struct live_scene scene = {.picture = picture, .covered = c->covered};
	struct observations now = {0};
	char name[32], text[128] = "no board is to be seen";
	int err;

	snprintf(name, sizeof(name), "place %d", c->count + 1);
	err = board_find(c->board, picture, name, &now, fault);
	if (err && err != -ENOENT)
		return err;
	if (err && is_world_next(c))
		(void)say_missing(c, text, sizeof(text));
	scene.taken = !err && judge_view(c, &now, captured_ns, text, sizeof(text));
	err = scene.taken ? collect_view(c, &now, picture) : 0;
	if (scene.taken)
		c->taken_ns = captured_ns;
	scene.corner = now.point;
	scene.corners = now.count;
	scene.text = text;
	if (!err)
		err = tell_state(c, &scene, fault);
	if (now.count && has_moved(c, &now)) {
		observations_free(&c->held);
		c->held = now;
	} else {
		observations_free(&now);
	}
	return err;
}

static int collect_views(struct collecting *c, struct live *live, struct fault *fault)
{
	struct image picture = {.width = 0};
	int64_t captured_ns;
	int err = 0;

	while (!err && !is_done(c)) {
		err = live_next(live, FRAME_MS, &picture, &captured_ns, fault);
		if (!err && c->taken_ns == 0)
			c->taken_ns = captured_ns;
		if (!err)
			err = look_at_picture(c, &picture, captured_ns, fault);
		if (!err && (double)(captured_ns - c->taken_ns) >
				    c->settings->patience_s * (double)NS_PER_S)
			err = fault_say(
				fault, -ETIMEDOUT,
				"the board was seen in %d of %d places, and nothing new for %g s",
				c->count, c->settings->views, c->settings->patience_s);
	}
	image_free(&picture);
	return err;
}

static int open_screen(struct collecting *c, struct live *live, struct fault *fault)
{
	struct fault why = {{0}};
	const int err = live_screen_open(&c->screen, live, &why);

	c->has_screen = !err;
	return err ? lose_screen(c, err, &why, fault) : 0;
}

int live_collect(struct live *live, struct board *board, const struct collect_settings *settings,
		 struct observations *all, struct image **pictures, int *count, struct fault *fault)
{
	struct collecting c = {
		.board = board, .settings = settings, .all = all, .first = all->views};
	int err = open_screen(&c, live, fault), closed;

	if (!err)
		err = collect_views(&c, live, fault);
	closed = live_screen_close(&c.screen, err || !c.has_screen ? NULL : fault);
	if (!err && c.has_screen)
		err = closed;
	if (err == -ENOMEM)
		fault_say(fault, err, "out of memory");
	observations_free(&c.held);
	for (int i = 0; err && i < c.count; i++)
		image_free(&c.picture[i]);
	if (err)
		free(c.picture);
	*pictures = err ? NULL : c.picture;
	*count = err ? 0 : c.count;
	return err;
}
