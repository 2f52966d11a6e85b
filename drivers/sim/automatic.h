/* SPDX-License-Identifier: MIT */
/*
 * Automatic exposure and white balance of a simulated camera. Each frame's gains follow the frames
 * before it, as a real camera's do, and the first frame finds them settled. In stops s of a channel
 * whose mean light is M, exposure times radiance,
 *
 *     wanted = log2(level / mean of M over R, G, B)    exposure
 *     wanted = log2(M_G / M)                           white balance (grey world), of R and B
 *     s     += (1 - exp(-period / time)) (wanted - s)
 *     gain   = 2^(exposure's s + white balance's s)    each s rounded to a multiple of step
 */
#ifndef INLAY_DRIVERS_SIM_AUTOMATIC_H
#define INLAY_DRIVERS_SIM_AUTOMATIC_H

#include <stdbool.h>
#include <stddef.h>

struct automatic_settings {
	double level; /* mean linear light that exposure wants, white is 1; 0: it stays */
	bool white;
	double time_s;	   /* time constant; 0: at once */
	double step_stops; /* 0: no steps */
};

struct automatic {
	struct automatic_settings settings;
	double exposure, white[3]; /* s, in stops */
	bool begun;
};

/* Meters a frame, radiance rgb[count][3], and returns the gains of R, G and B at which it is taken:
 * those that the frames before have set. */
void automatic_gain(struct automatic *automatic, const float *rgb, size_t count, double exposure,
		    double period_s, float gain[3]);

#endif
