/* SPDX-License-Identifier: MIT */
/*
 * The packed poses of a file. Those in use are unpacked in memory. Private to hal/basis; the
 * functions for callers are in basis.h.
 */
#ifndef INLAY_HAL_BASIS_BASIS_STORE_H
#define INLAY_HAL_BASIS_BASIS_STORE_H

#include "hal/basis/basis_reader.h"

struct basis_store;

/* poses: [info.poses]; the store fills in the blocks of poses in memory. -ENOMEM, -EAGAIN. */
int basis_store_create(struct basis_store **store, const struct basis_reader *reader,
		       struct basis_pose *poses);

/* Adds a packed pose and checks its block list. -EBADMSG. */
int basis_store_add(struct basis_store *store, const struct basis_reader *reader, int pose,
		    const struct basis_chunk_entry *blocks, const struct basis_chunk_entry *pack);

/* Unpacks each pose once and checks all of it. -EBADMSG, -ENOMEM. */
int basis_store_check(struct basis_store *store, const struct basis_reader *reader);

/* Also clears the blocks that it filled in. NULL is harmless. */
void basis_store_destroy(struct basis_store *store);

#endif
