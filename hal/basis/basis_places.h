/* SPDX-License-Identifier: MIT */
/* Where a pose's surfaces lie: the distances of chunk PLAC (basis_format.h). */
#ifndef INLAY_HAL_BASIS_BASIS_PLACES_H
#define INLAY_HAL_BASIS_BASIS_PLACES_H

#include <stdbool.h>

#include "hal/basis/basis_reader.h"

/* Whether the file knows where a pose's surfaces are. */
bool basis_has_places(const struct basis *basis, int pose);

/* distance[height][width]: of the surface from the camera, world units; 0: it is not in the pixel.
 * -ENODATA: the file has none of this pose; -EBADMSG: damaged; -ENOMEM. */
int basis_places_read(const struct basis *basis, int pose, enum basis_surface surface,
		      float *distance);

/* Makes the chunk of distance[BASIS_SURFACES][height * width], >= 0; *chunk is the caller's.
 * -ENOMEM. */
int basis_places_pack(const float *const distance[BASIS_SURFACES], int width, int height,
		      void **chunk, size_t *bytes);

/* Finds and checks the chunk of a pose; NULL: there is none. -EBADMSG. */
int basis_find_places(const struct basis_reader *reader, const struct basis_chunk_entry *chunk,
		      struct basis_pose *pose);

/* Checks footprints. 0; or -EINVAL, and *bad is the first that breaks a rule of README.md. */
int basis_foot_check(const struct basis_footprint *feet, uint32_t count, uint32_t *bad);

#endif
