/* SPDX-License-Identifier: MIT */
/*
 * Lamps on mains flicker at twice its frequency f, and a rolling shutter shows that as rows. The
 * light of a lamp over its mean, and what a row that is exposed from t to t + shutter sees of it:
 *
 *     l(t)   = 1 + depth cos(4 pi f t)
 *     row(t) = 1 + depth sinc(2 f shutter) cos(4 pi f (t + shutter / 2))
 *     sinc(x) = sin(pi x) / (pi x)
 *
 * Row y of `height` begins to be exposed readout * y / height after the frame.
 */
#ifndef INLAY_DRIVERS_SIM_MAINS_H
#define INLAY_DRIVERS_SIM_MAINS_H

struct mains {
	double depth; /* 0..1; 0: lamps do not flicker */
	double hz;    /* f */
	double shutter_s, readout_s;
};

/* What a row of a frame that begins at time_s sees of a lamp, over the lamp's mean. */
double mains_row(const struct mains *mains, double time_s, int y, int height);

#endif
