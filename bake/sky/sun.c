/* SPDX-License-Identifier: MIT */
#include "bake/sky/sun.h"

#include <math.h>
#include <string.h>

#define DEGREE (M_PI / 180)
#define DAYS 365
#define HOUR_STEP 0.02 /* h: the sun moves by 0.3 degrees, a third of the smallest piece */
#define SUN_SHARE 0.8  /* of the irradiance under a clear sky; the rest is spread evenly */

int sun_day(struct sun_date date)
{
	static const int before[] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334, DAYS};
	const bool leap = date.month == 2 && date.day == 29;

	if (date.month < 1 || date.month > 12 || date.day < 1)
		return -1;
	if (!leap && before[date.month - 1] + date.day > before[date.month])
		return -1;
	return before[date.month - 1] + date.day - 1 - leap;
}

double sun_declination_rad(int day)
{
	const double n = day; /* 2000 began the formula's count */
	const double mean = (280.460 + 0.9856474 * n) * DEGREE;
	const double anomaly = (357.528 + 0.9856003 * n) * DEGREE;
	const double longitude = mean + (1.915 * sin(anomaly) + 0.020 * sin(2 * anomaly)) * DEGREE;

	return asin(sin(23.44 * DEGREE) * sin(longitude));
}

void sun_direction(double latitude_rad, double declination_rad, double hour,
		   double east_north_up[3])
{
	const double angle = (hour - 12) * 15 * DEGREE;
	const double cos_d = cos(declination_rad), sin_d = sin(declination_rad);
	const double cos_l = cos(latitude_rad), sin_l = sin(latitude_rad);

	east_north_up[0] = -cos_d * sin(angle);
	east_north_up[1] = cos_l * sin_d - sin_l * cos_d * cos(angle);
	east_north_up[2] = sin_l * sin_d + cos_l * cos_d * cos(angle);
}

/* The piece of the sky in which the sun stands; -1: it is below the horizon. */
static int sun_piece(const struct dome *pieces, const struct sun_path *path, int day, double hour)
{
	const double c = cos(path->north_deg * DEGREE), s = sin(path->north_deg * DEGREE);
	double enu[3], d[3];

	sun_direction(path->latitude_deg * DEGREE, sun_declination_rad(day), hour, enu);
	/* north is (c, s) in the scene, and east (s, -c) */
	d[0] = enu[1] * c + enu[0] * s;
	d[1] = enu[1] * s - enu[0] * c;
	d[2] = enu[2];
	return dome_cell_of(pieces, d);
}

/* Adds a clear sky whose sun is in a piece. */
static void add_clear_sky(struct sky_need *need, int piece)
{
	const int pieces = sky_need_pieces(need)->count;
	double even = 0;

	for (int i = 0; i < pieces; i++)
		even += need->even[i];
	for (int i = 0; i < pieces; i++)
		need->irradiance[i] = (1 - SUN_SHARE) * need->even[i] / even;
	need->irradiance[piece] += SUN_SHARE;
	sky_need_add(need, 0);
}

int sky_need_add_sun(struct sky_need *need, const struct sun_path *path)
{
	const struct dome *pieces = sky_need_pieces(need);
	const int from = sun_day(path->from), to = sun_day(path->to);
	const int steps = (int)ceil((path->hours[1] - path->hours[0]) / HOUR_STEP);
	const int days = (to - from + DAYS) % DAYS;
	bool passed[DOME_LIGHTS_MAX] = {false};
	int count = 0;

	for (int day = 0; day <= days; day++)
		for (int k = 0; k <= steps; k++) {
			const double hour = path->hours[0] + (path->hours[1] - path->hours[0]) * k /
								     (steps > 0 ? steps : 1);
			const int piece = sun_piece(pieces, path, (from + day) % DAYS, hour);

			if (piece < 0 || passed[piece])
				continue;
			passed[piece] = true;
			count++;
			add_clear_sky(need, piece);
		}
	return count;
}
