/* SPDX-License-Identifier: MIT */
#include "hal/look/flicker.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/look/median.h"

enum {
	BANDS = 32,
	EACH = 128,	   /* points of a band */
	ENOUGH = EACH / 4, /* that have to count */
	MEMORY = 16,	   /* frames that means are over */
	BEGIN = 6	   /* frames after which M is one, gains are, and flicker is found */
};

/* Code values between which a point counts. */
#define DARKEST 12
#define BRIGHTEST 249
/* RMS of gains - 1 from which rows are followed, and below which no more. */
#define FOUND 0.012f
#define LOST 0.008f
#define ALIKE 0.7f /* share of the power that successive frames may have together */

struct flicker {
	int height;
	float decode[256];
	struct {
		int x, y;
		float mean[3]; /* linear light, R, G, B */
		int seen[3];   /* frames in it, at most MEMORY */
	} point[BANDS][EACH];
	int frames;		 /* looked at, at most MEMORY */
	float gain[2][BANDS][3]; /* - 1; of this frame and the one before */
	float still[BANDS][3];	 /* mean of gains - 1, taken from them */
	float power, together;	 /* of gains in adjacent bands; of these in successive frames */
	int told;		 /* successive frames in which it is flicker */
	bool found;
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
	/* A sequence of low discrepancy: multiples of the plastic number's powers (Roberts 2018). */
	for (int b = 0; b < BANDS; b++)
		for (int i = 0; i < EACH; i++) {
			const double x = fmod(0.5 + (b * EACH + i) * 0.7548776662466927, 1);
			const double y = fmod(0.5 + (b * EACH + i) * 0.5698402909980532, 1);

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

/* B / M of the points of a band that count, and makes them part of M. Returns how many. */
static int band_look(struct flicker *f, int b, int c, const struct picture *picture, float scale,
		     float *ratio)
{
	int count = 0;

	for (int i = 0; i < EACH; i++) {
		const uint8_t code = picture->origin[f->point[b][i].y * picture->y_step +
						     f->point[b][i].x * picture->x_step + 2 - c];
		float *mean = &f->point[b][i].mean[c];
		int *seen = &f->point[b][i].seen[c];
		float seen_light;

		seen_light = f->decode[code] * scale;
		if (code < DARKEST || code > BRIGHTEST || !(seen_light > 0))
			continue;
		if (*seen >= BEGIN)
			ratio[count++] = seen_light / *mean;
		*seen += *seen < MEMORY;
		*mean = *seen == 1 ? seen_light : *mean + (seen_light - *mean) / (float)*seen;
	}
	return count;
}

/* Gains of a channel's bands; where too few points tell one, it is that of the band above. */
static void channel_look(struct flicker *f, int c, const struct picture *picture, float scale)
{
	float(*gain)[3] = f->gain[0];
	float ratio[EACH];

	for (int b = 0; b < BANDS; b++) {
		const int n = band_look(f, b, c, picture, scale, ratio);

		if (n >= ENOUGH) {
			const float off = select_median(ratio, n) - 1;

			f->still[b][c] += (off - f->still[b][c]) / (float)f->frames;
			gain[b][c] = fminf(fmaxf(off - f->still[b][c], -0.75f), 3);
		} else {
			gain[b][c] = b ? gain[b - 1][c] : 0;
		}
	}
}

/* Adds the frame to the powers, and finds whether lamps flicker. What all bands have in common may be
 * people or exposure. */
static void flicker_judge(struct flicker *f)
{
	float power = 0, together = 0;

	for (int c = 0; c < 3; c++) {
		float mean[2] = {0, 0};

		for (int b = 0; b < BANDS; b++)
			for (int k = 0; k < 2; k++)
				mean[k] += f->gain[k][b][c] / BANDS;
		for (int b = 0; b < BANDS - 1; b++) {
			const float off = f->gain[0][b][c] - mean[0];

			power += off * (f->gain[0][b + 1][c] - mean[0]) / (3 * (BANDS - 1));
			together += off * (f->gain[1][b][c] - mean[1]) / (3 * (BANDS - 1));
		}
	}
	f->power += (power - f->power) / MEMORY;
	f->together += (together - f->together) / MEMORY;
	f->told = f->power > (f->found ? LOST * LOST : FOUND * FOUND) &&
				  f->together < ALIKE * f->power
			  ? f->told + 1
			  : 0;
	f->found = f->told >= BEGIN;
}

/* Interpolates the bands' gains; above the first middle and below the last they are constant. */
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
		channel_look(f, c, background, 1 / expected[c]);
	if (f->frames > BEGIN + 1)
		flicker_judge(f);
	if (f->found)
		rows_fill(f);
}

const int32_t (*flicker_rows(const struct flicker *f))[3]
{
	return f->found ? (const int32_t(*)[3])f->rows : NULL;
}
