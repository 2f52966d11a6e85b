/* SPDX-License-Identifier: MIT */
/* Text files line by line, and the numbers in them. */
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/base/number.h"
#include "hal/base/text_file.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static void write_text(const char *text, size_t bytes)
{
	FILE *stream = fopen(own_folder_path("text"), "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(text, 1, bytes, stream), bytes);
	assert_int_equal(fclose(stream), 0);
}

TEST("lines without their breaks")
{
	static const char text[] = "\xef\xbb\xbfone\r\n\n\xef\xbb\xbfthree \r\r\nfour";
	static const char *const want[] = {"one", "", "\xef\xbb\xbfthree \r", "four"};
	struct text_file file;

	write_text(text, sizeof(text) - 1);
	assert_int_equal(text_file_open(&file, own_folder_path("text"), NULL), 0);
	assert_int_equal(file.number, 0);
	for (int k = 0; k < 4; k++) {
		expect_equal(text_file_next(&file, NULL), 1, "k=%d", k);
		assert_string_equal(file.line, want[k]);
		expect_equal(file.number, k + 1, "k=%d", k);
	}
	assert_int_equal(text_file_next(&file, NULL), 0);
	assert_int_equal(text_file_next(&file, NULL), 0);
	assert_int_equal(file.number, 4);
	text_file_close(&file);
	text_file_close(&file);
	write_text("", 0);
	assert_int_equal(text_file_open(&file, own_folder_path("text"), NULL), 0);
	assert_int_equal(text_file_next(&file, NULL), 0);
	text_file_close(&file);
	unlink(own_folder_path("text"));
}

/* Expects that line number `lines`, the last one, is refused. */
static void test_text_file_expect(const char *path, int lines, int err, const char *says)
{
	struct fault fault = {""};
	struct text_file file;

	assert_int_equal(text_file_open(&file, path, &fault), 0);
	for (int k = 1; k < lines; k++)
		expect_equal(text_file_next(&file, &fault), 1, "k=%d", k);
	assert_int_equal(text_file_next(&file, &fault), err);
	assert_memory_equal(fault.text, path, strlen(path));
	assert_string_equal(fault.text + strlen(path), says);
	text_file_close(&file);
}

TEST("no text")
{
	static char wide[TEXT_LINE_BYTES_MAX + 2];
	struct fault fault = {""};
	struct text_file file;

	write_text("one\nt\0o\n", 8);
	test_text_file_expect(own_folder_path("text"), 2, -EINVAL,
			      ":2: holds a zero byte, expected a text file");
	memset(wide, 'x', sizeof(wide));
	write_text(wide, TEXT_LINE_BYTES_MAX);
	assert_int_equal(text_file_open(&file, own_folder_path("text"), NULL), 0);
	assert_int_equal(text_file_next(&file, NULL), 1);
	assert_int_equal(strlen(file.line), TEXT_LINE_BYTES_MAX);
	text_file_close(&file);
	write_text(wide, TEXT_LINE_BYTES_MAX + 1);
	test_text_file_expect(own_folder_path("text"), 1, -EINVAL,
			      ":1: the line is too long, expected at most 65536 bytes");
	unlink(own_folder_path("text"));
	assert_int_equal(text_file_open(&file, own_folder_path("none"), &fault), -ENOENT);
	assert_non_null(strstr(fault.text, "/none: No such file or directory"));
	text_file_close(&file);
}

static void test_text_file_refuse(const char *path, int err, const char *what)
{
	struct fault fault = {""};
	struct text_file file;
	char says[PATH_MAX + 80];

	assert_int_equal(text_file_open(&file, path, &fault), err);
	snprintf(says, sizeof(says), "%s: not a regular file but a %s, expected one to read", path,
		 what);
	assert_string_equal(fault.text, says);
}

/* Files that a reader would wait for, or read, for ever. */
TEST("no files")
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int listener = socket(AF_UNIX, SOCK_STREAM, 0);

	alarm(60);
	test_text_file_refuse(own_folder(), -EISDIR, "folder");
	test_text_file_refuse("/dev/zero", -EINVAL, "device");
	assert_int_equal(mkfifo(own_folder_path("pipe"), 0600), 0);
	test_text_file_refuse(own_folder_path("pipe"), -EINVAL, "named pipe");
	unlink(own_folder_path("pipe"));
	assert_true(snprintf(address.sun_path, sizeof(address.sun_path), "%s",
			     own_folder_path("socket")) > 0);
	assert_int_equal(bind(listener, (struct sockaddr *)&address, sizeof(address)), 0);
	test_text_file_refuse(own_folder_path("socket"), -EINVAL, "socket");
	close(listener);
	unlink(own_folder_path("socket"));
	alarm(0);
}

