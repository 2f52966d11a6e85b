/* SPDX-License-Identifier: MIT */
/*
 * Takes noise out of the light that met several surfaces.
 *
 * Each sample of such light follows one path by chance, so its noise differs in every pixel and
 * light, while the light itself is smooth: a matrix of pixels by lights that is of low rank but for
 * noise. It comes as two halves of independent samples. What the leading singular vectors of one
 * half find again in the other half is light, what they do not is noise.
 *
 * Two things the filter leaves alone. Each row's sum under a uniform sky: there what is blocked and
 * what is bounced balance sample by sample. And, of each light and channel, the mean over all
 * pixels. The slope over them is filtered by itself: what singular vectors do not tell of a plane,
 * tiles that are filtered apart would show as steps between them.
 */
#ifndef INLAY_BAKE_TRACE_BOUNCE_H
#define INLAY_BAKE_TRACE_BOUNCE_H

#include <stdint.h>

#define BOUNCE_ROWS_MAX 768 /* of a tile: 256 pixels of 3 channels */
#define BOUNCE_RANK_MAX 48

/* Scratch of one thread. */
struct bounce {
	int lights;
	float *memory;
};

/* What is filtered. Neither sky nor scale is 0. */
struct bounce_halves {
	int rows;	       /* three channels of each pixel */
	const uint16_t *pixel; /* [rows / 3]: y * BASIS_TILE + x, all different */
	float *half[2];	       /* [rows][lights]: means, each over samples of its own */
	double share[2];       /* of all samples; they sum to 1 */
	const float *sky;   /* [lights]: the lighting, in units of the values, that is left alone */
	const float *scale; /* [lights]: makes the noise of all columns about alike */
};

/* -ENOMEM */
int bounce_create(struct bounce *bounce, int lights);
void bounce_free(struct bounce *bounce); /* idempotent; zeroed is fine */

/*
 * half[0] becomes the mean of both, filtered, and half[1] is spoilt. Returns how many singular
 * vectors were kept besides sums and means, or -1 when the mean was left as it is: the halves do
 * not show that more noise would go than light.
 */
int bounce_filter(struct bounce *bounce, const struct bounce_halves *halves);

#endif
