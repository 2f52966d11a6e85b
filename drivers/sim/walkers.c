/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const double wall_m = 2.8; /* |x| where they come and go */
static const double bag_stop[2] = {0.42, -0.42};

double walker_height(enum walker_style style)
{
	static const double height[WALKER_STYLES] = {1.0, 1.05, 0.97, 0.66, 1.0, 0.98};

	return height[style];
}

/* A crossing of the room: from one side to the other, with a stop of some length on the way. */
struct crossing {
	double from[2], to[2];
	double speed;	       /* m/s */
	double stop_m, stop_s; /* where along the way, and for how long */
};

static struct crossing plan_crossing(enum walker_style style, int number)
{
	const uint32_t key = (uint32_t)number * WALKER_STYLES + (uint32_t)style;
	const double side = studio_chance(key, 1) < 0.5 ? -1 : 1;
	const double lane = studio_chance(key, 2);
	struct crossing c = {.speed = 0.8 + 0.5 * studio_chance(key, 3)};
	double middle;

	/* Before the object, through its place, behind it. */
	if (lane < 0.4)
		middle = -0.35 - 0.75 * studio_chance(key, 4);
	else if (lane < 0.5)
		middle = -0.15 + 0.3 * studio_chance(key, 4);
	else
		middle = 0.4 + 1.1 * studio_chance(key, 4);
	c.from[0] = -side * wall_m;
	c.to[0] = side * wall_m;
	c.from[1] = middle + 0.5 * (studio_chance(key, 5) - 0.5);
	c.to[1] = 2 * middle - c.from[1];
	c.stop_m = wall_m + 0.8 * (studio_chance(key, 6) - 0.5);
	c.stop_s = studio_chance(key, 7) < 0.3 ? 2.5 : 0;
	if (style == WALKER_BAG) { /* stops where the bag is put down and taken up */
		c.from[1] = c.to[1] = bag_stop[1] - 0.12;
		c.stop_m = fabs(bag_stop[0] - 0.3 * side - c.from[0]);
		c.stop_s = 1.5;
	}
	return c;
}

/* Distance walked until `t` seconds after the start: even speed, softly stopped and started. */
static double crossing_walked(const struct crossing *c, double t, double *pace)
{
	const double soft_s = 0.7; /* a stop costs the time of soft_s at full speed */
	const double reach_s = c->stop_m / c->speed - soft_s / 2;
	double into = t - reach_s;

	*pace = 1;
	if (c->stop_s == 0 || into <= 0)
		return c->speed * t;
	if (into < soft_s) {
		*pace = 1 - into / soft_s;
		return c->speed * (reach_s + into - into * into / (2 * soft_s));
	}
	*pace = 0;
	into -= soft_s;
	if (into < c->stop_s)
		return c->stop_m;
	into -= c->stop_s;
	if (into < soft_s) {
		*pace = into / soft_s;
		return c->stop_m + c->speed * into * into / (2 * soft_s);
	}
	*pace = 1;
	return c->stop_m + c->speed * (into - soft_s / 2);
}

/* Takes a walker's place on its way. False: the crossing is over. */
static bool crossing_follow(const struct crossing *c, double t, struct walker *walker)
{
	const double along[2] = {c->to[0] - c->from[0], c->to[1] - c->from[1]};
	const double length = hypot(along[0], along[1]);
	const double walked = crossing_walked(c, t, &walker->pace);

	for (int i = 0; i < 2; i++)
		walker->place[i] = c->from[i] + along[i] / length * walked;
	walker->heading_rad = atan2(along[1], along[0]);
	walker->walked = walked / (WALKER_STRIDE_M * walker_height(walker->style));
	return walked < length;
}

/* The bag is put down in the middle of the stop of an even crossing, and taken up in that of the
 * next one. */
static void carry_bag(const struct crossing *c, int number, double t, struct walker *walker)
{
	const bool before = t < c->stop_m / c->speed + c->stop_s / 2;
	const bool even = number % 2 == 0;

	walker->bag_left = even ? !before : before;
	walker->bag_in_hand = !walker->bag_left;
	memcpy(walker->bag_place, bag_stop, sizeof(bag_stop));
}

int walkers_at(double time_s, int count, struct walker list[WALKER_STYLES])
{
	int present = 0;

	for (int style = 0; style < count && style < WALKER_STYLES; style++) {
		struct walker walker = {.style = (enum walker_style)style, .time_s = time_s};
		const double period_s = 10 + 0.4 * style;
		const double since_s = time_s + period_s * (1 - 0.37 * style);
		const int number = (int)floor(since_s / period_s);
		const double t = since_s - number * period_s;
		const struct crossing crossing = plan_crossing(walker.style, number);

		walker.absent = !crossing_follow(&crossing, t, &walker);
		if (walker.style == WALKER_BAG)
			carry_bag(&crossing, number, t, &walker);
		if (!walker.absent || walker.bag_left)
			list[present++] = walker;
	}
	return present;
}
