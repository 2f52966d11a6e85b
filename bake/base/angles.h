/* SPDX-License-Identifier: MIT */
/*
 * Files of light angles: one light a line, theta and phi in radians (thesis 2.2.1), as `inlay-bake
 * dome --angles` writes them. The reader finds the dome they belong to, and their order. Where the
 * dome is finer in parts, a line "fine F" with the frequency of its base stands before them.
 */
#ifndef INLAY_BAKE_BASE_ANGLES_H
#define INLAY_BAKE_BASE_ANGLES_H

#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/optics/dome.h"

/* Largest angle between a light of the file and the dome's, as a share of the mean distance between
 * neighbouring lights. */
#define ANGLES_TOLERANCE 0.05

/*
 * Finds the dome that has exactly these lights, in any order; after "fine F" the lights are the
 * dome's nodes as they stand there. light[k] becomes the dome's index of
 * the file's k-th light; the caller frees the array and the dome. -EINVAL: a line has no two
 * numbers in range, no dome has this many lights, or a light is none of the dome's or stands there
 * twice (the fault names file and line); -ENOENT ...; -ENOMEM.
 */
int angles_read(const char *path, struct dome *dome, int **light, struct fault *fault);

/* Writes the dome's lights in its order, to all digits. */
void angles_write(FILE *stream, const struct dome *dome);

#endif
