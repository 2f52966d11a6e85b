/* SPDX-License-Identifier: MIT */
/* Numbers in text that people write. */
#ifndef INLAY_HAL_BASE_NUMBER_H
#define INLAY_HAL_BASE_NUMBER_H

/* The decimal number at *text, which moves past it; blanks before it are not passed over. -EINVAL:
 * there is none, or it is not finite; text and value then stay as they are. */
int number_read(const char **text, double *value);

/* The same of text that is a number and nothing else. */
int number_of(const char *text, double *value);

#endif
