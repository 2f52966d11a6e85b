/* SPDX-License-Identifier: MIT */
#include "hal/lights/lamp/lamp_find.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

/* A lamp is a hundred times as bright as what it lights; the glow on a lit ceiling around it is not
 * four times as bright as the ceiling. */
#define CONTRAST 4
/* Beside a spot of a thousandth of its brightness an eye that sees the brightest one sees its glare. */
#define LEAST_OF_BRIGHTEST 1e-3F
/* Most pixels whose median is taken, with a deviation of 8 % of theirs; qsort() needs memory for
 * more than 1 KB. */
#define SURROUNDINGS 250
/* A light that is on stands out by more than a wall's pattern does. */
#define SHINES 1.5

void lamp_finder_free(struct lamp_finder *finder)
{
	free(finder->mark);
	free(finder->list);
	*finder = (struct lamp_finder){.pixels = 0};
}

static int finder_grow(struct lamp_finder *finder, int pixels)
{
	if (pixels <= finder->pixels)
		return 0;
	lamp_finder_free(finder);
	finder->mark = malloc((size_t)pixels);
	finder->list = malloc(2 * (size_t)pixels * sizeof(*finder->list));
	if (!finder->mark || !finder->list) {
		lamp_finder_free(finder);
		return -ENOMEM;
	}
	finder->pixels = pixels;
	return 0;
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

static float median_of(float *value, int count)
{
	if (!count)
		return 0;
	qsort(value, (size_t)count, sizeof(*value), compare_floats);
	return value[count / 2];
}

static bool is_seen(const struct lamp_picture *p, int x, int y)
{
	const struct fisheye *lens = p->lens;
	const double u = (x + 0.5 - lens->centre_px[0]) / lens->focal_px[0];
	const double v = (y + 0.5 - lens->centre_px[1]) / lens->focal_px[1];

	return x >= 0 && x < p->width && y >= 0 && y < p->height &&
	       u * u + v * v < lens->rim * lens->rim;
}

static float light_at(const struct lamp_picture *p, int x, int y)
{
	return p->light[y * p->width + x];
}

/* The median of a ring around a point; of a few hundred pixels, if it has more. */
static float ring_median(const struct lamp_picture *p, const double px[2], double from, double to)
{
	float value[SURROUNDINGS];
	const int step = 1 + (int)sqrt(M_PI * (to * to - from * from) / SURROUNDINGS);
	int count = 0;

	for (int y = (int)(px[1] - to); y <= px[1] + to; y += step)
		for (int x = (int)(px[0] - to); x <= px[0] + to; x += step) {
			const double apart = hypot(x + 0.5 - px[0], y + 0.5 - px[1]);

			if (apart >= from && apart < to && is_seen(p, x, y) && count < SURROUNDINGS)
				value[count++] = light_at(p, x, y);
		}
	return median_of(value, count);
}

/* ---- where a spot may be ---- */

enum { UNSEEN, SEEN, TAKEN, LAST };

static float sky_median(const struct lamp_picture *p, const uint8_t *mark)
{
	const int pixels = p->width * p->height;
	float value[SURROUNDINGS];
	int count = 0, seen = 0, step;

	for (int i = 0; i < pixels; i++)
		seen += mark[i] == SEEN;
	step = 1 + seen / SURROUNDINGS;
	for (int i = 0, at = 0; i < pixels; i++)
		if (mark[i] == SEEN && at++ % step == 0)
			value[count++] = p->light[i];
	return median_of(value, count);
}

/* Whether a pixel comes before another: the brightest first; of equals the first. */
static bool comes_first(const float *light, int a, int b)
{
	return light[a] != light[b] ? light[a] > light[b] : a < b;
}

/* Heapsort, which needs no memory. */
static void sort_pixels(const float *light, int *list, int count)
{
	for (int root = count / 2 - 1, end = count; end > 1;) {
		int at = root, child;

		if (root < 0) {
			const int last = list[--end];

			list[end] = list[0];
			list[0] = last;
			at = 0;
		} else {
			root--;
		}
		for (; (child = 2 * at + 1) < end; at = child) {
			const int above = list[at];

			if (child + 1 < end && comes_first(light, list[child], list[child + 1]))
				child++;
			if (comes_first(light, list[child], above))
				break;
			list[at] = list[child];
			list[child] = above;
		}
	}
}

/* Lists the pixels that none of their neighbours outshines, the brightest first. */
static int list_peaks(const struct lamp_picture *p, struct lamp_finder *finder)
{
	const int w = p->width;
	float least = 0;
	int count = 0;

	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < w; x++) {
			const bool seen = is_seen(p, x, y);

			finder->mark[y * w + x] = seen ? SEEN : UNSEEN;
			if (seen)
				least = fmaxf(least, LEAST_OF_BRIGHTEST * light_at(p, x, y));
		}
	least = fmaxf(least, CONTRAST * sky_median(p, finder->mark));
	for (int y = 1; y + 1 < p->height; y++)
		for (int x = 1; x + 1 < w; x++) {
			const int i = y * w + x;
			const float here = p->light[i];

			if (finder->mark[i] == SEEN && here > least && here >= p->light[i - 1] &&
			    here >= p->light[i + 1] && here >= p->light[i - w] &&
			    here >= p->light[i + w])
				finder->list[count++] = i;
		}
	sort_pixels(p->light, finder->list, count);
	return count;
}

/* ---- a spot ---- */

/* Fills list with the connected pixels around a peak that are at least half as bright, and marks
 * them. Returns how many; 0: they are part of what was filled before. */