/* A pipe as a shell's <(command) gives it; the command may be slow. */
TEST("the pipe of a command")
{
	char path[40];
	struct text_file file;
	int ends[2];
	pid_t command;

	assert_int_equal(pipe(ends), 0);
	command = fork();
	if (!command) {
		usleep(100000);
		_exit(write(ends[1], "late\n", 5) != 5);
	}
	assert_true(command > 0);
	close(ends[1]);
	snprintf(path, sizeof(path), "/dev/fd/%d", ends[0]);
	assert_int_equal(text_file_open(&file, path, NULL), 0);
	assert_int_equal(text_file_next(&file, NULL), 1);
	assert_string_equal(file.line, "late");
	assert_int_equal(text_file_next(&file, NULL), 0);
	text_file_close(&file);
	close(ends[0]);
	assert_int_equal(waitpid(command, NULL, 0), command);
}

/* Endless blank lines, which no limit on a line stops. */
TEST("large files")
{
	struct fault fault = {""};
	struct text_file file;
	FILE *stream = fopen(own_folder_path("text"), "wb");
	int ret, lines = 0;

	assert_non_null(stream);
	for (int k = 0; k < TEXT_FILE_BYTES_MAX; k++)
		putc_unlocked('\n', stream);
	fflush(stream);
	for (int more = 0; more < 2; more++) {
		assert_int_equal(text_file_open(&file, own_folder_path("text"), NULL), 0);
		for (lines = 0; (ret = text_file_next(&file, &fault)) > 0;)
			lines++;
		text_file_close(&file);
		expect_equal(ret, more ? -EFBIG : 0, "more=%d", more);
		expect_equal(lines, TEXT_FILE_BYTES_MAX, "more=%d", more);
		fputs("\n", stream);
		fflush(stream);
	}
	assert_non_null(strstr(fault.text, "/text: is larger than 16 MiB, expected a text file"));
	fclose(stream);
	unlink(own_folder_path("text"));
}

TEST("numbers")
{
	static const struct {
		const char *text;
		double value;
		const char *rest;
	} right[] = {
		{"1", 1, ""},	  {"-.5e+1 7", -5, " 7"}, {"+3.,4", 3, ",4"}, {"25mm", 25, "mm"},
		{"50%", 50, "%"}, {"0", 0, ""},		  {"1e-400", 0, ""},  {"007", 7, ""},
	};
	static const char *const wrong[] = {"",	   " 1",    "x",  "0x10", "0x1p3", "nan",   "inf",
					    "1-2", "1e4e4", "1e", "-",	  "e5",	   "1e999", "."};
	const char *at;
	double value;

	for (size_t k = 0; k < sizeof(right) / sizeof(*right); k++) {
		at = right[k].text;
		assert_int_equal(number_read(&at, &value), 0);
		expect_equal(value, right[k].value, "k=%zu", k);
		assert_string_equal(at, right[k].rest);
		value = 42;
		expect_equal(number_of(right[k].text, &value), *at ? -EINVAL : 0, "k=%zu", k);
		expect_equal(value, (*at ? 42 : right[k].value), "k=%zu", k);
	}
	for (size_t k = 0; k < sizeof(wrong) / sizeof(*wrong); k++) {
		at = wrong[k];
		value = 42;
		expect_equal(number_read(&at, &value), -EINVAL, "k=%zu", k);
		expect_equal(number_of(at, &value), -EINVAL, "k=%zu", k);
		expect_that(at == wrong[k] && value == 42, "k=%zu", k);
	}
}

TEST_GROUP(own_folder_make, own_folder_remove);
