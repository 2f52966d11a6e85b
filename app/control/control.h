/* SPDX-License-Identifier: MIT */
/*
 * Commands from other programs on this machine, over a Unix socket: one line a command, one line a
 * reply. The socket's file belongs to the group that [control] names; the kiosk also checks who
 * connects, by the credentials that the kernel gives (SO_PEERCRED).
 *
 *     threshold-up | threshold-set 40 | ... any name of enum action    ->  ok
 *     status                                                           ->  one line of JSON
 *     snapshot    ->  snapshot WIDTH HEIGHT, and 4 * WIDTH * HEIGHT bytes after it (snapshot.h)
 *     anything else                                                    ->  error: what was expected
 *
 * Nothing blocks, and no client keeps another one from the kiosk: a client that does not read its
 * replies, sends too much or sends a line without end is disconnected. A client that waits for a
 * picture, or has not read all of it, is not listened to. When CONTROL_CLIENTS_MAX are connected,
 * one more takes the place of the client that has been silent longest.
 */
#ifndef INLAY_APP_CONTROL_CONTROL_H
#define INLAY_APP_CONTROL_CONTROL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "app/control/snapshot.h"
#include "hal/base/fault.h"
#include "hal/device/buttons.h"

#define CONTROL_CLIENTS_MAX 8
#define CONTROL_LINE_MAX 256 /* its newline included */
#define CONTROL_RATE_MAX 500 /* lines a second from one client; more disconnect it */

#define CONTROL_PICTURES_MAX 2
#define CONTROL_PICTURE_SECONDS 5

struct control;

enum control_request_kind { CONTROL_NOTHING, CONTROL_ACTION, CONTROL_STATUS, CONTROL_SNAPSHOT };

struct control_request {
	enum control_request_kind kind;
	struct button_press press; /* for CONTROL_ACTION */
};

/* Parses a line without its newline. 0, or -EINVAL with a fault that says what was expected. Only
 * printable ASCII of the line gets into the fault. */
int control_parse(const char *line, size_t length, struct control_request *request,
		  struct fault *fault);

/* path: of the socket's file. One that a dead kiosk left is replaced; -EADDRINUSE: a kiosk listens
 * there. group: its name, or empty for none. */
int control_open(struct control **control, const char *path, const char *group,
		 struct fault *fault);

/* Polls readable when control_next() has something to do. */
int control_descriptor(const struct control *control);

/* Takes the next request, in order. Each one but CONTROL_NOTHING must be answered or postponed
 * before the next call. CONTROL_NOTHING also comes after some requests although more are waiting
 * (the descriptor stays readable), so that a caller who reads until then still gets to its other
 * work. */
void control_next(struct control *control, struct control_request *request);
void control_answer(struct control *control, const char *line); /* without its newline */

/* Lets the client whose request was taken last wait for control_answer_waiting(), which answers all
 * that wait. Its line is snapshot's, or snapshot is NULL; the clients become holders of it. */
void control_postpone(struct control *control);
bool control_has_waiting(const struct control *control);
void control_answer_waiting(struct control *control, const char *line, struct snapshot *snapshot);

/* Once a second: disconnects clients that have read nothing of their picture for
 * CONTROL_PICTURE_SECONDS. Returns since when the longest waiting one waits; INT64_MAX: none
 * does. */
int64_t control_look(struct control *control, int64_t now_ns);

/* Whether CONTROL_PICTURES_MAX pictures are on their way: a further one has no room. */
bool control_is_full(const struct control *control);

void control_close(struct control *control); /* removes the socket; NULL is harmless */

#endif
