/* SPDX-License-Identifier: MIT */
#include "hal/base/output.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Fills out->path. Follows a symbolic link, because a rename would replace the link itself. Refuses
 * at once anything but a plain file: a rename would destroy a device or pipe, or fail late. */
static int output_find_target(struct output *out, const char *path, struct fault *fault)
{
	struct stat s;

	if (!*path)
		return fault_say(fault, -EINVAL, "the name of an output file is empty");
	if (strlen(path) >= sizeof(out->path) - 32)
		return fault_say(fault, -ENAMETOOLONG, "%.64s...: the name is too long", path);
	if (stat(path, &s) < 0) {
		strcpy(out->path, path);
		return 0;
	}
	if (!S_ISREG(s.st_mode))
		return fault_say(fault, S_ISDIR(s.st_mode) ? -EISDIR : -EINVAL,
				 "%s: cannot be written: it is %s, expected a plain file or none",
				 path, S_ISDIR(s.st_mode) ? "a folder" : "not a plain file");
	if (!realpath(path, out->path)) {
		const int err = -errno;

		return fault_say(fault, err, "%s: cannot be followed: %s", path, strerror(-err));
	}
	return 0;
}

static void output_folder(const char *path, char folder[PATH_MAX])
{
	char *slash;

	strcpy(folder, path);
	slash = strrchr(folder, '/');
	if (!slash)
		strcpy(folder, ".");
	else
		slash[slash == folder ? 1 : 0] = '\0';
}

/* Creates a file without a name: however the program ends, nothing is left of it. Returns a
 * descriptor. Negative where the file system has no such files or /proc, which output_commit()
 * needs, is missing. */
