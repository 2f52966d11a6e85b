/* SPDX-License-Identifier: MIT */
#include "app/camera/source.h"

#include <math.h>

#define GRID 32	      /* points across and down that are looked at */
#define BLANK_MOST 16 /* code value of red and blue in pictures without any light */
#define STEADY_SHARE                                                                               \
	0.04 /* change of the level that counts as none; the noise of 32 x 32 points is less */
#define STEADY_PICTURES 3

struct settling_look settling_look_at(const struct frame_reader *picture)
{
	const int width = picture->view.width, height = picture->view.height;
	struct settling_look look = {.level = 0, .blank = true};

	for (int i = 0; i < GRID * GRID; i++) {
		const int x = (int)((i % GRID + 0.5) * width / GRID);
		const int y = (int)((i / GRID + 0.5) * height / GRID);
		uint32_t pixel;
		int blue, green, red;

		frame_reader_make(picture, x, y, 1, 1, (uint8_t *)&pixel, 4);
		blue = pixel & 255;
		green = pixel >> 8 & 255;
		red = pixel >> 16 & 255;
		look.level += (blue + green + red) / (3.0 * GRID * GRID);
		look.blank &= blue <= BLANK_MOST && red <= BLANK_MOST;
	}
	return look;
}

/* Whether the level has been steady for long enough. */
static bool is_steady(struct settling *s, double level, int64_t captured_ns)
{
	if (s->level < 0 || fabs(level - s->level) > fmax(1, STEADY_SHARE * s->level)) {
		s->level = level;
		s->steady_ns = captured_ns;
		s->steady = 0;
	}
	s->steady++;
	return s->steady >= STEADY_PICTURES &&
	       captured_ns - s->steady_ns >=
		       (s->kept ? SETTLING_KEPT_STEADY_NS : SETTLING_STEADY_NS);
}

bool settling_take(struct settling *s, unsigned opening, const struct settling_look *look,
		   bool metering, int64_t captured_ns)
{
	const int64_t most_ns = s->kept && !look->blank ? SETTLING_KEPT_MOST_NS : SETTLING_MOST_NS;

	if (s->opening != opening)
		*s = (struct settling){.opening = opening,
				       .left_out = s->left_out,
				       .kept = s->kept,
				       .begun_ns = captured_ns,
				       .level = -1};
	if (s->settled)
		return true;
	if (look->blank)
		s->level = -1;
	else
		s->settled = !metering || is_steady(s, look->level, captured_ns);
	s->in_vain = !s->settled && captured_ns - s->begun_ns >= most_ns;
	s->settled |= s->in_vain;
	s->left_out += !s->settled;
	return s->settled;
}
