/* SPDX-License-Identifier: MIT */
/* Names the programs that hold a card, for messages. */
#ifndef INLAY_DRIVERS_KMS_HOLDER_H
#define INLAY_DRIVERS_KMS_HOLDER_H

#include <stddef.h>

/* Lists other programs that have the device open, "name (pid 123), ...", as far as this user may
 * see them in /proc. Returns how many there are. */
int kms_holders(const char *device, char *text, size_t room);

#endif
