/* SPDX-License-Identifier: MIT */
/* What libcamera writes to its log becomes ours. */
#ifndef INLAY_DRIVERS_LIBCAMERA_MESSAGES_H
#define INLAY_DRIVERS_LIBCAMERA_MESSAGES_H

#include <stddef.h>

/* One whole message, "[time] [thread] LEVEL Category file:line text": errors become warnings of
 * ours, the rest is for debugging. One that repeats (a device that went away fails at every frame)
 * is said once. Any thread. */
void libcamera_message(const char *text, size_t length);

#endif
