/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_samples.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CLIPPED 255
#define FLAT 0.05     /* variance below which a block was made flat by compression */
#define DARK 2.0      /* codes from the black level that compression and rounding may make */
#define PLATEAU 0.005 /* share of pixels at the brightest codes that tells where a camera clips */
#define DARK_PLATEAU 0.05 /* the same at the darkest codes, of which there are more anyway */
#define PLATEAU_CODES 2	  /* codes that those may differ by */
#define LEVELS 24	  /* classes of mean code values */
#define PER_LEVEL 8	  /* blocks kept for each class, channel and exposure */
#define FEW_EXPOSURES 6	  /* with more of them, fewer blocks are kept of each */
#define BLOCKS_MOST                                                                                \
	20000 /* of a picture: larger ones are sampled in every second row and column ... */
#define PIXELS (LIGHT_BLOCK * LIGHT_BLOCK)

static int check_sample_pictures(const struct image *const *pictures, int exposures, double black,
				 struct fault *fault)
{
	if (exposures < 1 || exposures > LIGHT_EXPOSURES_MAX)
		return fault_say(fault, -EINVAL, "there are %d pictures, expected 1 to %d",
				 exposures, LIGHT_EXPOSURES_MAX);
	if (!(black >= 0 && black <= 254))
		return fault_say(fault, -EINVAL, "the black level is %g, expected 0 to 254", black);
	for (int j = 0; j < exposures; j++) {
		if (!pictures[j]->u8)
			return fault_say(fault, -EINVAL,
					 "picture %d holds linear light, expected an 8-bit picture",
					 j + 1);
		if (pictures[j]->width != pictures[0]->width ||
		    pictures[j]->height != pictures[0]->height)
			return fault_say(
				fault, -EINVAL,
				"picture %d is %dx%d pixels, the first one %dx%d; expected one size",
				j + 1, pictures[j]->width, pictures[j]->height, pictures[0]->width,
				pictures[0]->height);
	}
	return 0;
}

/*
 * Variance of a mean from rounding: of the first term of the Fourier series of the rounding error,
 *     (1 / pi) sin(2 pi code)
 * attenuated by noise of the variance s2 (Widrow).
 */
static double rounding_variance(double s2)
{
	return exp(-4 * M_PI * M_PI * s2) / (2 * M_PI * M_PI);
}

/* Measures a block in exposure j, and whether it is good. */
static void measure_block(struct light_samples *all, struct light_sample *s,
			  const struct image *picture, int j)
{
	const double unit = 1 / (255 - all->black);
	double sum = 0, squares = 0, mean, spread, noise;
	int top = 0;

	for (int y = 0; y < LIGHT_BLOCK; y++) {
		const uint8_t *row =
			picture->u8 +
			3 * ((size_t)(s->y + y) * (size_t)picture->width + (size_t)s->x) +
			s->channel;

		for (int x = 0; x < LIGHT_BLOCK; x++) {
			const int code = row[3 * x];

			sum += code;
			squares += code * code;
			top = code > top ? code : top;
		}
	}
	mean = sum / PIXELS;
	spread = fmax(squares / PIXELS - mean * mean, 0) * PIXELS / (PIXELS - 1);
	noise = fmax(spread - 1.0 / 12, 0);
	s->mean[j] = (mean - all->black) * unit;
	s->noise[j] = noise * unit * unit;
	s->variance[j] = (spread / PIXELS + rounding_variance(noise)) * unit * unit;
	s->good[j] = false;
	if (top >= all->white)
		all->clipped[j]++;
	else if (mean - all->black < fmax(3 * sqrt(spread) + 0.5, spread < FLAT ? DARK : 0))
		all->dark[j]++;
	else
		s->good[j] = true;
}

static int add_block_sample(struct light_samples *all, const struct light_sample *sample)
{
	if (all->count == all->room) {
		const int room = all->room ? 2 * all->room : 1024;
		struct light_sample *more = realloc(all->sample, (size_t)room * sizeof(*more));

		if (!more)
			return -ENOMEM;
		all->sample = more;
		all->room = room;
	}
	all->sample[all->count++] = *sample;
	return 0;
}

/* The brightest code of a picture that ends in a plateau there, without its outermost pixels; 0: it
 * does not. */
static int plateau_of(const struct image *picture)
{
	const size_t values = 3 * (size_t)picture->width * (size_t)picture->height;
	size_t count[256] = {0}, above = 0;
	int top = 255;

	for (size_t i = 0; i < values; i++)
		count[picture->u8[i]]++;
	while (top > 0 && (double)(above += count[top]) < 1e-4 * (double)values)
		top--;
	for (int c = top - 1; c >= 0 && c >= top - PLATEAU_CODES; c--)
		above += count[c];
	return (double)above > PLATEAU * (double)values ? top : 0;
}

/*
 * The code from which pixels are clipped: 255, or below it where two pictures end in the same
 * plateau, because a camera's own processing ends below 255, and compression makes it uneven. One
 * alone may be a bright surface.
 */
static int find_white(const struct image *const *pictures, int exposures)
{
	int white = CLIPPED, top[LIGHT_EXPOSURES_MAX];

	for (int j = 0; j < exposures; j++) {
		top[j] = plateau_of(pictures[j]);
		for (int k = 0; k < j; k++)
			if (top[j] < CLIPPED && top[j] > CLIPPED / 2 && abs(top[j] - top[k]) <= 1)
				white = top[j] - PLATEAU_CODES < white ? top[j] - PLATEAU_CODES
								       : white;
	}
	return white;
}

