/* SPDX-License-Identifier: MIT */
/* Checks the pixels of a pose that show the background through the object, or mirror the sky.
 * Private to hal/basis. */
#ifndef INLAY_HAL_BASIS_BASIS_GLASS_H
#define INLAY_HAL_BASIS_BASIS_GLASS_H

#include "hal/basis/basis_reader.h"

/* Checks the pixels of a pose that show the background through the object, and fills them in.
 * chunk may be NULL. -EBADMSG. */
int basis_read_glass(const struct basis_reader *reader, const struct basis_chunk_entry *chunk,
		     struct basis_pose *pose);

/* The same for what mirrors the sky. */
int basis_read_mirror(const struct basis_reader *reader, const struct basis_chunk_entry *chunk,
		      struct basis_pose *pose);

#endif
