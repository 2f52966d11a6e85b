/* SPDX-License-Identifier: MIT */
/*
 * The poses of a file that lie packed: those in use are unpacked into memory, the others are not.
 * Private to hal/basis; what callers use is in basis.h.
 */
#ifndef INLAY_HAL_BASIS_BASIS_STORE_H
#define INLAY_HAL_BASIS_BASIS_STORE_H

#include "hal/basis/basis_reader.h"

struct basis_store;

/* poses: [info.poses], where blocks are put when they are in memory. -ENOMEM, -EAGAIN. */
int basis_store_create(struct basis_store **store, const struct basis_reader *reader,
		       struct basis_pose *poses);

/* A pose that lies packed. Checks its block list. -EBADMSG. */
int basis_store_add(struct basis_store *store, const struct basis_reader *reader, int pose,
		    const struct basis_chunk_entry *blocks, const struct basis_chunk_entry *pack);

/* Unpacks each once, and checks all of it. -EBADMSG, -ENOMEM. */
int basis_store_check(struct basis_store *store, const struct basis_reader *reader);

/* Takes back what it has put into poses. NULL is harmless. */
void basis_store_destroy(struct basis_store *store);

#endif
