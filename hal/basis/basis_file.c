/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

/* Largest single read, so that a signal does not interrupt a long one. */
#define READ_MOST ((size_t)64 << 20)

static int file_measure(struct basis_file *file, const char *path, struct fault *fault)
{
	struct stat s;
	int err;

	if (fstat(file->fd, &s) < 0) {
		err = -errno;
		return fault_say(fault, err, "%s: cannot be read: %s", path, strerror(-err));
	}
	if (!S_ISREG(s.st_mode))
		return fault_say(fault, -EINVAL, "%s: not a plain file, expected a basis file",
				 path);
	if (s.st_size == 0)
		return fault_say(fault, -EBADMSG, "%s: empty, expected a basis file", path);
	if ((uintmax_t)s.st_size > SIZE_MAX)
		return fault_say(fault, -EFBIG, "%s: too large for this machine", path);
	file->bytes = (size_t)s.st_size;
	return 0;
}

/* Size of large pages. Shorter chunks use small pages: otherwise the block list of each packed pose
 * would hold a large page for a few kilobytes. */
#define LARGE_PAGE ((uint64_t)2 << 20)

static int provide_memory(struct basis_file *file, bool mapped, const char *path,
			  struct fault *fault)
{
	void *memory = mapped ? mmap(NULL, file->bytes, PROT_READ, MAP_PRIVATE, file->fd, 0)
			      : mmap(NULL, file->bytes, PROT_READ | PROT_WRITE,
				     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
	int err;

	if (memory == MAP_FAILED) {
		err = -errno;
		return fault_say(fault, err, "%s: no memory for its %zu bytes: %s", path,
				 file->bytes, strerror(-err));
	}
	(void)madvise(memory, file->bytes, mapped ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
	file->memory = memory;
	return 0;
}

int basis_file_open(struct basis_file *file, const char *path, enum basis_part part,
		    struct fault *fault)
{
	const bool mapped = part == BASIS_ALL;
	int ret;

	*file = (struct basis_file){.fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
	if (file->fd < 0) {
		ret = -errno;
		return fault_say(fault, ret, "%s: cannot be opened: %s", path, strerror(-ret));
	}
	ret = file_measure(file, path, fault);
	if (ret == 0)
		ret = provide_memory(file, mapped, path, fault);
	if (ret < 0) {
		basis_file_close(file);
		return ret;
	}
	if (mapped) {
		close(file->fd);
		file->fd = -1;
	}
	return 0;
}

void basis_file_close(struct basis_file *file)
{
	if (file->fd >= 0)
		close(file->fd);
	if (file->memory)
		munmap(file->memory, file->bytes);
	*file = (struct basis_file){.fd = -1};
}

static int read_at(const struct basis_reader *r, uint64_t offset, uint64_t bytes, uint8_t *to)
{
	while (bytes > 0) {
		const size_t part = bytes < READ_MOST ? (size_t)bytes : READ_MOST;
		const ssize_t got = pread(r->file->fd, to, part, (off_t)offset);
		const int err = -errno;

		if (got < 0 && err == -EINTR)
			continue;
		if (got < 0)
			return fault_say(r->fault, err, "%s: cannot be read: %s", r->name,
					 strerror(-err));
		if (got == 0)
			return basis_damaged(r, "it ends at byte %llu (was it cut short?)",
					     (unsigned long long)offset);
		to += got;
		offset += (uint64_t)got;
		bytes -= (uint64_t)got;
	}
	return 0;
}

int basis_file_fetch(const struct basis_reader *r, uint64_t offset, uint64_t bytes)
{
	if (!r->file)
		return 0;
	if (r->file->fd >= 0) {
		/* each frame reads through all of the shown layer */
		if (bytes >= LARGE_PAGE)
			(void)madvise(r->file->memory + offset, bytes, MADV_HUGEPAGE);
		return read_at(r, offset, bytes, r->file->memory + offset);
	}
	/* Offsets are multiples of a page but for the header, which is in memory already. */
	(void)madvise(r->file->memory + offset, bytes, MADV_WILLNEED);
	return 0;
}

int basis_file_borrow(const struct basis_reader *r, uint64_t offset, uint64_t bytes,
		      const uint8_t **data, void **owned)
{
	int ret;

	*owned = NULL;
	*data = r->data + offset;
	if (!r->file || r->file->fd < 0)
		return 0;
	*owned = malloc(bytes ? bytes : 1);
	if (!*owned)
		return fault_say(r->fault, -ENOMEM, "%s: out of memory", r->name);
	*data = *owned;
	ret = read_at(r, offset, bytes, *owned);
	if (ret < 0) {
		free(*owned);
		*owned = NULL;
	}
	return ret;
}
