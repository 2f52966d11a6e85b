/* SPDX-License-Identifier: MIT */
/*
 * What a camera's code values mean, as `inlay-calibrate light` measured it: the section [light] of
 * a file of its own. What the file does not say stays as it is configured.
 */
#ifndef INLAY_HAL_COLOUR_RESPONSE_H
#define INLAY_HAL_COLOUR_RESPONSE_H

#include "hal/colour/transfer.h"
#include "hal/ini/ini.h"

struct response {
	double black_level;	     /* code value that is no light, 0..254; -1: not measured */
	double knot[TRANSFER_KNOTS]; /* as in struct transfer_curve; all 0: not measured */
	double gain;	   /* linear light times gain is in the background camera's units; 0: not
			      measured */
	double colours[9]; /* this camera's linear R, G, B to the background's, row by row; all 0:
			      not measured, the identity */
	int delay;	   /* frames that still show the exposure before; -1: not measured */
};

extern const struct ini_key response_keys[];

void response_begin(struct response *response); /* nothing measured */

/*
 * Reads a file. Everything wrong goes to the report, with file and line: what ini_read() finds, a
 * response that does not ascend from 0 to 1, a file without a section [light]. 0 or the first
 * negative errno; the response then has nothing measured.
 */
int response_read(struct response *response, const char *path, struct ini_report *report);

/* What it says goes before what is configured. */
struct transfer_curve response_curve(const struct response *response, enum transfer named,
				     double black_level);
double response_gain(const struct response *response, double gain);

#endif
