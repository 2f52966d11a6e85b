/* SPDX-License-Identifier: MIT */
/*
 * The socket that control.h listens at, and the one that inlay control connects with: where it
 * stands, whose it is, and whether somebody lives behind it.
 */
#ifndef INLAY_APP_KIOSK_CONTROL_SOCKET_H
#define INLAY_APP_KIOSK_CONTROL_SOCKET_H

#include <sys/types.h>

#include "hal/base/fault.h"

struct control_socket {
	int fd;		/* -1: closed */
	char path[128]; /* empty: there is none to remove */
	dev_t device;	/* of the file: it is removed only while it is ours */
	ino_t inode;
};

/* The group called name; an empty name is fine and gives nothing. 0 or -EINVAL. */
int control_socket_group(const char *name, gid_t *group, struct fault *fault);

/*
 * Listens at path. The file has its owner, group and mode (0660, without a group 0600) before
 * anybody can find it, and takes the place of one that a dead program left. -EADDRINUSE: somebody
 * listens there; -EEXIST: what is there is no socket; other -errno. Closed by
 * control_socket_close() in any case.
 */
int control_socket_open(struct control_socket *socket, const char *path, const gid_t *group,
			struct fault *fault);
void control_socket_close(struct control_socket *socket); /* idempotent */

/* Connected to path, or -errno; does not wait. -ECONNREFUSED: nobody lives there. */
int control_socket_connect(const char *path);

#endif
