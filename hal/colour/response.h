/* SPDX-License-Identifier: MIT */
/*
 * A camera's response: the light that its code values stand for, as `inlay-calibrate light`
 * measured it and wrote it into the section [light] of a file. Where the file says nothing, the
 * configuration holds.
 */
#ifndef INLAY_HAL_COLOUR_RESPONSE_H
#define INLAY_HAL_COLOUR_RESPONSE_H

#include "hal/colour/transfer.h"
#include "hal/ini/ini.h"

struct response {
	double black_level;	     /* code value of no light, 0..254; -1: not measured */
	double knot[TRANSFER_KNOTS]; /* as in struct transfer_curve; all 0: not measured */
	double gain;	   /* from this camera's linear light to the background camera's units; 0:
			      not measured */
	double colours[9]; /* 3 x 3 matrix from this camera's linear R, G, B to the background
			      camera's, row by row; all 0: not measured, the identity */
	int delay;	   /* frames that still show the old exposure after a change; -1: not
			      measured */
};

extern const struct ini_key response_keys[];

void response_begin(struct response *response); /* sets everything to "not measured" */

/*
 * Reads a file. All faults go to the report, with file and line: those of ini_read(), a response
 * that does not ascend from 0 to 1, a missing section [light]. 0 or the first negative errno; on
 * failure nothing is measured.
 */
int response_read(struct response *response, const char *path, struct ini_report *report);

/* The measured value, or the argument where nothing was measured. */
struct transfer_curve response_curve(const struct response *response, enum transfer named,
				     double black_level);
double response_gain(const struct response *response, double gain);

#endif
