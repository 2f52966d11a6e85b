/* SPDX-License-Identifier: MIT */
/*
 * The Unix socket that the kiosk listens at (control.h) and that inlay control connects to: its
 * file, owner and group, and whether a program listens behind it.
 */
#ifndef INLAY_APP_CONTROL_CONTROL_SOCKET_H
#define INLAY_APP_CONTROL_CONTROL_SOCKET_H

#include <sys/types.h>

#include "hal/base/fault.h"

struct control_socket {
	int fd;		/* -1: closed */
	char path[128]; /* empty: there is no file to remove */
	dev_t device;	/* of the file, which is removed only while it is this socket's */
	ino_t inode;
};

/* Finds a group by name; an empty name leaves *group as it is. 0 or -EINVAL. */
int control_socket_group(const char *name, gid_t *group, struct fault *fault);

/*
 * Listens at path. The file has its owner, group and mode (0660, without a group 0600) before any
 * program can find it, and replaces a file that a dead program left. -EADDRINUSE: a program listens
 * there; -EEXIST: the file is no socket; other -errno. control_socket_close() is to be called in
 * any case.
 */
int control_socket_open(struct control_socket *socket, const char *path, const gid_t *group,
			struct fault *fault);
void control_socket_close(struct control_socket *socket); /* idempotent */

/* Returns a descriptor connected to path, or -errno; does not wait. -ECONNREFUSED: no program
 * listens there. */
int control_socket_connect(const char *path);

#endif
