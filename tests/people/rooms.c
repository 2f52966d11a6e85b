/* SPDX-License-Identifier: MIT */
#include "tests/people/rooms.h"

#include <math.h>
#include <string.h>

#include "hal/optics/vec.h"

/* Half the room that people walk in, and what they keep off the object's corners: half a step. */
static const double door_m = 2.7, clearance_m = 0.3;

/* Numbers of a room, one after another. */
struct draw {
	uint32_t room, next;
};

static double draw_between(struct draw *draw, double low, double high)
{
	return low + (high - low) * studio_chance(draw->room * 7919 + 17, draw->next++);
}

static bool draw_chance(struct draw *draw, double chance)
{
	return draw_between(draw, 0, 1) < chance;
}

static void draw_colour(struct draw *draw, double low, double high, double rgb[3])
{
	const double level = draw_between(draw, low, high);

	for (int c = 0; c < 3; c++)
		rgb[c] = fmin(level * draw_between(draw, 0.65, 1.35), 0.85);
}

/* ---- the place ---- */

static void draw_camera(struct draw *draw, struct room *room)
{
	const int kind = room->number % HALF;
	const bool above = kind == 3;

	room->width = kind == 5 ? 640 : 320;
	room->height = room->width * 3 / 4;
	room->eye[0] = draw_between(draw, -1.2, 1.2);
	room->eye[1] = draw_between(draw, -2.4, -1.8);
	room->eye[2] = draw_between(draw, 0.9, 2.4);
	if (above) {
		room->eye[0] /= 2;
		room->eye[1] = draw_between(draw, -1.3, -0.7);
		room->eye[2] = draw_between(draw, 2.6, 2.9);
	}
	room->target[0] = draw_between(draw, -0.15, 0.15);
	room->target[1] = draw_between(draw, 0, 0.25);
	room->target[2] = draw_between(draw, 0.1, 0.35);
	room->field_deg = draw_between(draw, 48, 72);
	room->box_m = draw_between(draw, 0.35, 0.55);
	room->box_turn_deg = draw_between(draw, 0, 90);
	room->edge_spread_px = draw_between(draw, 0.3, 0.9);
}

static void draw_surfaces(struct draw *draw, struct room *room)
{
	room->floor = (enum floor_kind)((room->number + room->number / HALF) % FLOOR_KINDS);
	draw_colour(draw, 0.12, 0.6, room->floor_albedo[0]);
	draw_colour(draw, 0.12, 0.6, room->floor_albedo[1]);
	room->grain_m = draw_between(draw, 0.015, 0.06);
	for (int s = STUDIO_WALL_EAST; s < STUDIO_SURFACE_COUNT; s++)
		draw_colour(draw, 0.6, 1.6, room->wall[s]);
}

/* The lantern's middle at a time. */
static void lamp_place(const struct room_lamp *lamp, double time_s, double place[3])
{
	const double turn = lamp->circle_m > 0 ? lamp->phase + 2 * M_PI * time_s / lamp->turn_s : 0;

	memcpy(place, lamp->lantern.centre, sizeof(lamp->lantern.centre));
	place[0] += lamp->circle_m * cos(turn);
	place[1] += lamp->circle_m * sin(turn);
}

/* Whether the lantern is ever in the picture, or nearly: as a lamp that floats before the place is
 * no person, and nothing of the place either. */
static bool lamp_is_seen(const struct room *room, const struct room_lamp *lamp)
{
	/* Half the picture's diagonal, which is 5/4 of its width. */
	const double corner = atan(1.25 * tan(room->field_deg * M_PI / 360));

	for (int k = 0; k < 16; k++) {
		double place[3], axis[3], to[3], distance;

		lamp_place(lamp, lamp->turn_s * k / 16, place);
		for (int i = 0; i < 3; i++) {
			axis[i] = room->target[i] - room->eye[i];
			to[i] = place[i] - room->eye[i];
		}
		distance = vec_normalize(to);
		vec_normalize(axis);
		if (distance < 0.6 ||
		    vec_angle(axis, to) < corner + asin(lamp->lantern.radius / distance))
			return true;
	}
	return false;
}

