#include "bake/plain_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static int check_file(const struct stat *about, const char *path, uint64_t most,
		      struct fault *fault)
{
	if (!S_ISREG(about->st_mode))
		return fault_say(fault, -EINVAL, "%s: not a plain file, expected one", path);
	if ((uint64_t)about->st_size > most)
		return fault_say(fault, -EFBIG, "%s: %lld bytes long, expected at most %llu", path,
				 (long long)about->st_size, (unsigned long long)most);
	return 0;
}

/* Without O_NONBLOCK a pipe that nobody writes to is waited for. */
static int open_plain(const char *path, uint64_t most, struct stat *about, struct fault *fault)
{
	const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
	int err;

	if (fd < 0 || fstat(fd, about)) {
		err = -errno;
		fault_say(fault, err, "%s: cannot be opened: %s", path, strerror(-err));
	} else {
		err = check_file(about, path, most, fault);
	}
	if (!err)
		return fd;
	if (fd >= 0)
		close(fd);
	return err;
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
