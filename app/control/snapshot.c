/* SPDX-License-Identifier: MIT */
#include "app/control/snapshot.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/memfd.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define SEALS (F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL)
#define SIDE_MAX 32768
#define ROW_ALIGNED 64 /* bytes: a cache line */

#ifndef MFD_NOEXEC_SEAL
#define MFD_NOEXEC_SEAL 8U
#endif

static void set_size(struct snapshot *s, int width, int height)
{
	s->width = width;
	s->height = height;
	s->stride = ((size_t)width * 4 + ROW_ALIGNED - 1) / ROW_ALIGNED * ROW_ALIGNED;
}

static size_t snapshot_bytes(const struct snapshot *s)
{
	return s->stride * (size_t)s->height;
}

static int snapshot_map(struct snapshot *s, int protection, int flags)
{
	void *at = mmap(NULL, snapshot_bytes(s), protection, flags, s->fd, 0);

	if (at == MAP_FAILED)
		return -errno;
	s->pixels = at;
	return 0;
}

int snapshot_create(struct snapshot *s, int width, int height, struct fault *fault)
{
	const unsigned flags = MFD_CLOEXEC | MFD_ALLOW_SEALING;
	int err = 0;

	*s = (struct snapshot){.fd = memfd_create("inlay-snapshot", flags | MFD_NOEXEC_SEAL)};
	if (s->fd < 0 && errno == EINVAL) /* before Linux 6.3 */
		s->fd = memfd_create("inlay-snapshot", flags);
	if (s->fd < 0)
		err = -errno;
	set_size(s, width, height);
	if (!err && ftruncate(s->fd, (off_t)snapshot_bytes(s)))
		err = -errno;
	if (!err)
		err = snapshot_map(s, PROT_READ | PROT_WRITE, MAP_SHARED);
	return err ? fault_say(fault, err, "there is no memory for the picture: %s", strerror(-err))
		   : 0;
}

static void snapshot_unmap(struct snapshot *s)
{
	if (s->pixels)
		munmap(s->pixels, snapshot_bytes(s));
	s->pixels = NULL;
}

int snapshot_seal(struct snapshot *s, char line[SNAPSHOT_LINE_MAX], struct fault *fault)
{
	int err;

	snprintf(line, SNAPSHOT_LINE_MAX, "snapshot %d %d", s->width, s->height);
	snapshot_unmap(s); /* a mapping that can be written forbids the seal */
	if (!fcntl(s->fd, F_ADD_SEALS, SEALS))
		return 0;
	err = -errno;
	return fault_say(fault, err, "the picture cannot be sealed: %s", strerror(-err));
}

int snapshot_open(struct snapshot *s, int fd, const char *line, struct fault *fault)
{
	int width, height, end = -1, seals, err;
	struct stat file;

	*s = (struct snapshot){.fd = fd};
	(void)sscanf(line, "snapshot %5d %5d%n", &width, &height, &end);
	if (end < 0 || line[end] || width < 1 || height < 1 || width > SIDE_MAX ||
	    height > SIDE_MAX || fd < 0)
		return fault_say(fault, -EBADMSG,
				 "the kiosk answered \"%.60s\", expected a picture", line);
	set_size(s, width, height);
	seals = fcntl(fd, F_GET_SEALS);
	/* unsealed, it might shrink while it is read, which is a signal */
	if (seals < 0 || (seals & SEALS) != SEALS || fstat(fd, &file) ||
	    (uint64_t)file.st_size != snapshot_bytes(s))
		return fault_say(fault, -EBADMSG, "the kiosk's picture is no sealed one of %dx%d",
				 width, height);
	err = snapshot_map(s, PROT_READ, MAP_PRIVATE);
	return err ? fault_say(fault, err, "the kiosk's picture cannot be read: %s", strerror(-err))
		   : 0;
}

void snapshot_close(struct snapshot *s)
{
	snapshot_unmap(s);
	if (s->fd >= 0)
		close(s->fd);
	s->fd = -1;
}