static void hang_lamp(struct room *room, struct room_lamp *lamp, int number)
{
	struct draw draw = {(uint32_t)(room->number + ROOMS * (1 + number)), 0};

	for (int tries = 0; tries < 1000 && lamp_is_seen(room, lamp); tries++) {
		lamp->lantern.centre[0] = draw_between(&draw, -2.2, 2.2);
		lamp->lantern.centre[1] = draw_between(&draw, -2.1, 2);
		lamp->lantern.centre[2] = draw_between(&draw, 1.3, 2.6);
		if (lamp->circle_m > 0) /* within the room, whose walls are at 3 and 2.5 m */
			lamp->circle_m = fmin(draw_between(&draw, 0.2, 1.3),
					      fmin(2.8 - fabs(lamp->lantern.centre[0]),
						   2.3 - fabs(lamp->lantern.centre[1])));
	}
}

static void draw_lamps(struct draw *draw, struct room *room)
{
	const int kind = room->number % HALF;
	const int lamps = kind == 1 ? 0 : 1 + draw_chance(draw, 0.6);

	room->panels = kind == 4 ? 0 : draw_between(draw, 0.4, 1.5);
	room->panels_switch_s = kind == 0 || kind == 5 ? draw_between(draw, 5, 9) : 0;
	for (int i = 0; i < STUDIO_LANTERNS; i++) {
		struct room_lamp *lamp = &room->lamp[i];
		const double power = draw_between(draw, 0.5, 1.8);

		lamp->lantern.radius = draw_between(draw, 0.12, 0.34);
		draw_colour(draw, 3, 4, lamp->lantern.radiance);
		for (int c = 0; c < 3; c++) /* as bright as a studio's lantern, whatever its size */
			lamp->lantern.radiance[c] = power * 3.5 * draw_between(draw, 0.6, 1.4) *
						    pow(0.32 / lamp->lantern.radius, 2);
		lamp->lantern.centre[0] = draw_between(draw, -2.2, 2.2);
		lamp->lantern.centre[1] = draw_between(draw, -1.8, 2);
		lamp->lantern.centre[2] = draw_between(draw, 1.3, 2.6);
		lamp->phase = draw_between(draw, 0, 2 * M_PI);
		if (draw_chance(draw, 0.5)) {
			lamp->circle_m = draw_between(draw, 0.8, 1.3);
			lamp->turn_s = draw_between(draw, 9, 30);
			lamp->lantern.centre[0] = lamp->lantern.centre[1] = 0;
		} else if (kind == 2 || kind == 3) {
			lamp->switch_s = draw_between(draw, 5, 9);
		}
		hang_lamp(room, lamp, i);
		if (i >= lamps) /* nowhere, and without light */
			*lamp = (struct room_lamp){
				.lantern = {.centre = {0, -90, 1}, .radius = 1e-3}};
	}
}

static void draw_sensor(struct draw *draw, struct room *room)
{
	const int kind = room->number % HALF;
	const bool dark = kind == 4;

	room->level = dark ? draw_between(draw, 0.02, 0.035) : draw_between(draw, 0.1, 0.25);
	room->read_noise = dark || kind == 1 ? draw_between(draw, 1, 2)
					     : draw_between(draw, 0.3, 0.8);
	room->shot_noise = dark || kind == 1 ? draw_between(draw, 3, 5)
					     : draw_between(draw, 1, 2.5);
	room->step = 1;
	if (kind == 1 || kind == 2 || kind == 5) {
		room->step = draw_between(draw, 1.12, 1.4);
		room->step_s = draw_between(draw, 5, 9);
		room->drift = draw_between(draw, 0, 0.04);
	}
}

/* ---- people ---- */

