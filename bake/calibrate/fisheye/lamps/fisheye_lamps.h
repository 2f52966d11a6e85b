/* SPDX-License-Identifier: MIT */
/* A fisheye lens from lamps in known directions, found in one picture. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_FISHEYE_LAMPS_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_FISHEYE_LAMPS_H

#include <stdio.h>

#include "bake/calibrate/fisheye/fisheye_find.h"
#include "bake/calibrate/fisheye/lamps/lamps_file.h"
#include "hal/image/image.h"

/* Report on the lamps. */
struct lamps_told {
	int lamps, expected, found; /* expected: lamps inside the field of the lens found */
	bool otherwise;		    /* another assignment (the picture turned) fits as well */
	/* "4 at (12, 380), 7 at (20, 31)": lines of the file and where they should be; empty:
	 * none */
	char missing[512];
	char merged[512];  /* "2, 3": lines of lamps that share one spot */
	char strange[512]; /* "(321, 94), (12, 380)": spots that are not lamps */
};

/*
 * Calibrates. Fills seen (the caller frees it) with the lamps that were found, and the result as
 * fisheye_find() does; the verdict also judges the assignment. -ENOMEM, -EINVAL.
 */
int fisheye_lamps(struct fisheye_result *result, struct observations *seen, struct lamps_told *told,
		  const struct lamps *lamps, const char *lamps_name, const struct image *picture,
		  const char *name, const struct fisheye_wanted *wanted, struct fault *fault);

/* Prints the report on the lamps as lines that begin with before; name: the lamps' file. */
void lamps_print(FILE *to, const char *before, const struct lamps_told *told, const char *name);

#endif
