/* SPDX-License-Identifier: MIT */
/* Files that are followed: written in place, renamed over, linked, missing at first. */
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bake/base/watch.h"
#include "hal/base/input.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static struct watch *watch;

static void write_file(const char *name, const char *text)
{
	FILE *file = fopen(own_folder_path(name), "w");

	assert_non_null(file);
	assert_true(fputs(text, file) >= 0);
	assert_int_equal(fclose(file), 0);
}

static void rename_file(const char *from, const char *to)
{
	char path[PATH_MAX];

	snprintf(path, sizeof(path), "%s", own_folder_path(from));
	assert_int_equal(rename(path, own_folder_path(to)), 0);
}

static void remove_file(const char *name)
{
	assert_int_equal(unlink(own_folder_path(name)), 0);
}

/* Opens a file as a reader would, whether or not it is there. */
static void follow(const char *name)
{
	struct fault fault;
	int fd;

	watch_begin(watch);
	fd = input_open(own_folder_path(name), &fault);
	if (fd >= 0)
		close(fd);
	assert_int_equal(watch_end(watch, &fault), 0);
}

static bool changed(void)
{
	return watch_wait(watch, 300);
}

static int watch_set_up(void **state)
{
	struct fault fault;

	return own_folder_make(state) || watch_create(&watch, &fault);
}

static int watch_tear_down(void **state)
{
	watch_destroy(watch);
	return own_folder_remove(state);
}

TEST("files written in place and renamed over")
{
	write_file("scene", "1");
	follow("scene");
	assert_false(changed());
	write_file("scene", "2");
	assert_true(changed());
	assert_false(changed());
	/* a new inode under the old name, twice: the watch outlives the first */
	for (int k = 0; k < 2; k++) {
		write_file("part", "3");
		rename_file("part", "scene");
		assert_true(changed());
		follow("scene");
		assert_false(changed());
	}
	/* as vi does: the old file steps aside first */
	rename_file("scene", "scene~");
	write_file("scene", "4");
	assert_true(changed());
	assert_false(changed());
	remove_file("scene~");
	remove_file("scene");
	assert_true(changed());
}

TEST("only files that were read count")
{
	write_file("mesh", "1");
	write_file("other", "1");
	follow("mesh");
	write_file("other", "2");
	write_file("mesh.bak", "2");
	assert_false(changed());
	follow("other");
	write_file("mesh", "2");
	assert_false(changed());
	write_file("other", "3");
	assert_true(changed());
	remove_file("mesh");
	remove_file("mesh.bak");
	remove_file("other");
}

/* A file that is missing, and one whose folder is: they are read when they come. */
TEST("missing files are waited for")
{
	follow("texture");
	assert_false(changed());
	write_file("texture", "1");
	assert_true(changed());
	remove_file("texture");
	follow("maps/old/coat");
	assert_int_equal(mkdir(own_folder_path("maps"), 0700), 0);
	assert_int_equal(mkdir(own_folder_path("maps/old"), 0700), 0);
	assert_false(changed());
	write_file("maps/old/coat", "1");
	assert_true(changed());
	/* the whole folder is exchanged */
	follow("maps/old/coat");
	rename_file("maps/old", "maps/new");
	assert_true(changed());
	remove_file("maps/new/coat");
	assert_int_equal(rmdir(own_folder_path("maps/new")), 0);
	assert_int_equal(rmdir(own_folder_path("maps")), 0);
}

/* A symbolic link changes with the file that it leads to, and when it leads to another. */
TEST("links are followed")
{
	char link[PATH_MAX];

	assert_int_equal(mkdir(own_folder_path("store"), 0700), 0);
	write_file("store/a", "1");
	write_file("store/b", "1");
	snprintf(link, sizeof(link), "%s", own_folder_path("current"));
	assert_int_equal(symlink("store/a", link), 0);
	follow("current");
	write_file("store/a", "2");
	assert_true(changed());
	assert_int_equal(symlink("store/b", own_folder_path("next")), 0);
	rename_file("next", "current");
	assert_true(changed());
	follow("current");
	write_file("store/a", "3");
	assert_false(changed());
	write_file("store/b", "3");
	assert_true(changed());
	remove_file("current");
	remove_file("store/a");
	remove_file("store/b");
	assert_int_equal(rmdir(own_folder_path("store")), 0);
}

/* So does a link of a folder on the way. */
TEST("links of folders are followed")
{
	char link[PATH_MAX];

	assert_int_equal(mkdir(own_folder_path("one"), 0700), 0);
	assert_int_equal(mkdir(own_folder_path("two"), 0700), 0);
	write_file("one/a", "1");
	write_file("two/a", "2");
	snprintf(link, sizeof(link), "%s", own_folder_path("current"));
	assert_int_equal(symlink("one", link), 0);
	follow("current/a");
	write_file("one/a", "3");
	assert_true(changed());
	assert_int_equal(symlink("two", own_folder_path("next")), 0);
	rename_file("next", "current");
	assert_true(changed());
	remove_file("current");
	remove_file("one/a");
	remove_file("two/a");
	assert_int_equal(rmdir(own_folder_path("one")), 0);
	assert_int_equal(rmdir(own_folder_path("two")), 0);
}

/* A file that is never left alone is told of all the same. */
TEST("storms end")
{
	char path[PATH_MAX];
	pid_t writer;

	write_file("a", "1");
	follow("a");
	snprintf(path, sizeof(path), "%s", own_folder_path("a"));
	writer = fork();
	assert_true(writer >= 0);
	if (!writer) {
		for (int k = 0; k < 6000; k++) { /* a minute */
			(void)utimensat(AT_FDCWD, path, NULL, 0);
			usleep(10000);
		}
		_exit(0);
	}
	assert_true(watch_wait(watch, -1));
	assert_int_equal(waitpid(writer, NULL, WNOHANG), 0);
	kill(writer, SIGKILL);
	assert_int_equal(waitpid(writer, NULL, 0), writer);
	remove_file("a");
}

TEST_GROUP(watch_set_up, watch_tear_down);