static void draw_clothes(struct draw *draw, const struct room *room, struct room_walker *walker)
{
	static const double skin[2][3] = {{0.24, 0.15, 0.10}, {0.60, 0.42, 0.33}};
	static const double north[3] = {0.30, 0.38, 0.24}; /* of the studio's wall */
	const double shade = draw_between(draw, 0, 1), kind = draw_between(draw, 0, 1);

	walker->style = draw_chance(draw, 0.3)	 ? WALKER_JUMPER
			: draw_chance(draw, 0.3) ? WALKER_CHECKS
			: draw_chance(draw, 0.3) ? WALKER_RUG
						 : WALKER_SUIT;
	walker->height = draw_chance(draw, 0.2) ? draw_between(draw, 0.6, 0.8)
						: draw_between(draw, 0.92, 1.1);
	for (int c = 0; c < 3; c++)
		walker->cloth[0][c] = skin[0][c] + shade * (skin[1][c] - skin[0][c]);
	draw_colour(draw, 0.02, 0.3, walker->cloth[1]);
	for (int part = 2; part < 6; part++) {
		double *colour = walker->cloth[part];

		draw_colour(draw, 0.03, 0.7, colour);
		if (kind < 0.15) /* dark */
			draw_colour(draw, 0.03, 0.06, colour);
		for (int c = 0; c < 3 && kind > 0.7; c++)
			colour[c] = kind < 0.85 ? room->floor_albedo[0][c]
						: north[c] * room->wall[STUDIO_WALL_NORTH][c];
	}
}

static void draw_crossing(struct draw *draw, const struct room *room,
			  struct room_crossing *crossing, bool stays)
{
	const double nearest = room->box_m * M_SQRT1_2 + clearance_m;
	const bool before = draw_chance(draw, 0.5);
	const double off = before ? -draw_between(draw, nearest, 1.05)
				  : draw_between(draw, nearest, 1.5);
	const double slant = draw_between(draw, -0.42, 0.42); /* no way ends in a wall */
	const double side = draw_chance(draw, 0.5) ? 1 : -1;
	double walk_s;

	crossing->turn_rad = side > 0 ? slant : M_PI - slant;
	crossing->from[0] = -side * door_m;
	crossing->from[1] = off / cos(slant) - door_m * tan(slant);
	crossing->speed = draw_between(draw, 0.5, 1.6);
	crossing->stop_m = door_m / cos(slant) + draw_between(draw, -0.7, 0.7);
	crossing->stop_s = draw_chance(draw, 0.35) ? draw_between(draw, 1, 5) : 0;
	crossing->returns = draw_chance(draw, 0.2);
	if (stays)
		crossing->stop_s = 45;
	walk_s = (crossing->returns ? 2 * crossing->stop_m : 2 * door_m / cos(slant)) /
		 crossing->speed;
	if (stays) /* is there when the first frame is taken, and goes while it is judged */
		crossing->begin_s -= crossing->stop_m / crossing->speed + 1;
	crossing->end_s = crossing->begin_s + walk_s + crossing->stop_s;
}

static void draw_walker(struct draw *draw, struct room *room, int number)
{
	struct room_walker *walker = &room->walker[number];
	const double leaving_s = (double)LEAVING / RATE_HZ;
	double at_s = room->inhabited ? draw_between(draw, -5, 2)
				      : (double)LEARNING / RATE_HZ + draw_between(draw, 0, 3);

	draw_clothes(draw, room, walker);
	while (at_s < leaving_s && walker->crossings < MOST_CROSSINGS) {
		struct room_crossing *crossing = &walker->crossing[walker->crossings];
		const bool stays = room->inhabited && number + walker->crossings == 0;

		crossing->begin_s = stays ? 0 : at_s;
		draw_crossing(draw, room, crossing, stays);
		at_s = crossing->end_s + draw_between(draw, 0.3, 2);
		walker->crossings++;
	}
}

