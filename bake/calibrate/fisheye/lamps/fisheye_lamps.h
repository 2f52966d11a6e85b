/* SPDX-License-Identifier: MIT */
/* A fisheye lens from lamps at known directions, found in one picture. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_FISHEYE_LAMPS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_FISHEYE_LAMPS_H

#include <stdio.h>

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/fisheye/lamps/lamps_file.h"
#include "hal/image/image.h"

/* What was seen of the lamps. */
struct lamps_told {
	int lamps, expected, found; /* expected: those that the lens found shows inside its field */
	bool otherwise;		    /* the same spots may be other lamps: the picture turned */
	char missing[512];	    /* "4, 7 and 9", lines of the file; empty: none */
	char merged[512];	    /* "2 with 3": one spot of several lamps */
	char strange[512];	    /* "(321, 94), (12, 380)": spots that are no lamps */
};

/*
 * Fills seen (freed by the caller) with the lamps that were found, and the result from them as
 * fisheye_find() does; its verdict also doubts what was matched. -ENOMEM, -EINVAL.
 */
int fisheye_lamps(struct fisheye_result *result, struct observations *seen, struct lamps_told *told,
		  const struct lamps *lamps, const char *lamps_name, const struct image *picture,
		  const char *name, const struct fisheye_wanted *wanted, struct fault *fault);

/* What was found of the lamps, by the lines of their file. */
void lamps_print(FILE *to, const char *before, const struct lamps_told *told, const char *name);

#endif
