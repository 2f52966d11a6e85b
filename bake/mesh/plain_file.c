/* SPDX-License-Identifier: MIT */
#include "bake/mesh/plain_file.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/input.h"

static int open_plain(const char *path, uint64_t most, struct stat *about, struct fault *fault)
{
	const int fd = input_open(path, fault);
	int err = fd < 0 ? fd : 0;

	if (!err && fstat(fd, about)) {
		err = -errno;
		fault_say(fault, err, "%s: %s", path, strerror(-err));
	} else if (!err && !S_ISREG(about->st_mode)) {
		err = fault_say(fault, -EINVAL, "%s: a pipe, expected a file", path);
	} else if (!err && (uint64_t)about->st_size > most) {
		err = fault_say(fault, -EFBIG, "%s: %lld bytes long, expected at most %llu", path,
				(long long)about->st_size, (unsigned long long)most);
	}
	if (err && fd >= 0)
		close(fd);
	return err ? err : fd;
}

int plain_file_open(FILE **file, const char *path, uint64_t most, struct fault *fault)
{
	struct stat about;
	const int fd = open_plain(path, most, &about, fault);

	*file = NULL;
	if (fd < 0)
		return fd;
	*file = fdopen(fd, "r");
	if (*file)
		return 0;
	close(fd);
	return fault_say(fault, -ENOMEM, "%s: out of memory", path);
}

int plain_file_map(struct plain_map *map, const char *path, uint64_t most, struct fault *fault)
{
	struct stat about;
	const int fd = open_plain(path, most, &about, fault);
	void *at;
	int err = 0;

	*map = (struct plain_map){.at = ""};
	if (fd < 0)
		return fd;
	if (about.st_size > 0) {
		at = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
		if (at == MAP_FAILED) {
			err = -errno;
			fault_say(fault, err, "%s: cannot be read: %s", path, strerror(-err));
		} else {
			*map = (struct plain_map){at, (size_t)about.st_size};
		}
	}
	close(fd);
	return err;
}

void plain_file_unmap(struct plain_map *map)
{
	if (map->bytes)
		munmap((void *)map->at, map->bytes);
	*map = (struct plain_map){.at = ""};
}