void room_draw(int number, struct room *room)
{
	const int kind = number % HALF;
	struct draw draw = {(uint32_t)number, 0};

	memset(room, 0, sizeof(*room));
	room->number = number;
	draw_camera(&draw, room);
	draw_surfaces(&draw, room);
	draw_lamps(&draw, room);
	draw_sensor(&draw, room);
	room->inhabited = kind == 3 || kind == 5;
	room->walkers = 1 + (kind + 2) % HALF; /* three to six, one, two */
	for (int i = 0; i < room->walkers; i++)
		draw_walker(&draw, room, i);
}

/* ---- what it looks like ---- */

/* Smooth noise of mean 0, about -0.5..0.5, that changes over a length of 1. */
static double grain(double x, double y, uint32_t key)
{
	const double fx = floor(x), fy = floor(y);
	const double u = x - fx, v = y - fy;
	double corner[4];

	for (int i = 0; i < 4; i++)
		corner[i] = studio_chance((uint32_t)(int32_t)fx + i % 2 + key * 613,
					  (uint32_t)(int32_t)fy + i / 2) -
			    0.5;
	return (corner[0] * (1 - u) + corner[1] * u) * (1 - v) +
	       (corner[2] * (1 - u) + corner[3] * u) * v;
}

static void paint_floor(const struct room *room, struct studio_hit *hit)
{
	const double x = hit->point[0], y = hit->point[1], g = room->grain_m;
	const double fine = grain(x / g, y / g, 1), wide = grain(x / 0.7, y / 0.7, 2);
	const double tile_m = 0.2 + 4 * g, joint_m = 0.008;
	const int column = (int)floor(x / tile_m), row = (int)floor(y / tile_m);
	const double *colour = room->floor_albedo[0];
	double factor = 1;

	switch (room->floor) {
	case FLOOR_TILES:
		colour = room->floor_albedo[(column + row) & 1];
		factor = 1 + 0.1 * wide;
		if (x - column * tile_m < joint_m || y - row * tile_m < joint_m)
			factor = 0.6;
		break;
	case FLOOR_CONCRETE:
		factor = 1 + 0.25 * wide + 0.06 * fine;
		break;
	case FLOOR_GRAVEL:
		factor = 1 + 0.9 * fine + 0.4 * grain(x / g / 2.7, y / g / 2.7, 3);
		break;
	case FLOOR_CARPET:
		factor = 1 + 0.04 * sin(2 * M_PI * x / g / 0.6);
		if (fabs(fmod(fabs(y), 0.7) - 0.35) < 0.06)
			colour = room->floor_albedo[1];
		break;
	default: /* the studio's own boards and rug, in another tone */
		for (int c = 0; c < 3; c++)
			hit->albedo[c] *= 0.5 + room->floor_albedo[0][c];
		return;
	}
	for (int c = 0; c < 3; c++)
		hit->albedo[c] = factor * colour[c];
}

void room_paint(const void *of, struct studio_hit *hit)
{
	const struct room *room = of;

	if (hit->surface == STUDIO_FLOOR)
		paint_floor(room, hit);
	else if (hit->surface != STUDIO_CEILING)
		for (int c = 0; c < 3; c++)
			hit->albedo[c] *= room->wall[hit->surface][c];
}

void room_print_scene(const struct room *room, FILE *out)
{
	const double *rug = room->floor_albedo[0];

	fprintf(out, "[camera]\nposition = %.4f %.4f %.4f\nlook_at = %.4f %.4f %.4f\n",
		room->eye[0], room->eye[1], room->eye[2], room->target[0], room->target[1],
		room->target[2]);
	fprintf(out, "field_deg = %.4f\nwidth = %d\nheight = %d\nedge_spread = %.2f\n",
		room->field_deg, room->width, room->height, room->edge_spread_px);
	fprintf(out, "[dome]\nfrequency = 3\n[render]\nsamples = 8\nbounces = 1\n");
	fprintf(out, "[ground]\nmaterial = ground\n[material ground]\ncolour = %.3f %.3f %.3f\n",
		rug[0], rug[1], rug[2]);
	fprintf(out, "[object box]\nfile = box.obj\nmaterial = paint\nscale = %.4f\n", room->box_m);
	fprintf(out, "rotate = 0 0 %.4f\nstand = yes\n", room->box_turn_deg);
	fprintf(out, "[material paint]\ncolour = 0.6 0.05 0.04\n");
}

