/* SPDX-License-Identifier: MIT */
/*
 * Files of light angles, one light a line: theta phi in radians (thesis 2.2.1; inlay-bake dome
 * --angles writes them). Which dome they are, and in which order. Lights that are tents have the
 * word before them, in a line of its own.
 */
#ifndef INLAY_BAKE_BASE_ANGLES_H
#define INLAY_BAKE_BASE_ANGLES_H

#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/optics/dome.h"

/* How far a light of the file may be from the dome's, as a share of the mean distance of
 * neighbours. */
#define ANGLES_TOLERANCE 0.05

/*
 * Finds the dome that has exactly these lights, in any order: light[k] is the dome's index of the
 * file's k-th line, to be freed. -EINVAL: no number or out of range in a line; no dome has so many;
 * a light is none of the dome's or is there twice (the fault names file, line and the dome that
 * comes nearest); -ENOENT ...; -ENOMEM.
 */
int angles_read(const char *path, struct dome *dome, int **light, struct fault *fault);

/* A dome's, in its order, to all digits. */
void angles_write(FILE *stream, const struct dome *dome);

#endif
