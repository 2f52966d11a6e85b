/* SPDX-License-Identifier: MIT */
#include "hal/lights/exposure_schedule.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define VISIBLE 0.1 /* least visible change, as a share of the brighter level */

void exposure_schedule_begin(struct exposure_schedule *s, int count, int delay)
{
	*s = (struct exposure_schedule){.count = count, .delay = delay, .found = -1, .before = -1};
}

static int exposure_of(const struct exposure_schedule *s, int64_t frame)
{
	const int delay = s->delay < 0 ? EXPOSURE_DELAY_MAX : s->delay;
	int exposure = -1;

	for (int k = 0; k < s->asked_count && s->asked[k].from + delay <= frame; k++)
		exposure = s->asked[k].exposure;
	/* With an unknown delay the last request may have taken effect already. */
	if (s->delay < 0 && s->asked_count > 0 && s->asked[s->asked_count - 1].from + delay > frame)
		return -1;
	return exposure;
}

int exposure_schedule_take(struct exposure_schedule *s, uint32_t sequence)
{
	const int32_t step = (int32_t)(sequence - s->sequence);

	s->frame += s->started && step > 0 ? step : 1;
	s->sequence = sequence;
	s->started = true;
	return exposure_of(s, s->frame);
}

static int last_asked(const struct exposure_schedule *s)
{
	return s->asked_count ? s->asked[s->asked_count - 1].exposure : -1;
}

int exposure_schedule_next(const struct exposure_schedule *s)
{
	const int last = last_asked(s);

	if (s->delay >= 0)
		return s->count > 1 || last < 0 ? (last + 1) % s->count : -1;
	if (last >= 0 && !s->turn)
		return -1;
	return last == 0 ? s->count - 1 : 0;
}

void exposure_schedule_asked(struct exposure_schedule *s, int exposure, int ahead)
{
	const int64_t from = s->frame + 1 + ahead;
	int last = s->asked_count - 1;

	if (last >= 0 &&
	    s->asked[last].from >= from) { /* two for one frame: the later one counts */
		s->asked[last].exposure = exposure;
	} else {
		if (s->asked_count == EXPOSURE_ASKED_MAX) {
			memmove(s->asked, s->asked + 1,
				(EXPOSURE_ASKED_MAX - 1) * sizeof(*s->asked));
			s->asked_count--;
		}
		last = s->asked_count++;
		s->asked[last].from = from;
		s->asked[last].exposure = exposure;
	}
	s->seen_count = 0;
	s->turn = false;
}

/* ---- measuring the delay ---- */

/* The delay that the last change shows: frames from the request to the first frame with more than
 * half of the change. -1: no visible change. */
static int find_delay(const struct exposure_schedule *s)
{
	const double after = s->seen[s->seen_count - 1].level, change = after - s->before;
	const int64_t from = s->asked[s->asked_count - 1].from;

	if (s->before < 0 || !(fabs(change) > VISIBLE * fmax(after, s->before)))
		return -1;
	if ((change > 0) != (last_asked(s) == 0)) /* the effect of the change before */
		return -1;
	for (int k = 0; k < s->seen_count; k++) {
		if ((s->seen[k].level - s->before) / change > 0.5)
			return s->seen[k].frame < from ? -1 : (int)(s->seen[k].frame - from);
	}
	return -1;
}

/* Evaluates a complete change. 0 or -ENODATA as exposure_schedule_measure(). */
static int schedule_conclude(struct exposure_schedule *s)
{
	const int delay = find_delay(s);

	s->before = s->seen[s->seen_count - 1].level;
	s->turn = true;
	if (delay >= 0 && delay == s->found && delay <= EXPOSURE_DELAY_MAX) {
		s->delay = delay;
		return 0;
	}
	s->found = delay;
	if (++s->changes <= EXPOSURE_CHANGES_MAX)
		return 0;
	exposure_schedule_begin(s, s->count, -1);
	return -ENODATA;
}

int exposure_schedule_measure(struct exposure_schedule *s, double level)
{
	if (s->delay >= 0 || !s->asked_count || s->turn)
		return 0;
	s->seen[s->seen_count].frame = s->frame;
	s->seen[s->seen_count++].level = level;
	if (s->seen_count < EXPOSURE_HOLD &&
	    s->frame + 1 < s->asked[s->asked_count - 1].from + EXPOSURE_HOLD)
		return 0;
	return schedule_conclude(s);
}
