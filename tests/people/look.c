/* SPDX-License-Identifier: MIT */
/*
 * Judges whether the object looks taken by the background's camera: against the same object really
 * present in the simulated studio, through the same lens and sensor. README.md says what the
 * figures are.
 *     look SHARP.inlay SOFT.inlay
 * SHARP is baked without edge spread, SOFT with SPREAD_PX.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/look/exposure.h"
#include "hal/look/flicker.h"
#include "hal/look/grain_tables.h"
#include "hal/look/sensor_noise.h"
#include "tests/people/filmed.h"

#define SPREAD_PX 0.8
#define EXPOSURE 0.8
#define EXPOSURE_STEP 1.16
#define RED_STEP 1.10
#define BLUE_STEP 0.92

enum {
	RATE_HZ = 15,
	LEARNING = 600,
	STILL = 150,
	LEVELS = 8,
	AROUND = 6,
	MOST = 4096,
	QUIET = 300
};

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

static void die(const char *what)
{
	fprintf(stderr, "look: %s\n", what);
	exit(1);
}

static void *room(size_t bytes)
{
	void *p = calloc(bytes, 1);

	if (!p)
		die("not enough memory");
	return p;
}

/* A basis and what composites it. */
struct shown {
	struct basis basis;
	struct compositor *compositor;
	struct light_selection lights;
};

struct look {
	struct shown sharp, soft;
	struct dome dome;
	struct tsai_camera camera;
	struct filmed filmed;
	struct exposure *exposure;
	struct flicker *flicker;
	const int32_t (*rows)[3]; /* of the object; NULL: all are lit alike */
	struct sensor_noise *noise;
	struct grain_tables tables;
	struct grain grain;
	bool grained;
	int pixels;
	uint8_t *ours, *real, *empty;
	float *present;		    /* linear light with the object in the room */
	double *on_black, *on_grey; /* code values of the reference */
	double *unlit;		    /* linear light of the object without the panels */
};

static void shown_open(struct shown *s, const char *path)
{
	struct fault fault = {""};

	if (basis_open(&s->basis, path, BASIS_SHOWN, &fault) ||
	    compositor_create(&s->compositor, &s->basis, &(struct compositor_options){0}, &fault) ||
	    compositor_take_pose(s->compositor, 0, &fault))
		die(fault.text);
	if (light_selection_create(&s->lights, &s->basis))
		die("not enough memory");
}

static void shown_close(struct shown *s)
{
	light_selection_free(&s->lights);
	compositor_destroy(s->compositor);
	basis_close(&s->basis);
}

static void look_open(struct look *l, const char *sharp, const char *soft)
{
	struct fault fault = {""};

	memset(l, 0, sizeof(*l));
	shown_open(&l->sharp, sharp);
	shown_open(&l->soft, soft);
	if (tsai_read_text(l->sharp.basis.camera, &l->camera, &fault) ||
	    dome_create(&l->dome, (int)l->sharp.basis.info.dome_frequency, &fault))
		die(fault.text);
	l->pixels = l->camera.width * l->camera.height;
	if (exposure_create(&l->exposure, l->camera.width, l->camera.height, &srgb, &l->dome) ||
	    flicker_create(&l->flicker, l->camera.width, l->camera.height, &srgb) ||
	    sensor_noise_create(&l->noise, l->camera.width, l->camera.height, &srgb) ||
	    filmed_open(&l->filmed, &l->camera, &l->dome))
		die("not enough memory");
	l->ours = room((size_t)l->pixels * 4);
	l->real = room((size_t)l->pixels * 4);
	l->empty = room((size_t)l->pixels * 4);
	l->present = room((size_t)l->pixels * 3 * sizeof(float));
	l->on_black = room((size_t)l->pixels * 3 * sizeof(double));
	l->on_grey = room((size_t)l->pixels * 3 * sizeof(double));
	l->unlit = room((size_t)l->pixels * 3 * sizeof(double));
}

static void look_close(struct look *l)
{
	exposure_destroy(l->exposure);
	flicker_destroy(l->flicker);
	sensor_noise_destroy(l->noise);
	filmed_close(&l->filmed);
	dome_free(&l->dome);
	shown_close(&l->sharp);
	shown_close(&l->soft);
	free(l->ours);
	free(l->real);
	free(l->empty);
	free(l->present);
	free(l->on_black);
	free(l->on_grey);
	free(l->unlit);
}

