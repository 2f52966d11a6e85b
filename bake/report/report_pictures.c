/* SPDX-License-Identifier: MIT */
/* Section: the composite of the setting in use in each surrounding, beside the truth. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"

#define PANELS 3
#define GAP 4  /* pixels between them */
#define GAIN 8 /* factor of the difference */

static uint8_t level_code(double level)
{
	return (uint8_t)lround(fmin(fmax(level, 0), 255));
}

/* Fills out with the composite, the truth, and their difference about a middle grey, side by
 * side. */
static void fill_comparison(const struct report *r, const struct canvas *ours, const double *truth,
			    struct image *out)
{
	const int width = r->stage.width;

	memset(out->u8, 255, 3 * (size_t)out->width * (size_t)out->height);
	for (int y = 0; y < r->stage.height; y++) {
		for (int x = 0; x < width; x++) {
			const uint8_t *is = ours->pixels + (size_t)y * ours->stride + (size_t)x * 4;
			const double *was = truth + 3 * ((size_t)y * (size_t)width + (size_t)x);
			uint8_t *to = out->u8 + 3 * ((size_t)y * (size_t)out->width + (size_t)x);

			for (int c = 0; c < 3; c++) {
				to[c] = is[2 - c];
				to[3 * (width + GAP) + c] = level_code(was[c]);
				to[6 * (width + GAP) + c] =
					level_code(128 + GAIN * (is[2 - c] - was[c]));
			}
		}
	}
}

static int show_one(struct report *r, const struct report_way *way, int lighting,
		    struct canvas *ours, struct image *out)
{
	const struct report_lighting *l = &r->stage.lighting[lighting];
	char name[128], caption[256];
	int err = report_trial_picture(way, &r->stage, lighting, ours, r->fault);

	if (err)
		return err;
	fill_comparison(r, ours, l->truth, out);
	snprintf(name, sizeof(name), "picture-%d", lighting + 1);
	snprintf(
		caption, sizeof(caption),
		"%s: the setting in use, path-traced truth, and %d times their difference (grey: none).",
		l->name, GAIN);
	return report_page_picture(&r->page, r->page.body, name, out, caption, r->fault);
}

int report_pictures(struct report *r)
{
	const struct report_way way = report_way_plain(r->used);
	struct canvas ours = {.pixels = NULL};
	struct image out = {.width = 0};
	int err = canvas_create(&ours, r->stage.width, r->stage.height);

	if (!err)
		err = image_create_u8(&out, PANELS * r->stage.width + (PANELS - 1) * GAP,
				      r->stage.height);
	if (err) {
		fault_say(r->fault, err, "not enough memory for a picture");
		goto release;
	}
	report_heading(r->page.body, "What does it look like?");
	for (int l = 0; !err && l < r->stage.lightings; l++)
		err = show_one(r, &way, l, &ours, &out);
release:
	image_free(&out);
	canvas_free(&ours);
	return err;
}
