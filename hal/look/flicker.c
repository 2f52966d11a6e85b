/* SPDX-License-Identifier: MIT */
#include "hal/look/flicker.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/look/median.h"

enum {
	BANDS = 32,
	POINTS = 128,		   /* points of a band */
	POINTS_LEAST = POINTS / 4, /* usable points that a band's gain needs */
	MEMORY = 16,		   /* frames over which means are taken */
	/* A point's M is usable after this many frames, the powers after one more, and flicker is
	 * found once it was there in this many successive frames. */
	BEGIN = 6
};

/* A point is used if its code value lies between these: darker ones are mostly noise, brighter ones
 * may be clipped. These and the constants above and below were chosen by trial; make look shows
 * their effect. */
#define DARKEST 12
#define BRIGHTEST 249
/* Rows are followed once the RMS of gain - 1 exceeds FOUND, until it falls below LOST. */
#define FOUND 0.012f
#define LOST 0.008f
/* Flicker's covariance between successive frames is below this share of its power. */
#define ALIKE 0.7f

struct flicker {
	int height;
	float decode[256];
	struct {
		int x, y;
		float mean[3]; /* M, linear light, R, G, B */
		int usable[3]; /* frames that M is the mean of, at most MEMORY */
	} point[BANDS][POINTS];
	int frames;		  /* number of frames so far, at most MEMORY */
	float gain[2][BANDS][3];  /* gain - 1 less standing, of this frame and of the one before */
	float standing[BANDS][3]; /* running mean of gain - 1: a pattern that does not move */
	float power;		  /* mean product of gains in adjacent bands */
	float covariance;	  /* mean product of gains in successive frames */
	int streak;		  /* successive frames that look like flicker */
	bool found;		  /* the streak is long enough */
	int32_t (*rows)[3];
};

int flicker_create(struct flicker **flicker, int width, int height,
		   const struct transfer_curve *curve)
{
	struct flicker *f = calloc(1, sizeof(*f));

	if (f)
		f->rows = calloc((size_t)height, sizeof(*f->rows));
	if (!f || !f->rows) {
		free(f);
		return -ENOMEM;
	}
	f->height = height;
	for (int i = 0; i < 256; i++)
		f->decode[i] = (float)transfer_curve_decode(curve, i / 255.0);
	/* Multiples of the plastic number's inverse powers are a low-discrepancy sequence, R2 of
	 * Roberts 2018: they cover each band evenly. */
	for (int b = 0; b < BANDS; b++)
		for (int i = 0; i < POINTS; i++) {
			const double x = fmod(0.5 + (b * POINTS + i) * 0.7548776662466927, 1);
			const double y = fmod(0.5 + (b * POINTS + i) * 0.5698402909980532, 1);

			f->point[b][i].x = (int)(x * width);
			f->point[b][i].y = (int)((b + y) * height / BANDS);
		}
	*flicker = f;
	return 0;
}

void flicker_destroy(struct flicker *flicker)
{
	if (flicker)
		free(flicker->rows);
	free(flicker);
}

/* Computes B / (s M), scale = 1 / s, at a band's usable points, and updates each M. Returns the
 * number of ratios. */
static int band_ratios(struct flicker *f, int b, int c, const struct picture *picture, float scale,
		       float *ratio)
{
	int count = 0;

	for (int i = 0; i < POINTS; i++) {
		const uint8_t code = picture->origin[f->point[b][i].y * picture->y_step +
						     f->point[b][i].x * picture->x_step + 2 - c];
		float *mean = &f->point[b][i].mean[c];
		int *usable = &f->point[b][i].usable[c];
		const float light = f->decode[code] * scale;

		if (code < DARKEST || code > BRIGHTEST || !(light > 0))
			continue;
		if (*usable >= BEGIN)
			ratio[count++] = light / *mean;
		*usable += *usable < MEMORY;
		*mean = *usable == 1 ? light : *mean + (light - *mean) / (float)*usable;
	}
	return count;
}

/* Measures the gain of a channel's bands. A band with too few usable points takes the gain of the
 * band above it. */
static void channel_gains(struct flicker *f, int c, const struct picture *picture, float scale)
{
	float(*gain)[3] = f->gain[0];
	float ratio[POINTS];

	for (int b = 0; b < BANDS; b++) {
		const int n = band_ratios(f, b, c, picture, scale, ratio);

		if (n >= POINTS_LEAST) {
			const float off = select_median(ratio, n) - 1;

			f->standing[b][c] += (off - f->standing[b][c]) / (float)f->frames;
			gain[b][c] = fminf(fmaxf(off - f->standing[b][c], -0.75f), 3);
		} else {
			gain[b][c] = b ? gain[b - 1][c] : 0;
		}
	}
}

/* Updates power and covariance by this frame, and decides whether lamps flicker. The mean over all
 * bands is subtracted, as people or exposure may change it. */
static void flicker_judge(struct flicker *f)
{
	float power = 0, covariance = 0;

	for (int c = 0; c < 3; c++) {
		float mean[2] = {0, 0};

		for (int b = 0; b < BANDS; b++)
			for (int k = 0; k < 2; k++)
				mean[k] += f->gain[k][b][c] / BANDS;
		for (int b = 0; b < BANDS - 1; b++) {
			const float off = f->gain[0][b][c] - mean[0];

			power += off * (f->gain[0][b + 1][c] - mean[0]) / (3 * (BANDS - 1));
			covariance += off * (f->gain[1][b][c] - mean[1]) / (3 * (BANDS - 1));
		}
	}
	f->power += (power - f->power) / MEMORY;
	f->covariance += (covariance - f->covariance) / MEMORY;
	f->streak = f->power > (f->found ? LOST * LOST : FOUND * FOUND) &&
				    f->covariance < ALIKE * f->power
			    ? f->streak + 1
			    : 0;
	f->found = f->streak >= BEGIN;
}

/* Interpolates the bands' gains, which hold at the bands' middles. Rows above the first middle and
 * below the last take the gain of that band. */
static void rows_fill(struct flicker *f)
{
	for (int y = 0; y < f->height; y++) {
		const float at = ((float)y + 0.5f) * BANDS / (float)f->height - 0.5f;
		const int b = at > 0 ? (int)at : 0;
		const int next = b + 1 < BANDS ? b + 1 : b;
		const float share = at > 0 ? at - (float)b : 0;

		for (int c = 0; c < 3; c++) {
			const float g = f->gain[0][b][c] +
					share * (f->gain[0][next][c] - f->gain[0][b][c]);

			f->rows[y][c] = (int32_t)lrintf((1 + g) * FLICKER_ONE);
		}
	}
}

void flicker_look(struct flicker *f, const struct picture *background, const float expected[3])
{
	f->frames += f->frames < MEMORY;
	memcpy(f->gain[1], f->gain[0], sizeof(f->gain[0]));
	for (int c = 0; c < 3; c++)
		channel_gains(f, c, background, 1 / expected[c]);
	if (f->frames > BEGIN + 1)
		flicker_judge(f);
	if (f->found)
		rows_fill(f);
}

const int32_t (*flicker_rows(const struct flicker *f))[3]
{
	return f->found ? (const int32_t(*)[3])f->rows : NULL;
}
