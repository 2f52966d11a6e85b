/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_patch.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "hal/base/number.h"

int light_area_parse(struct light_area *area, const char *text, struct fault *fault)
{
	double number[2 * LIGHT_CORNERS_MAX];
	const char *at = text;
	bool corners = false;
	int count = 0;

	while (count < 2 * LIGHT_CORNERS_MAX) {
		at += strspn(at, " ");
		if (number_read(&at, &number[count]))
			break;
		count++;
		corners |= *at == ' ';
		if (!*at)
			break;
		at += *at == ',' || *at == ' ';
	}
	if (*at || count < 4 || count % 2 || (corners ? count < 6 : count != 4) ||
	    (!corners && !(number[2] > 0 && number[3] > 0)))
		return fault_say(
			fault, -EINVAL,
			"\"%s\", expected a rectangle x,y,width,height or three corners or more, x,y x,y x,y, in pixels",
			text);
	area->corners = corners ? count / 2 : 4;
	for (int k = 0; k < area->corners; k++)
		for (int c = 0; c < 2; c++)
			area->corner[k][c] = corners ? number[2 * k + c]
						     : number[c] + ((c ? k >= 2 : k == 1 || k == 2)
									    ? number[2 + c]
									    : 0);
	return 0;
}

/* Whether a point is inside, by the even-odd rule. */
static bool area_holds(const struct light_area *area, double x, double y)
{
	bool inside = false;

	for (int k = 0, last = area->corners - 1; k < area->corners; last = k++) {
		const double *a = area->corner[k], *b = area->corner[last];

		if ((a[1] > y) != (b[1] > y) &&
		    x < (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]) + a[0])
			inside = !inside;
	}
	return inside;
}

struct patch_sums {
	double part[4][3]; /* sums by quarter */
	int count[4];
	int clipped;
};

static void sums_add_pixel(struct patch_sums *s, const struct image *picture,
			   const double decode[256], size_t at, int quarter)
{
	bool clipped = false;

	for (int c = 0; c < 3; c++) {
		if (picture->u8) {
			s->part[quarter][c] += decode[picture->u8[at + (size_t)c]];
			clipped |= picture->u8[at + (size_t)c] == 255;
		} else {
			s->part[quarter][c] += (double)picture->f32[at + (size_t)c];
		}
	}
	s->count[quarter]++;
	s->clipped += clipped;
}

static void patch_finish(struct light_patch *p, const struct patch_sums *s)
{
	*p = (struct light_patch){.pixels = s->count[0] + s->count[1] + s->count[2] + s->count[3]};
	p->clipped = (double)s->clipped / p->pixels;
	for (int c = 0; c < 3; c++) {
		double squares = 0;
		int parts = 0;

		for (int q = 0; q < 4; q++)
			p->mean[c] += s->part[q][c] / p->pixels;
		for (int q = 0; q < 4; q++) {
			double off;

			if (!s->count[q])
				continue;
			off = s->part[q][c] / s->count[q] - p->mean[c];
			squares += off * off;
			parts++;
			if (p->mean[c] > 0)
				p->uneven = fmax(p->uneven, fabs(off) / p->mean[c]);
		}
		p->deviation[c] = parts > 1 ? sqrt(squares / (parts * (parts - 1))) : 0;
	}
}

int light_patch_measure(struct light_patch *patch, const struct image *picture,
			const struct light_area *area, const struct transfer_curve *curve,
			struct fault *fault)
{
	double decode[256], middle[2] = {0}, low[2] = {INFINITY, INFINITY},
			    high[2] = {-INFINITY, -INFINITY};
	const int size[2] = {picture->width, picture->height};
	struct patch_sums sums = {.clipped = 0};

	for (int i = 0; i < 256; i++)
		decode[i] = transfer_curve_decode(curve, i / 255.0);
	for (int k = 0; k < area->corners; k++)
		for (int c = 0; c < 2; c++) {
			middle[c] += area->corner[k][c] / area->corners;
			low[c] = fmin(low[c], area->corner[k][c]);
			high[c] = fmax(high[c], area->corner[k][c]);
		}
	if (low[0] < -0.5 || low[1] < -0.5 || high[0] > size[0] + 0.5 || high[1] > size[1] + 0.5)
		return fault_say(
			fault, -EINVAL,
			"the patch from %.0f,%.0f to %.0f,%.0f reaches beyond the picture of %dx%d",
			low[0], low[1], high[0], high[1], size[0], size[1]);
	for (int c = 0; c < 2; c++) {
		low[c] = floor(fmax(low[c], 0));
		high[c] = fmin(high[c], size[c]);
	}
	for (int y = (int)low[1]; y < high[1]; y++)
		for (int x = (int)low[0]; x < high[0]; x++) {
			if (area_holds(area, x + 0.5, y + 0.5))
				sums_add_pixel(&sums, picture, decode,
					       3 * ((size_t)y * (size_t)picture->width + (size_t)x),
					       2 * (y + 0.5 > middle[1]) + (x + 0.5 > middle[0]));
		}
	if (sums.count[0] + sums.count[1] + sums.count[2] + sums.count[3] < 16)
		return fault_say(fault, -EINVAL,
				 "the patch holds fewer than 16 pixels of the picture of %dx%d",
				 picture->width, picture->height);
	patch_finish(patch, &sums);
	return 0;
}
