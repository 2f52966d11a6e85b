/* SPDX-License-Identifier: MIT */
/*
 * The bytes of a basis file. Programs that show it read what they need into memory: a mapping would
 * mean SIGBUS or unchecked blocks if the file is overwritten, truncated, or its medium removed.
 * Programs that need everything (BASIS_ALL), which may exceed memory, and end soon, map the file.
 * Private to hal/basis.
 */
#ifndef INLAY_HAL_BASIS_BASIS_FILE_H
#define INLAY_HAL_BASIS_BASIS_FILE_H

#include "hal/basis/basis_reader.h"

struct basis_file {
	int fd;		 /* -1: mapped */
	uint8_t *memory; /* [bytes]: zeros until basis_file_fetch(), unless mapped */
	size_t bytes;
};

/* Errors of open(), -ENOMEM, -EBADMSG: the file is empty, -EINVAL: it is no regular file. */
int basis_file_open(struct basis_file *file, const char *path, enum basis_part part,
		    struct fault *fault);
void basis_file_close(struct basis_file *file); /* unmaps the memory too */

/* Reads these bytes of the file to their place in r->data. Errors of read(), -EBADMSG: the file
 * ends before. */
int basis_file_fetch(const struct basis_reader *r, uint64_t offset, uint64_t bytes);

/* The same for bytes that are needed once: the caller calls free(*owned). Also -ENOMEM. */
int basis_file_borrow(const struct basis_reader *r, uint64_t offset, uint64_t bytes,
		      const uint8_t **data, void **owned);

#endif
