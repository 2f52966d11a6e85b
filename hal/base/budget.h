/* SPDX-License-Identifier: MIT */
/*
 * Memory that a document may ask for: 256 MiB, and 256 bytes for each byte of its files. Few files
 * of any use come near it; a small one that says to be large is refused before anything is
 * allocated.
 */
#ifndef INLAY_HAL_BASE_BUDGET_H
#define INLAY_HAL_BASE_BUDGET_H

#include <stdint.h>

#include "hal/base/fault.h"

struct budget {
	uint64_t file_bytes; /* of all files of the document so far */
	double taken;
};

/* Takes memory for something that is kept, or that lives shortly: then it only has to fit. 0;
 * -EFBIG: it is more than is left; the fault begins with the name. */
int budget_take(struct budget *budget, double bytes, const char *name, struct fault *fault);
int budget_fits(const struct budget *budget, double bytes, const char *name, struct fault *fault);

#endif