static int create_unnamed(const struct output *out)
{
	char folder[PATH_MAX];

	if (access("/proc/self/fd", F_OK) < 0)
		return -errno;
	output_folder(out->path, folder);
	return open(folder, O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
}

/* Calls make() with temporary names until one is free, and keeps that name in out->temporary.
 * Returns what make() returns, or -errno. */
static int with_temporary_name(struct output *out, int (*make)(const char *name, int fd), int fd)
{
	int ret = -EEXIST;

	for (unsigned n = 0; n < 10000 && ret == -EEXIST; n++) {
		const int length = snprintf(out->temporary, sizeof(out->temporary),
					    "%s.%ld-%u.part", out->path, (long)getpid(), n);

		if (length < 0 || (size_t)length >= sizeof(out->temporary)) {
			ret = -ENAMETOOLONG;
			break;
		}
		ret = make(out->temporary, fd);
		if (ret >= 0)
			return ret;
		ret = -errno;
	}
	*out->temporary = '\0';
	return ret;
}

/* Not mkstemp(): it ignores the umask, and only the owner could read the finished file. */
static int create_named(const char *name, int fd)
{
	(void)fd;
	return open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
}

static int give_name(const char *name, int fd)
{
	char unnamed[64];

	snprintf(unnamed, sizeof(unnamed), "/proc/self/fd/%d", fd);
	return linkat(AT_FDCWD, unnamed, AT_FDCWD, name, AT_SYMLINK_FOLLOW);
}

int output_open(struct output *out, const char *path, struct fault *fault)
{
	int fd, ret;

	memset(out, 0, sizeof(*out));
	ret = output_find_target(out, path, fault);
	if (ret < 0)
		return ret;
	fd = create_unnamed(out);
	if (fd < 0)
		fd = with_temporary_name(out, create_named, -1);
	if (fd < 0)
		return fault_say(fault, fd, "%s: cannot be written: %s", path, strerror(-fd));
	out->stream = fdopen(fd, "wb");
	if (!out->stream) {
		ret = -errno;
		close(fd);
		if (*out->temporary)
			unlink(out->temporary);
		return fault_say(fault, ret, "%s: cannot be written: %s", path, strerror(-ret));
	}
	return 0;
}

/* Whether two paths are one file: the same inode, or, of files that do not exist yet, the same name
 * in the same folder. */
static bool same_file(const char *a, const char *b)
{
	char folder[2][PATH_MAX];
	struct stat s[2];
	const int there = stat(a, &s[0]) == 0;

	if (there != (stat(b, &s[1]) == 0) || strlen(a) >= PATH_MAX || strlen(b) >= PATH_MAX)
		return false;
	if (there)
		return s[0].st_dev == s[1].st_dev && s[0].st_ino == s[1].st_ino;
	output_folder(a, folder[0]);
	output_folder(b, folder[1]);
	return !strcmp(basename(a), basename(b)) && stat(folder[0], &s[0]) == 0 &&
	       stat(folder[1], &s[1]) == 0 && s[0].st_dev == s[1].st_dev &&
	       s[0].st_ino == s[1].st_ino;
}

/* Opens the output as for writing and abandons it. */
static int try_output(const char *path, struct fault *fault)
{
	struct output out;
	const int ret = output_open(&out, path, fault);

	output_abandon(&out);
	return ret;
}

int output_check(const char *const *outputs, int count, const char *const *inputs, int input_count,
		 struct fault *fault)
{
	for (int i = 0; i < count; i++) {
		int ret = outputs[i] ? try_output(outputs[i], fault) : 0;

		for (int k = 0; outputs[i] && !ret && k < input_count; k++)
			if (inputs[k] && same_file(outputs[i], inputs[k]))
				ret = fault_say(fault, -EINVAL,
						"%s: is read, expected another name to write",
						outputs[i]);
		for (int k = 0; outputs[i] && !ret && k < i; k++)
			if (outputs[k] && same_file(outputs[i], outputs[k]))
				ret = fault_say(fault, -EINVAL,
						"%s: is to be written twice, expected two names",
						outputs[i]);
		if (ret)
			return ret;
	}
	return 0;
}

/* Syncs the folder, because the rename reaches the disk with it. Errors are ignored: some file
 * systems cannot sync a folder, and the file itself is whole. */
static void sync_folder(const char *path)
{
	char folder[PATH_MAX];
	int fd;

	output_folder(path, folder);
	fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return;
	(void)fsync(fd);
	close(fd);
}

static int output_flush(const struct output *out)
{
	FILE *stream = out->stream;

	errno = 0;
	if (fflush(stream) != 0)
		return errno ? -errno : -EIO;
	if (ferror(stream))
		return -EIO; /* an earlier write failed; its errno is lost */
	if (!out->unsynced && fsync(fileno(stream)) < 0 && errno != EINVAL && errno != EROFS)
		return -errno;
	return 0;
}

/* Some file systems cannot rename without replacing, but know links. */
static int output_rename(const struct output *out)
{
	int ret;

	if (!out->fresh)
		return rename(out->temporary, out->path);
	ret = renameat2(AT_FDCWD, out->temporary, AT_FDCWD, out->path, RENAME_NOREPLACE);
	if (ret < 0 && (errno == EINVAL || errno == ENOSYS)) {
		ret = link(out->temporary, out->path);
		if (!ret)
			unlink(out->temporary);
	}
	return ret;
}

int output_commit(struct output *out, struct fault *fault)
{
	int ret;

	if (!out->stream)
		return fault_say(fault, -EBADF, "%s: is not open for writing", out->path);
	ret = output_flush(out);
	if (ret == 0 && !*out->temporary)
		ret = with_temporary_name(out, give_name, fileno(out->stream));
	if (fclose(out->stream) != 0 && ret == 0)
		ret = errno ? -errno : -EIO;
	out->stream = NULL;
	if (ret == 0 && output_rename(out) < 0)
		ret = -errno;
	if (ret < 0) {
		if (*out->temporary)
			unlink(out->temporary);
		return fault_say(fault, ret, "%s: cannot be written: %s", out->path,
				 strerror(-ret));
	}
	if (!out->unsynced)
		sync_folder(out->path);
	return 0;
}

void output_abandon(struct output *out)
{
	if (!out->stream)
		return;
	fclose(out->stream);
	out->stream = NULL;
	if (*out->temporary)
		unlink(out->temporary);
}
