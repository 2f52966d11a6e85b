/* SPDX-License-Identifier: MIT */
/*
 * Commands from other programs on this machine, over a Unix socket: one line a command, one line a
 * reply. The socket belongs to the group that [control] names, and the kernel's word on who
 * connects (SO_PEERCRED) is checked besides.
 *
 *     threshold-up | threshold-set 40 | view-next | ... any name of enum action    ->  ok
 *     status                                                        ->  one line of JSON
 *     anything else                                                 ->  error: what was expected
 *
 * Nothing blocks, and nobody is kept from the kiosk by another: a client that does not read its
 * replies, sends without end or a line without end is cut off, and when CONTROL_CLIENTS_MAX are
 * connected, one more takes the place of whoever has been silent longest.
 */
#ifndef INLAY_APP_KIOSK_CONTROL_H
#define INLAY_APP_KIOSK_CONTROL_H

#include <stddef.h>

#include "hal/base/fault.h"
#include "hal/device/buttons.h"

#define CONTROL_CLIENTS_MAX 8
#define CONTROL_LINE_MAX 256 /* with its newline */
#define CONTROL_RATE_MAX 500 /* lines a second, of one client */

struct control;

enum control_request_kind { CONTROL_NOTHING, CONTROL_ACTION, CONTROL_STATUS };

struct control_request {
	enum control_request_kind kind;
	struct button_press press; /* of CONTROL_ACTION */
};

/* A line without its newline: 0, or -EINVAL and what was expected. No other byte than those of
 * printed ASCII gets into the fault. */
int control_parse(const char *line, size_t length, struct control_request *request,
		  struct fault *fault);

/* path: of the socket; one that a dead kiosk left is replaced, one in use is -EADDRINUSE. group:
 * name, or empty. */
int control_open(struct control **control, const char *path, const char *group,
		 struct fault *fault);

/* Polls readable when control_next() has something to do. */
int control_descriptor(const struct control *control);

/* The next request, in order; each one but CONTROL_NOTHING must be answered before the next. After
 * some requests it says CONTROL_NOTHING although more wait (the descriptor says so), so that a
 * caller may read until then and still comes to its other work. */
void control_next(struct control *control, struct control_request *request);
void control_answer(struct control *control, const char *line); /* without its newline */

void control_close(struct control *control); /* removes the socket; NULL is harmless */

#endif
