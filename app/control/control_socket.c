/* SPDX-License-Identifier: MIT */
#include "app/control/control_socket.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#define TEMPORARY ".new"
#define LOCK ".lock"
#define WAITING 16 /* connections that the kernel queues */

int control_socket_group(const char *name, gid_t *group, struct fault *fault)
{
	const struct group *entry;

	if (!name[0])
		return 0;
	entry = getgrnam(name);
	if (!entry)
		return fault_say(fault, -EINVAL,
				 "[control] group: is \"%s\", expected a group of this machine",
				 name);
	*group = entry->gr_gid;
	return 0;
}

static int set_address(struct sockaddr_un *address, const char *path)
{
	*address = (struct sockaddr_un){.sun_family = AF_UNIX};
	if (strlen(path) >= sizeof(address->sun_path))
		return -ENAMETOOLONG;
	strcpy(address->sun_path, path);
	return 0;
}

int control_socket_connect(const char *path)
{
	struct sockaddr_un address;
	int fd, err;

	err = set_address(&address, path);
	if (err)
		return err;
	fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return -errno;
	if (connect(fd, (struct sockaddr *)&address, sizeof(address)) == 0)
		return fd;
	err = -errno;
	close(fd);
	return err;
}

/* Whether a program listens at path. 0: there is no file, or one that a dead program left; else
 * -errno. */
static int look_for_living(const char *path, struct fault *fault)
{
	struct stat file;
	int fd;

	if (lstat(path, &file)) {
		if (errno == ENOENT)
			return 0;
		fd = -errno;
	} else if (!S_ISSOCK(file.st_mode)) {
		return fault_say(fault, -EEXIST, "[control] socket: \"%s\" is there and no socket",
				 path);
	} else {
		fd = control_socket_connect(path);
	}
	if (fd >= 0)
		close(fd);
	if (fd == -ECONNREFUSED || fd == -ENOENT)
		return 0;
	if (fd >= 0 || fd == -EAGAIN) /* -EAGAIN: its queue is full */
		return fault_say(fault, -EADDRINUSE,
				 "[control] socket: another kiosk listens at \"%s\"", path);
	return fault_say(fault, fd, "[control] socket: cannot use \"%s\": %s", path, strerror(-fd));
}

/* The socket has a temporary name until it is complete; nobody can connect before it listens. */
static int listen_at(struct control_socket *out, const char *temporary, const gid_t *group)
{
	struct sockaddr_un address;
	struct stat file;
	int err;

	err = set_address(&address, temporary);
	if (err)
		return err;
	out->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (out->fd < 0)
		return -errno;
	if (unlink(temporary) && errno != ENOENT)
		return -errno;
	/* Linux gives the file the mode of its socket. */
	if (fchmod(out->fd, 0600) || bind(out->fd, (struct sockaddr *)&address, sizeof(address)))
		return -errno;
	if (group && (lchown(temporary, (uid_t)-1, *group) || chmod(temporary, 0660)))
		return -errno;
	if (lstat(temporary, &file) || listen(out->fd, WAITING))
		return -errno;
	out->device = file.st_dev;
	out->inode = file.st_ino;
	return 0;
}

/* Locks a file that only this user may open. (The folder itself would not do: whoever may read it
 * can lock it.) Returns a descriptor for lock_release(), or -errno. */
static int lock_take(const char *lock)
{
	const int fd = open(lock, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
	struct stat ours, there;
	int err = fd < 0 ? -errno : 0;

	if (!err && flock(fd, LOCK_EX | LOCK_NB))
		err = errno == EWOULDBLOCK ? -EADDRINUSE : -errno;
	/* The kiosk that held it may have removed it after we opened it. */
	if (!err && (fstat(fd, &ours) || stat(lock, &there) || ours.st_ino != there.st_ino))
		err = -EADDRINUSE;
	if (err && fd >= 0)
		close(fd);
	return err ? err : fd;
}

static void lock_release(const char *lock, int fd)
{
	unlink(lock);
	close(fd); /* closing unlocks it */
}

static int open_locked(struct control_socket *out, const char *path, const gid_t *group,
		       struct fault *fault)
{
	char temporary[sizeof(out->path) + sizeof(TEMPORARY)];
	int err;

	err = look_for_living(path, fault);
	if (err)
		return err;
	snprintf(temporary, sizeof(temporary), "%s" TEMPORARY, path);
	err = listen_at(out, temporary, group);
	if (!err && rename(temporary, path))
		err = -errno;
	if (err) {
		unlink(temporary);
		return fault_say(fault, err, "[control] socket: cannot listen at \"%s\": %s%s",
				 path, strerror(-err),
				 err == -EPERM ? " (is this user in the group of [control]?)" : "");
	}
	snprintf(out->path, sizeof(out->path), "%s", path);
	return 0;
}

int control_socket_open(struct control_socket *out, const char *path, const gid_t *group,
			struct fault *fault)
{
	char lock[sizeof(out->path) + sizeof(LOCK)];
	int fd, err;

	*out = (struct control_socket){.fd = -1};
	if (strlen(path) + sizeof(TEMPORARY) > sizeof(((struct sockaddr_un *)0)->sun_path))
		return fault_say(fault, -ENAMETOOLONG,
				 "[control] socket: \"%s\" is too long for a socket", path);
	snprintf(lock, sizeof(lock), "%s" LOCK, path);
	/* Two kiosks that start at once must not both find a dead socket and both replace it. */
	fd = lock_take(lock);
	if (fd == -EADDRINUSE)
		return fault_say(fault, fd, "[control] socket: another kiosk is opening \"%s\"",
				 path);
	if (fd < 0)
		return fault_say(fault, fd, "[control] socket: cannot use the folder of \"%s\": %s",
				 path, strerror(-fd));
	err = open_locked(out, path, group, fault);
	lock_release(lock, fd);
	return err;
}

void control_socket_close(struct control_socket *out)
{
	struct stat file;

	if (out->path[0] && lstat(out->path, &file) == 0 && file.st_dev == out->device &&
	    file.st_ino == out->inode)
		unlink(out->path);
	if (out->fd >= 0)
		close(out->fd);
	*out = (struct control_socket){.fd = -1};
}
