/* SPDX-License-Identifier: MIT */
/* Passes messages of libcamera's log on to inlay's. */
#ifndef INLAY_DRIVERS_LIBCAMERA_MESSAGES_H
#define INLAY_DRIVERS_LIBCAMERA_MESSAGES_H

#include <stddef.h>

/* Logs one whole message, "[time] [thread] LEVEL Category file:line text": errors as warnings, the
 * rest for debugging. A repeated message (a lost device fails at every frame) is logged once. Any
 * thread may call it. */
void libcamera_message(const char *text, size_t length);

#endif
