/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/lamps/lamps_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/observations.h"
#include "hal/base/text_file.h"
#include "hal/optics/vec.h"

#define NUMBERS_MAX 5
#define SAME 1e-4 /* rad: lamps nearer to each other are the same */

void lamps_free(struct lamps *lamps)
{
	free(lamps->lamp);
	*lamps = (struct lamps){.lamp = NULL};
}

static bool take_numbers(struct lamp *lamp, const double *number, int count)
{
	const bool angles = count == 2 || count == 4;

	if (count < 2 || count > NUMBERS_MAX)
		return false;
	if (angles) {
		const double azimuth = number[0] * (M_PI / 180);
		const double elevation = number[1] * (M_PI / 180);

		if (fabs(number[1]) > 90 || fabs(number[0]) > 360)
			return false;
		lamp->dir[0] = cos(elevation) * cos(azimuth);
		lamp->dir[1] = cos(elevation) * sin(azimuth);
		lamp->dir[2] = sin(elevation);
	} else {
		memcpy(lamp->dir, number, sizeof(lamp->dir));
		if (!(vec_length(lamp->dir) > 0))
			return false;
		vec_normalize(lamp->dir);
	}
	lamp->hinted = count > 3;
	if (lamp->hinted)
		memcpy(lamp->near_px, number + count - 2, sizeof(lamp->near_px));
	return true;
}

static int check_others(const struct lamps *lamps, const char *path, struct fault *fault)
{
	const struct lamp *last = &lamps->lamp[lamps->count - 1];

	for (int n = 0; n < lamps->count - 1; n++) {
		double across[3];

		vec_cross(last->dir, lamps->lamp[n].dir, across);
		if (vec_dot(last->dir, lamps->lamp[n].dir) > 0 && vec_length(across) < SAME)
			return fault_say(fault, -EINVAL,
					 "%s:%d: is in the direction of line %d, expected every "
					 "lamp once",
					 path, last->line, lamps->lamp[n].line);
	}
	return 0;
}

static int read_lamp(struct lamps *lamps, const struct text_file *file, struct fault *fault)
{
	double number[NUMBERS_MAX];
	const int count = observations_numbers(file->line, number, NUMBERS_MAX);
	struct lamp lamp = {.line = file->number}, *grown;

	if (!count)
		return 0;
	if (!take_numbers(&lamp, number, count))
		return fault_say(fault, -EINVAL,
				 "%s:%d: expected azimuth and elevation in degrees or a direction "
				 "dx dy dz, and where it is known roughly xf yf",
				 file->path, file->number);
	if (lamps->count == LAMPS_MAX)
		return fault_say(fault, -EINVAL, "%s:%d: expected at most %d lamps", file->path,
				 file->number, LAMPS_MAX);
	grown = realloc(lamps->lamp, ((size_t)lamps->count + 1) * sizeof(*grown));
	if (!grown)
		return fault_say(fault, -ENOMEM, "%s: out of memory", file->path);
	lamps->lamp = grown;
	lamps->lamp[lamps->count++] = lamp;
	return check_others(lamps, file->path, fault);
}

int lamps_read(struct lamps *lamps, const char *path, struct fault *fault)
{
	struct text_file file;
	int err = text_file_open(&file, path, fault);

	*lamps = (struct lamps){.lamp = NULL};
	if (err)
		return err;
	while (!err && (err = text_file_next(&file, fault)) > 0)
		err = read_lamp(lamps, &file, fault);
	if (!err && !lamps->count)
		err = fault_say(fault, -EINVAL,
				"%s: holds no lamps, expected lines of azimuth and elevation, or "
				"dx dy dz",
				path);
	text_file_close(&file);
	if (err)
		lamps_free(lamps);
	return err;
}