static struct picture as_picture(const struct look *l, const uint8_t *bgrx)
{
	return (struct picture){.origin = bgrx,
				.x_step = 4,
				.y_step = (ptrdiff_t)l->camera.width * 4,
				.width = l->camera.width,
				.height = l->camera.height};
}

static void choose(struct look *l, struct shown *s, const double gain[3])
{
	light_selection_choose(&s->lights, &s->basis, 0, (const float(*)[3])l->filmed.light, 0,
			       THRESHOLD_DROP, 1);
	for (int i = 0; i < s->lights.count; i++)
		for (int c = 0; c < 3; c++)
			s->lights.radiance[i][c] *= gain[c];
}

static void reference(struct look *l, int code, double *out)
{
	const struct compositor_settings settings = {
		.background = srgb, .output = srgb, .gain = 1, .object = true};
	const struct picture picture = as_picture(l, l->empty);

	memset(l->empty, code, (size_t)l->pixels * 4);
	if (compositor_reference(&l->sharp.basis, 0, &settings, &l->sharp.lights, &picture, out))
		die("cannot composite");
}

/*
 * The object really present: O + k B in linear light, with the camera's true exposure, sharp; then
 * the camera's lens and sensor. O and k are of the reference, in double precision, on black and on
 * grey.
 */
static void take_real(struct look *l, const struct filmed_moment *moment)
{
	const double grey = transfer_decode(TRANSFER_SRGB, 128 / 255.0);

	choose(l, &l->sharp, moment->exposure);
	reference(l, 0, l->on_black);
	reference(l, 128, l->on_grey);
	for (int i = 0; i < 3 * l->pixels; i++) {
		const double o = transfer_decode(TRANSFER_SRGB, l->on_black[i] / 255);
		const double row = filmed_row(moment, i / 3 / l->camera.width, l->camera.height);
		const double k = (transfer_decode(TRANSFER_SRGB, l->on_grey[i] / 255) - o) / grey;

		l->present[i] = (float)(o + (row - 1) * (o - l->unlit[i]) +
					k * (double)l->filmed.ground[i]);
	}
	filmed_take_other(&l->filmed, moment, l->present, l->real);
}

static void composite(struct look *l, struct shown *s, const double gain[3], bool grain,
		      uint8_t *out)
{
	const struct compositor_settings settings = {.background = srgb,
						     .output = srgb,
						     .gain = 1,
						     .object = true,
						     .rows = l->rows,
						     .grain = grain && l->grained ? &l->grain
										  : NULL};
	const struct picture picture = as_picture(l, l->filmed.bgrx);
	const struct backdrop backdrop = backdrop_of(&picture);

	choose(l, s, gain);
	compositor_set(s->compositor, &settings);
	if (compositor_run(s->compositor, 0, &s->lights, &backdrop, out,
			   (size_t)l->camera.width * 4))
		die("cannot composite");
}

/* ---- frames ---- */

static struct filmed_moment moment_at(int frame)
{
	return (struct filmed_moment){.time_s = (double)frame / RATE_HZ,
				      .number = frame,
				      .exposure = {EXPOSURE, EXPOSURE, EXPOSURE},
				      .edge_spread_px = SPREAD_PX};
}

/* Films a moment and looks at it. gain becomes what the object follows. */
static void see(struct look *l, const struct filmed_moment *moment, double gain[3])
{
	struct sensor_noise_model model;
	struct picture picture;
	float expected[3];

	if (filmed_take(&l->filmed, moment))
		die("not enough memory");
	picture = as_picture(l, l->filmed.bgrx);
	exposure_look(l->exposure, &picture, (const float(*)[3])l->filmed.light);
	exposure_expected(l->exposure, expected);
	flicker_look(l->flicker, &picture, expected);
	l->rows = flicker_rows(l->flicker);
	sensor_noise_watch(l->noise, &picture);
	l->grain.seed = (uint64_t)moment->number;
	if (moment->number % 25 == 0 && sensor_noise_fit(l->noise, &model)) {
		grain_tables_fit(&l->tables, &model, &l->grain);
		l->grained = true;
	}
	exposure_gain(l->exposure, gain);
	for (int c = 0; c < 3; c++)
		gain[c] *= EXPOSURE;
}

static bool is_inside(const struct look *l, int k)
{
	return l->soft.basis.poses[0].coverage[k] == 65535;
}

/* ---- noise and edges, of a still room ---- */