static int fill_spot(const struct lamp_picture *p, uint8_t *mark, int peak, int *list)
{
	const int next[4] = {-1, 1, -p->width, p->width};
	const float half = fminf(p->light[peak], p->white) / 2;
	bool shoulder = false;
	int count = 1;

	list[0] = peak;
	mark[peak] = LAST;
	for (int done = 0; done < count; done++) {
		const int x = list[done] % p->width, y = list[done] / p->width;

		if (x == 0 || x + 1 == p->width || y == 0 || y + 1 == p->height)
			continue;
		for (int k = 0; k < 4; k++) {
			const int i = list[done] + next[k];

			shoulder |= mark[i] == TAKEN;
			if (mark[i] != SEEN || p->light[i] < half)
				continue;
			mark[i] = LAST;
			list[count++] = i;
		}
	}
	for (int k = 0; k < count; k++)
		mark[list[k]] = TAKEN;
	return shoulder ? 0 : count;
}

/* Sums radiance above the surroundings times solid angle over a disc in the picture. */
static double disc_flux(const struct lamp_picture *p, const double px[2], double reach,
			float around)
{
	double flux = 0;

	for (int y = (int)(px[1] - reach); y <= px[1] + reach; y++)
		for (int x = (int)(px[0] - reach); x <= px[0] + reach; x++) {
			const double at[2] = {x + 0.5, y + 0.5};

			if (hypot(at[0] - px[0], at[1] - px[1]) < reach && is_seen(p, x, y))
				flux += (double)(light_at(p, x, y) - around) *
					fisheye_pixel_sr(p->lens, at);
		}
	return flux;
}

/* Measures the spot of so many pixels. False: it is no lamp. */
static bool measure_spot(const struct lamp_picture *p, const int *list, int count,
			 struct lamp_spot *spot)
{
	const float peak = p->light[list[0]];
	const double radius_px = sqrt(count / M_PI);
	double sum = 0, sr = 0, solid_angle;
	float around;

	*spot = (struct lamp_spot){.clipped = peak >= p->white,
				   .resolved = count >= LAMP_SPOT_RESOLVED};
	for (int k = 0; k < count; k++) {
		const double at[2] = {list[k] % p->width + 0.5, list[k] / p->width + 0.5};
		const double light = (double)fminf(p->light[list[k]], p->white);
		struct fisheye_pixel pixel;

		if (!fisheye_pixel_of(p->lens, at, &pixel))
			continue;
		sum += light;
		sr += pixel.sr;
		for (int c = 0; c < 2; c++)
			spot->px[c] += light * at[c];
		for (int c = 0; c < 3; c++)
			spot->dir[c] += light * pixel.sr * pixel.dir[c];
	}
	if (!(sum > 0) || !(vec_normalize(spot->dir) > 0) ||
	    !(sr < 2 * M_PI * (1 - cos(LAMP_SPOT_RADIUS_MAX))))
		return false;
	for (int c = 0; c < 2; c++)
		spot->px[c] /= sum;
	around = ring_median(p, spot->px, 2 * radius_px + 2, 3 * radius_px + 5);
	if (peak < CONTRAST * around)
		return false;
	spot->pixel = sqrt(fisheye_pixel_sr(p->lens, spot->px));
	/* What the lens blurs out of the half-bright part belongs to the lamp. */
	spot->flux = disc_flux(p, spot->px, 1.5 * radius_px + 1.5, around);
	solid_angle = spot->clipped ? sr : fmin(spot->flux / (double)(peak - around), 2 * sr);
	spot->radius = acos(1 - solid_angle / (2 * M_PI));
	return spot->flux > 0;
}

/* Puts a spot in its place, the one of most flux first. Returns how many there are. */
static int insert_spot(struct lamp_spot *spot, int count, int most, const struct lamp_spot *found)
{
	int at = count < most ? count++ : most;

	for (; at > 0 && spot[at - 1].flux < found->flux; at--)
		if (at < most)
			spot[at] = spot[at - 1];
	if (at < most)
		spot[at] = *found;
	return count;
}

int lamp_find(struct lamp_finder *finder, const struct lamp_picture *picture,
	      struct lamp_spot *spot, int most)
{
	const int pixels = picture->width * picture->height;
	int peaks, count = 0;

	if (finder_grow(finder, pixels))
		return -ENOMEM;
	peaks = list_peaks(picture, finder);
	for (int k = 0; k < peaks; k++) {
		struct lamp_spot found;
		const int peak = finder->list[k];
		int *list = finder->list + pixels, filled;

		if (finder->mark[peak] != SEEN)
			continue;
		filled = fill_spot(picture, finder->mark, peak, list);
		if (filled && measure_spot(picture, list, filled, &found))
			count = insert_spot(spot, count, most, &found);
	}
	return count;
}

bool lamp_shines(const struct lamp_picture *p, const double dir[3], double within)
{
	double px[2], reach;
	float most = 0;

	if (!fisheye_project(p->lens, dir, px))
		return false;
	reach = within / sqrt(fisheye_pixel_sr(p->lens, px));
	for (int y = (int)(px[1] - reach); y <= px[1] + reach; y++)
		for (int x = (int)(px[0] - reach); x <= px[0] + reach; x++)
			if (hypot(x + 0.5 - px[0], y + 0.5 - px[1]) <= reach && is_seen(p, x, y))
				most = fmaxf(most, light_at(p, x, y));
	return most > SHINES * ring_median(p, px, 1.5 * reach, 2.5 * reach);
}
