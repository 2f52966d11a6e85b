/* SPDX-License-Identifier: MIT */
#include "app/kiosk/rest.h"

#include "hal/base/clock.h"

void rest_take_hours(struct rest *rest, const char *hours)
{
	(void)config_hours_read(hours, &rest->hours, NULL);
	rest->awake_until_ns = 0;
	rest->due = true;
}

bool rest_press(struct rest *rest, int64_t now_ns)
{
	rest->awake_until_ns = now_ns + REST_WAKE_MINUTES * 60 * NS_PER_S;
	rest->due |= rest->resting;
	return rest->resting;
}

static bool has_hours(const struct rest *rest, time_t wall)
{
	return rest->hours.count && wall >= rest->built;
}

bool rest_is_due(const struct rest *rest, time_t wall, int64_t now_ns)
{
	return has_hours(rest, wall) && now_ns >= rest->awake_until_ns &&
	       !config_hours_are_on(&rest->hours, config_hours_minute(wall));
}

void rest_next(const struct rest *rest, time_t wall, char text[HOURS_MOMENT_MAX])
{
	const int next = has_hours(rest, wall)
				 ? config_hours_next(&rest->hours, config_hours_minute(wall))
				 : -1;

	*text = '\0';
	if (next >= 0)
		config_hours_moment(next, text);
}