struct still {
	uint8_t *before[3];	  /* of the object really there, ours, ours without grain */
	double *mean[3];	  /* [h][w][3], code values; the last one: ours baked sharp */
	double square[3][LEVELS]; /* sums of squares of differences of successive frames */
	long count[LEVELS];
	int frames;
};

static void still_note(struct look *l, struct still *s, uint8_t *const picture[3],
		       const uint8_t *sharp)
{
	for (int k = 0; k < l->pixels; k++)
		for (int c = 0; c < 3; c++) {
			const int at = 4 * k + c, level = picture[0][at] * LEVELS / 256;

			for (int m = 0; m < 3; m++) {
				const double d = picture[m][at] - s->before[m][at];

				s->mean[m][3 * k + c] += m < 2 ? picture[m][at] : sharp[at];
				if (s->frames && is_inside(l, k))
					s->square[m][level] += d * d;
			}
			if (s->frames && is_inside(l, k))
				s->count[level]++;
		}
	for (int m = 0; m < 3; m++)
		memcpy(s->before[m], picture[m], (size_t)l->pixels * 4);
	s->frames++;
}

static void print_noise(const struct still *s)
{
	printf("| noise of the object / noise if it were there, by level |");
	for (int v = 0; v < LEVELS; v++)
		if (s->count[v] > 2000)
			printf(" %d: %.2f", v * 256 / LEVELS + 128 / LEVELS,
			       sqrt(s->square[1][v] / s->square[0][v]));
	printf(" | 0.9 to 1.1 | without grain:");
	for (int v = 0; v < LEVELS; v++)
		if (s->count[v] > 2000)
			printf(" %.2f", sqrt(s->square[2][v] / s->square[0][v]));
	printf(" |\n");
}

