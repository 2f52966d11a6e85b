/* SPDX-License-Identifier: MIT */
/* Decimal numbers in text that people write. */
#ifndef INLAY_HAL_BASE_NUMBER_H
#define INLAY_HAL_BASE_NUMBER_H

/* Reads the number at *text and moves *text past it. Does not skip blanks before it. 0; -EINVAL: no
 * number there, or not a finite one; *text and *value are then unchanged. */
int number_read(const char **text, double *value);

/* Reads text that is one number and nothing else. 0 or -EINVAL. */
int number_of(const char *text, double *value);

#endif