double light_darkest_code(const struct image *picture)
{
	const size_t values = 3 * (size_t)picture->width * (size_t)picture->height;
	size_t count[256] = {0}, below = 0, within = 0;
	double sum = 0;
	int least = 0;

	for (size_t i = 0; i < values; i++)
		count[picture->u8[i]]++;
	while (least < 255 && (double)(below += count[least]) < 1e-4 * (double)values)
		least++;
	for (int c = least; c < 255 && c <= least + PLATEAU_CODES; c++) {
		within += count[c];
		sum += (double)c * (double)count[c];
	}
	return (double)within > DARK_PLATEAU * (double)values ? rint(sum / (double)within) : 0;
}

static int measure_all(struct light_samples *all, const struct image *const *pictures)
{
	const double blocks = (double)pictures[0]->width * pictures[0]->height / PIXELS;
	const int step = LIGHT_BLOCK * (int)fmax(1, ceil(sqrt(blocks / BLOCKS_MOST)));
	const int across = (pictures[0]->width - LIGHT_BLOCK) / step + 1;
	const int down = (pictures[0]->height - LIGHT_BLOCK) / step + 1;
	const double share = 1 / fmax(3.0 * across * down, 1);

	for (int k = 0; k < across * down * 3; k++) {
		struct light_sample s = {
			.channel = k % 3, .x = k / 3 % across * step, .y = k / 3 / across * step};
		int good = 0;

		for (int j = 0; j < all->exposures; j++) {
			measure_block(all, &s, pictures[j], j);
			good += s.good[j];
		}
		if (good >= 2 && add_block_sample(all, &s) < 0)
			return -ENOMEM;
	}
	for (int j = 0; j < all->exposures; j++) {
		all->clipped[j] *= share;
		all->dark[j] *= share;
	}
	return 0;
}

/* ---- choosing ---- */

struct candidate {
	int sample;
	double spread;
};

static int by_spread(const void *a, const void *b)
{
	const struct candidate *p = a, *q = b;

	if (p->spread != q->spread)
		return p->spread < q->spread ? -1 : 1;
	return p->sample - q->sample;
}

/* Marks the most uniform blocks of one channel whose mean in exposure j is in one class. */
static void mark_chosen(const struct light_samples *all, int channel, int j, int level,
			struct candidate *room, bool *kept)
{
	const int most = all->exposures > FEW_EXPOSURES
				 ? (PER_LEVEL * FEW_EXPOSURES + all->exposures - 1) / all->exposures
				 : PER_LEVEL;
	int count = 0;

	for (int i = 0; i < all->count; i++) {
		const struct light_sample *s = &all->sample[i];

		if (s->channel == channel && s->good[j] && (int)(s->mean[j] * LEVELS) == level)
			room[count++] = (struct candidate){i, s->variance[j]};
	}
	qsort(room, (size_t)count, sizeof(*room), by_spread);
	for (int k = 0; k < count && k < most; k++)
		kept[room[k].sample] = true;
}

static int choose_samples(struct light_samples *all)
{
	struct candidate *room = calloc((size_t)all->count + 1, sizeof(*room));
	bool *kept = calloc((size_t)all->count + 1, sizeof(*kept));
	int count = 0;

	if (room && kept) {
		for (int k = 0; k < 3 * all->exposures * LEVELS; k++)
			mark_chosen(all, k % 3, k / 3 % all->exposures, k / 3 / all->exposures,
				    room, kept);
		for (int i = 0; i < all->count; i++)
			if (kept[i])
				all->sample[count++] = all->sample[i];
		all->count = count;
	}
	free(room);
	free(kept);
	return room && kept ? 0 : -ENOMEM;
}

/* Averages the noise of blocks of similar brightness: one block's own spread gives it only to a
 * tenth, and would favour blocks that look calm by chance. */
static void pool_noise(struct light_samples *all, int j)
{
	double noise[LEVELS] = {0}, variance[LEVELS] = {0};
	int count[LEVELS] = {0};

	for (int i = 0; i < all->count; i++) {
		const struct light_sample *s = &all->sample[i];
		const int level = (int)(s->mean[j] * LEVELS);

		if (!s->good[j])
			continue;
		noise[level] += s->noise[j];
		variance[level] += s->variance[j];
		count[level]++;
	}
	for (int i = 0; i < all->count; i++) {
		struct light_sample *s = &all->sample[i];
		const int level = (int)(s->mean[j] * LEVELS);

		if (!s->good[j])
			continue;
		s->noise[j] = noise[level] / count[level];
		s->variance[j] = variance[level] / count[level];
	}
}

int light_samples_create(struct light_samples *all, const struct image *const *pictures,
			 int exposures, double black, struct fault *fault)
{
	int ret;

	*all = (struct light_samples){.exposures = exposures, .black = black};
	ret = check_sample_pictures(pictures, exposures, black, fault);
	if (ret < 0)
		return ret;
	all->white = find_white(pictures, exposures);
	ret = measure_all(all, pictures);
	if (ret == 0)
		ret = choose_samples(all);
	if (ret < 0) {
		light_samples_free(all);
		return fault_say(fault, ret, "not enough memory for the pictures' blocks");
	}
	for (int j = 0; j < exposures; j++)
		pool_noise(all, j);
	return 0;
}

void light_samples_free(struct light_samples *all)
{
	free(all->sample);
	memset(all, 0, sizeof(*all));
}
