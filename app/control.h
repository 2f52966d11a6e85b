/*
 * Commands from other programs on this machine, over a Unix socket: one line a command, one line a
 * reply. The socket belongs to the group that [control] names, and the kernel's word on who
 * connects (SO_PEERCRED) is checked besides.
 *
 *     threshold-up | threshold-set 40 | view-next | ... any name of enum action    ->  ok
 *     status                                                        ->  one line of JSON
 *     anything else                                                 ->  error: what was expected
 *
 * Nothing blocks: a client that does not read its replies, sends without end or never ends its line
 * is cut off, and the others are served.
 */
#ifndef INLAY_APP_CONTROL_H
#define INLAY_APP_CONTROL_H

#include "hal/buttons.h"
#include "hal/fault.h"

struct control;

enum control_request_kind { CONTROL_NOTHING, CONTROL_ACTION, CONTROL_STATUS };

struct control_request {
	enum control_request_kind kind;
	struct button_press press; /* of CONTROL_ACTION */
};

/* path: of the socket; one that a dead kiosk left is replaced, one in use is -EADDRINUSE. group:
 * name, or empty. */
int control_open(struct control **control, const char *path, const char *group,
		 struct fault *fault);

/* Polls readable when control_next() has something to do. */
int control_descriptor(const struct control *control);

/* The next request, in order; each one but CONTROL_NOTHING must be answered before the next. */
void control_next(struct control *control, struct control_request *request);
void control_answer(struct control *control, const char *line); /* without its newline */

void control_close(struct control *control); /* removes the socket; NULL is harmless */

#endif