static int by_size(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Across an outline that a row crosses: sum of squared steps of linear light, which of a blurred
 * edge is its height squared over its width. 0: the row goes on to another edge. */
static double edge_steps(const struct look *l, const double *mean, int frames, int k)
{
	double sum = 0;

	for (int x = k - AROUND; x < k + AROUND; x++) {
		double step = 0;

		for (int c = 0; c < 3; c++)
			step += transfer_decode(TRANSFER_SRGB,
						mean[3 * (x + 1) + c] / frames / 255) -
				transfer_decode(TRANSFER_SRGB, mean[3 * x + c] / frames / 255);
		sum += step * step;
	}
	(void)l;
	return sum;
}

/* Whether the row crosses the outline at k, and nothing else of it near by. */
static bool is_outline(const struct look *l, int k)
{
	const uint16_t *coverage = l->sharp.basis.poses[0].coverage;
	const int x = k % l->camera.width;
	const bool in = coverage[k + AROUND] > 0;

	if (x < AROUND || x >= l->camera.width - AROUND - 1)
		return false;
	for (int i = 1; i <= AROUND; i++)
		if (coverage[k + i] != (in ? 65535 : 0) || coverage[k - i] != (in ? 0 : 65535))
			return false;
	return true;
}

/* Median over outlines of real / ours: the ratio of widths, ours to real. */
static void print_edges(const struct look *l, const struct still *s)
{
	static double ratio[2][MOST];
	int count = 0;

	for (int k = AROUND; k < l->pixels - AROUND - 1 && count < MOST; k++) {
		double real, ours, sharp;

		if (!is_outline(l, k))
			continue;
		real = edge_steps(l, s->mean[0], s->frames, k);
		ours = edge_steps(l, s->mean[1], s->frames, k);
		sharp = edge_steps(l, s->mean[2], s->frames, k);
		if (real < 1e-3)
			continue;
		ratio[0][count] = real / ours;
		ratio[1][count++] = real / sharp;
	}
	for (int m = 0; m < 2; m++)
		qsort(ratio[m], (size_t)count, sizeof(double), by_size);
	if (!count)
		die("no row crosses the outline");
	printf("| width of its edges / width if it were there (median of %d) | %.2f | 0.9 to 1.1 | baked sharp: %.2f |\n",
	       count, ratio[0][count / 2], ratio[1][count / 2]);
}

static void judge_still(struct look *l, int from)
{
	uint8_t *plain = room((size_t)l->pixels * 4), *sharp = room((size_t)l->pixels * 4);
	uint8_t *const picture[3] = {l->real, l->ours, plain};
	const double gain[3] = {EXPOSURE, EXPOSURE, EXPOSURE};
	struct still s = {.frames = 0};

	for (int m = 0; m < 3; m++) {
		s.before[m] = room((size_t)l->pixels * 4);
		s.mean[m] = room((size_t)l->pixels * 3 * sizeof(double));
	}
	for (int frame = from; frame < from + STILL; frame++) {
		struct filmed_moment moment = moment_at(frame);
		double followed[3];

		moment.time_s = (double)from / RATE_HZ;
		see(l, &moment, followed);
		take_real(l, &moment);
		composite(l, &l->soft, gain, true, l->ours);
		composite(l, &l->soft, gain, false, plain);
		composite(l, &l->sharp, gain, true, sharp);
		still_note(l, &s, picture, sharp);
	}
	print_noise(&s);
	print_edges(l, &s);
	for (int m = 0; m < 3; m++) {
		free(s.before[m]);
		free(s.mean[m]);
	}
	free(plain);
	free(sharp);
}

/* ---- exposure ---- */

/* Largest over channels of the mean difference inside of the object, in levels. */
static double colour_off(const struct look *l)
{
	double most = 0;

	for (int c = 0; c < 3; c++) {
		double sum = 0;
		int count = 0;

		for (int k = 0; k < l->pixels; k++)
			if (is_inside(l, k)) {
				sum += l->ours[4 * k + c] - l->real[4 * k + c];
				count++;
			}
		most = fmax(most, fabs(sum / count));
	}
	return most;
}

/* The difference in the frame before a step, and in frames 0, 1, 2 and 5 after it; with and without
 * following. */
static void judge_step(struct look *l, int from, const char *what, const double step[3])
{
	static const int shown[] = {-1, 0, 1, 2, 5};
	double followed[5], fixed[5];
	const double still[3] = {EXPOSURE, EXPOSURE, EXPOSURE};

	for (int i = -30, n = 0; i <= 5; i++) {
		struct filmed_moment moment = moment_at(from + i);
		double gain[3];

		for (int c = 0; c < 3; c++)
			moment.exposure[c] *= i >= 0 ? step[c] : 1;
		see(l, &moment, gain);
		if (i != shown[n])
			continue;
		take_real(l, &moment);
		composite(l, &l->soft, gain, true, l->ours);
		followed[n] = colour_off(l);
		composite(l, &l->soft, still, true, l->ours);
		fixed[n++] = colour_off(l);
	}
	printf("| %s, levels, frames -1 0 1 2 5 |", what);
	for (int n = 0; n < 5; n++)
		printf(" %.2f", followed[n]);
	printf(" | 1 from frame 2 | not followed:");
	for (int n = 0; n < 5; n++)
		printf(" %.2f", fixed[n]);
	printf(" |\n");
}

/* Lamps that both cameras see: the largest change of the gain, in percent, and the colour's
 * difference. */
static void judge_lamps(struct look *l, int from)
{
	double least = INFINITY, most = 0, off = 0;

	for (int i = -30; i <= 60; i++) {
		struct filmed_moment moment = moment_at(from + i);
		double gain[3];

		/* The panels go off at i = 0, and on again at 30. */
		if (i >= 0 && i < 30)
			moment.switch_s = moment.time_s / 1.5;
		see(l, &moment, gain);
		if (i < -1)
			continue;
		for (int c = 0; c < 3; c++) {
			least = fmin(least, gain[c] / EXPOSURE);
			most = fmax(most, gain[c] / EXPOSURE);
		}
		if (i % 10 == 2) {
			take_real(l, &moment);
			composite(l, &l->soft, gain, true, l->ours);
			off = fmax(off, colour_off(l));
		}
	}
	printf("| lamps switched off and on: gain taken for exposure, and colour | %.3f to %.3f, %.2f levels | 1, 1 level | |\n",
	       least, most, off);
}

/* ---- flicker ---- */

/* Lamps that flicker in a rolling shutter of 16 ms; panels: they alone, a sixth of the object's
 * light. */
struct flickering {
	struct mains mains;
	bool panels;
};

static const struct flickering flickering[] = {
	{{0.1, 50, 1 / 500.0, 0.016}, false},
	{{0.3, 50, 1 / 500.0, 0.016}, false},
	{{0.3, 50, 1 / 120.0, 0.016}, false},
	{{0.3, 50, 1 / 500.0, 0.016}, true},
};

/* The object's light without the panels, which are off in that frame. */
static void note_unlit(struct look *l, struct filmed_moment moment)
{
	moment.switch_s = moment.time_s / 1.5;
	if (filmed_take(&l->filmed, &moment))
		die("not enough memory");
	choose(l, &l->sharp, moment.exposure);
	reference(l, 0, l->unlit);
	for (int i = 0; i < 3 * l->pixels; i++)
		l->unlit[i] = transfer_decode(TRANSFER_SRGB, l->unlit[i] / 255);
}

/* Adds the squares of differences of means over eight rows inside of the object, largest over
 * channels. */
static void rows_off(const struct look *l, double *square, int *count)
{
	for (int from = 0; from + 8 <= l->camera.height; from += 8) {
		double sum[3] = {0}, most = 0;
		int pixels = 0;

		for (int k = from * l->camera.width; k < (from + 8) * l->camera.width; k++) {
			for (int c = 0; is_inside(l, k) && c < 3; c++)
				sum[c] += l->ours[4 * k + c] - l->real[4 * k + c];
			pixels += is_inside(l, k);
		}
		if (pixels < 100)
			continue;
		for (int c = 0; c < 3; c++)
			most = fmax(most, fabs(sum[c] / pixels));
		*square += most * most;
		++*count;
	}
}

/* Lamps that flicker: how far rows of the object are off, with and without following. */
static void judge_flicker(struct look *l, int from, const struct flickering *f)
{
	const double still[3] = {EXPOSURE, EXPOSURE, EXPOSURE};
	double followed = 0, fixed = 0;
	int count = 0, same = 0;

	memset(l->unlit, 0, (size_t)l->pixels * 3 * sizeof(double));
	for (int i = -60; i < 30; i++) {
		struct filmed_moment moment = moment_at(from + i);
		const bool judged = i >= 0 && i % 3 != 1;
		double gain[3];

		if (judged && f->panels)
			note_unlit(l, moment);
		moment.mains = f->mains;
		moment.all_flicker = !f->panels;
		see(l, &moment, gain);
		if (!judged)
			continue;
		take_real(l, &moment);
		composite(l, &l->soft, gain, true, l->ours);
		rows_off(l, &followed, &count);
		l->rows = NULL;
		composite(l, &l->soft, still, true, l->ours);
		rows_off(l, &fixed, &same);
	}
	printf("| %s flicker by %g, rows exposed for 1/%.0f s: 8 rows' colour, levels RMS | %.2f | 1.5 | not followed: %.2f |\n",
	       f->panels ? "the panels" : "all lamps", f->mains.depth, 1 / f->mains.shutter_s,
	       sqrt(followed / count), sqrt(fixed / same));
}

/* People who walk, while lamps do not flicker. */
static void judge_no_flicker(struct look *l, int from)
{
	int found = 0;

	for (int i = 0; i < QUIET; i++) {
		struct filmed_moment moment = moment_at(from + i);
		double gain[3];

		moment.walkers = walkers_at(moment.time_s, 2, moment.walker);
		moment.switch_s = 5;
		see(l, &moment, gain);
		found += l->rows != NULL;
	}
	printf("| frames in which they seem to flicker, while two people walk and lamps are switched | %d of %d | 0 | |\n",
	       found, QUIET);
}

int main(int argc, char **argv)
{
	static const double exposure[3] = {EXPOSURE_STEP, EXPOSURE_STEP, EXPOSURE_STEP};
	static const double white[3] = {RED_STEP, 1, BLUE_STEP};
	struct look look;
	int frame = 0;

	if (argc != 3)
		die("expected SHARP.inlay SOFT.inlay");
	look_open(&look, argv[1], argv[2]);
	for (; frame < LEARNING; frame++) {
		const struct filmed_moment moment = moment_at(frame);
		double gain[3];

		see(&look, &moment, gain);
	}
	printf("| figure | with the camera's look | asked | without |\n|---|---|---|---|\n");
	judge_still(&look, frame);
	frame += STILL + 30;
	judge_step(&look, frame, "colour after exposure x 1.16", exposure);
	frame += 60;
	judge_step(&look, frame, "colour after red x 1.10, blue x 0.92", white);
	frame += 60;
	judge_lamps(&look, frame);
	frame += 100;
	judge_no_flicker(&look, frame);
	for (size_t n = 0; n < sizeof(flickering) / sizeof(*flickering); n++)
		judge_flicker(&look, frame += QUIET, &flickering[n]);
	look_close(&look);
	return 0;
}