/* ---- moments ---- */

double room_time_s(int frame)
{
	return frame < LEAVING ? (double)frame / RATE_HZ
			       : (double)LEAVING / RATE_HZ + (double)(frame - LEAVING) / LEAVING_HZ;
}

static bool is_off(double time_s, double switch_s)
{
	return switch_s > 0 && fmod(floor(time_s / switch_s), 2) != 0;
}

struct studio_lamps room_lamps(const struct room *room, double time_s)
{
	struct studio_lamps lamps = {.time_s = time_s, .panels = room->panels};

	if (is_off(time_s, room->panels_switch_s))
		lamps.panels = 0;
	for (int i = 0; i < STUDIO_LANTERNS; i++) {
		const struct room_lamp *lamp = &room->lamp[i];
		struct studio_lantern *lantern = &lamps.lantern[i];

		*lantern = lamp->lantern;
		lamp_place(lamp, time_s, lantern->centre);
		for (int c = 0; c < 3 && is_off(time_s, lamp->switch_s); c++)
			lantern->radiance[c] = 0;
	}
	return lamps;
}

static void follow_crossing(const struct room_crossing *crossing, double time_s,
			    struct walker *walker)
{
	const double stride_m = WALKER_STRIDE_M * walker->height, soft_s = 0.4;
	const double since = time_s - crossing->begin_s;
	const double come_s = crossing->stop_m / crossing->speed;
	const double go_s = since - come_s - crossing->stop_s;
	const double stood_s = fmin(since - come_s, -go_s); /* from its nearer end */
	double way = crossing->speed * fmin(since, come_s);

	walker->walked = way / stride_m;
	walker->heading_rad = crossing->turn_rad;
	walker->pace = fmin(fmax(1 - stood_s / soft_s, 0), 1);
	if (go_s > 0) {
		walker->walked += crossing->speed * go_s / stride_m;
		walker->heading_rad += crossing->returns ? M_PI : 0;
		way += (crossing->returns ? -1 : 1) * crossing->speed * go_s;
	}
	walker->place[0] = crossing->from[0] + way * cos(crossing->turn_rad);
	walker->place[1] = crossing->from[1] + way * sin(crossing->turn_rad);
}

void room_moment(const struct room *room, int frame, double exposure, struct studio_lamps *lamps,
		 struct filmed_moment *moment)
{
	const double t = room_time_s(frame);
	const double step = is_off(t, room->step_s) ? room->step : 1;

	memset(moment, 0, sizeof(*moment));
	*lamps = room_lamps(room, t);
	moment->time_s = t;
	moment->lamps = lamps;
	moment->number = frame;
	moment->edge_spread_px = room->edge_spread_px;
	for (int c = 0; c < 3; c++)
		moment->exposure[c] = exposure * step * (1 + (1 - c) * room->drift * sin(t / 7));
	for (int i = 0; i < room->walkers; i++)
		for (int k = 0; k < room->walker[i].crossings; k++) {
			const struct room_walker *of = &room->walker[i];
			const struct room_crossing *crossing = &of->crossing[k];
			struct walker *walker = &moment->walker[moment->walkers];

			if (t < crossing->begin_s || t >= crossing->end_s)
				continue;
			*walker = (struct walker){.style = of->style,
						  .time_s = t,
						  .height = of->height,
						  .cloth = of->cloth};
			follow_crossing(crossing, t, walker);
			moment->walkers++;
		}
}
