/* SPDX-License-Identifier: MIT */
/* Output files appear complete or not at all, and each message is a whole line. */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "hal/base/log.h"
#include "hal/base/output.h"
#include "tests/support/captured_log.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static int files_in_folder(void)
{
	DIR *dir = opendir(own_folder());
	int count = 0;

	assert_non_null(dir);
	for (struct dirent *entry; (entry = readdir(dir));)
		count += entry->d_name[0] != '.';
	closedir(dir);
	return count;
}

static void check_content(const char *path, const char *want)
{
	char text[64] = "";
	FILE *stream = fopen(path, "rb");

	assert_non_null(stream);
	text[fread(text, 1, sizeof(text) - 1, stream)] = '\0';
	fclose(stream);
	assert_string_equal(text, want);
}

TEST("appears by rename")
{
	const char *path = own_folder_path("a");
	struct output out;
	struct stat s;
	mode_t before;

	assert_int_equal(output_open(&out, path, NULL), 0);
	fputs("one", out.stream);
	fflush(out.stream);
	assert_int_not_equal(access(path, F_OK), 0);
	assert_int_equal(output_commit(&out, NULL), 0);
	check_content(path, "one");

	before = umask(027);
	assert_int_equal(output_open(&out, path, NULL), 0);
	umask(before);
	fputs("two", out.stream);
	fflush(out.stream);
	check_content(path, "one");
	assert_int_equal(output_commit(&out, NULL), 0);
	check_content(path, "two");
	assert_int_equal(stat(path, &s), 0);
	assert_int_equal(s.st_mode & 0777, 0640); /* as the umask says, not mkstemp()'s 0600 */

	assert_int_equal(output_commit(&out, NULL), -EBADF);
	output_abandon(&out);
	assert_int_equal(files_in_folder(), 1);
	unlink(path);
}

TEST("abandoned without trace")
{
	struct output zeroed = {.stream = NULL}, out;

	output_abandon(&zeroed);
	assert_int_equal(output_open(&out, own_folder_path("a"), NULL), 0);
	fputs("one", out.stream);
	output_abandon(&out);
	output_abandon(&out);
	assert_int_equal(files_in_folder(), 0);
}

TEST("two at once")
{
	struct output a, b;

	assert_int_equal(output_open(&a, own_folder_path("a"), NULL), 0);
	assert_int_equal(output_open(&b, own_folder_path("a"), NULL), 0);
	fputs("first", a.stream);
	fputs("second", b.stream);
	assert_int_equal(output_commit(&b, NULL), 0);
	assert_int_equal(output_commit(&a, NULL), 0);
	check_content(own_folder_path("a"), "first");
	assert_int_equal(files_in_folder(), 1);
	unlink(own_folder_path("a"));
}

/* A full disk, simulated by a limit on the size of files. */
TEST("full disk leaves the old file")
{
	static char block[65536];
	const char *path = own_folder_path("a");
	struct fault fault = {""};
	struct rlimit before, tight;
	struct output out;

	assert_int_equal(output_open(&out, path, NULL), 0);
	fputs("old", out.stream);
	assert_int_equal(output_commit(&out, NULL), 0);

	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	tight = before;
	tight.rlim_cur = 100000;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
	assert_int_equal(output_open(&out, path, NULL), 0);
	for (int k = 0; k < 4; k++)
		(void)!fwrite(block, 1, sizeof(block), out.stream);
	assert_true(output_commit(&out, &fault) < 0);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);

	assert_non_null(strstr(fault.text, path));
	check_content(path, "old");
	assert_int_equal(files_in_folder(), 1);
	unlink(path);
}

TEST("links are followed")
{
	char target[PATH_MAX], name[PATH_MAX];
	struct output out;
	struct stat s;

	strcpy(target, own_folder_path("target"));
	strcpy(name, own_folder_path("link"));
	assert_int_equal(symlink("target", name), 0);
	fclose(fopen(target, "wb"));
	assert_int_equal(output_open(&out, name, NULL), 0);
	fputs("new", out.stream);
	assert_int_equal(output_commit(&out, NULL), 0);
	check_content(target, "new");
	assert_int_equal(lstat(name, &s), 0);
	assert_true(S_ISLNK(s.st_mode));
	unlink(name);
	unlink(target);
}

TEST("refused")
{
	char path[2 * PATH_MAX];
	struct fault fault = {""};
	struct output out;

	assert_int_equal(output_open(&out, own_folder_path("no/such"), &fault), -ENOENT);
	assert_non_null(strstr(fault.text, "no/such"));
	assert_int_equal(output_open(&out, own_folder(), &fault), -EISDIR);
	assert_int_equal(output_open(&out, "/dev/null", &fault), -EINVAL); /* not replaced */
	assert_int_equal(output_open(&out, "", &fault), -EINVAL);
	memset(path, 'x', sizeof(path));
	path[sizeof(path) - 1] = '\0';
	assert_int_equal(output_open(&out, path, &fault), -ENAMETOOLONG);
	assert_null(out.stream);
	output_abandon(&out);
	assert_int_equal(files_in_folder(), 0);
}

/* ---- messages ---- */

#define LINES 200

static void *say_many(void *argument)
{
	for (int k = 0; k < LINES; k++)
		log_warning("thread %s says %d %*s", (const char *)argument, k, k, "");
	return NULL;
}

/* What work() wrote to stderr; the caller closes the stream. */
static FILE *captured(void (*work)(void))
{
	const struct captured_log log = captured_log_begin();

	work();
	return captured_log_end(&log);
}

static void two_threads_say(void)
{
	char a[] = "a", b[] = "b";
	pthread_t other;

	assert_int_equal(pthread_create(&other, NULL, say_many, a), 0);
	say_many(b);
	pthread_join(other, NULL);
}

TEST("lines stay whole")
{
	FILE *stream;
	char line[512], want[512], name;
	int count = 0, number;

	log_setup("inlay-test", LOG_LEVEL_WARNING);
	stream = captured(two_threads_say);
	for (; fgets(line, sizeof(line), stream); count++) {
		assert_int_equal(sscanf(line, "inlay-test: thread %c says %d", &name, &number), 2);
		/* the message holds the length of its padding */
		snprintf(want, sizeof(want), "inlay-test: thread %c says %d %*s\n", name, number,
			 number, "");
		assert_string_equal(line, want);
	}
	assert_int_equal(count, 2 * LINES);
	fclose(stream);
}

static void speak_at_all_levels(void)
{
	static char endless[5000];

	memset(endless, 'z', sizeof(endless) - 1);
	log_error("error");
	log_warning("warning");
	log_info("info");
	log_debug("debug");
	log_error("%s", endless);
}

TEST("levels and long lines")
{
	FILE *stream;
	char line[8192];

	log_setup("p", LOG_LEVEL_INFO);
	stream = captured(speak_at_all_levels);
	assert_non_null(fgets(line, sizeof(line), stream));
	assert_string_equal(line, "p: error\n");
	assert_non_null(fgets(line, sizeof(line), stream));
	assert_non_null(fgets(line, sizeof(line), stream));
	assert_string_equal(line, "p: info\n");
	assert_non_null(fgets(line, sizeof(line), stream)); /* cut off, but still a line */
	assert_true(strlen(line) > 1000 && line[strlen(line) - 1] == '\n');
	assert_null(fgets(line, sizeof(line), stream));
	fclose(stream);
}

static void speak_in_controls(void)
{
	log_error("%s", "a\nb\rc\x1b[31md\x7f\te\xc3\xa4\xe2\x82\xac\xc2\x9b"
			"f\xc2\xa0");
	log_error("%s", "");
}

/* One message is one line, and control characters cannot reach the terminal. UTF-8 stays as it is.
 */
TEST("controls are replaced")
{
	FILE *stream;
	char line[256];

	log_setup("p", LOG_LEVEL_INFO);
	stream = captured(speak_in_controls);
	assert_non_null(fgets(line, sizeof(line), stream));
	assert_string_equal(line, "p: a?b?c?[31md?\te\xc3\xa4\xe2\x82\xac??f\xc2\xa0\n");
	assert_non_null(fgets(line, sizeof(line), stream));
	assert_string_equal(line, "p: \n");
	assert_null(fgets(line, sizeof(line), stream));
	fclose(stream);
}

/* However the program ends, it leaves no temporary file. */
TEST("killed without trace")
{
	const pid_t child = fork();
	int status;

	assert_true(child >= 0);
	if (child == 0) {
		struct output out;

		if (output_open(&out, own_folder_path("killed"), NULL) == 0) {
			fputs("half of it", out.stream);
			fflush(out.stream);
		}
		kill(getpid(), SIGKILL);
	}
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_true(WIFSIGNALED(status));
	assert_int_equal(files_in_folder(), 0);
}

/* Checked before any work: no output may replace an input or another output. */
TEST("checked before")
{
	char input[PATH_MAX], hard[PATH_MAX], soft[PATH_MAX], fresh[PATH_MAX], again[PATH_MAX];
	struct fault fault = {.text = ""};
	const char *const read[] = {NULL, input};
	FILE *stream;

	strcpy(input, own_folder_path("in"));
	strcpy(hard, own_folder_path("hard"));
	strcpy(soft, own_folder_path("soft"));
	strcpy(fresh, own_folder_path("out"));
	strcpy(again, own_folder_path("./out"));
	stream = fopen(input, "w");
	assert_non_null(stream);
	assert_int_equal(fclose(stream), 0);
	assert_int_equal(link(input, hard), 0);
	assert_int_equal(symlink(input, soft), 0);
	assert_int_equal(output_check((const char *[]){fresh, NULL, hard}, 2, read, 2, &fault), 0);
	for (int k = 0; k < 3; k++) {
		const char *const out[] = {fresh, k == 0 ? input : k == 1 ? hard : soft};

		expect_equal(output_check(out, 2, read, 2, &fault), -EINVAL, "k=%d", k);
		assert_non_null(strstr(fault.text, "is read, expected another name"));
	}
	assert_int_equal(output_check((const char *[]){fresh, again}, 2, read, 2, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "written twice"));
	assert_int_equal(
		output_check((const char *[]){own_folder_path("no/out")}, 1, read, 2, &fault),
		-ENOENT);
	assert_int_equal(files_in_folder(), 3);
	unlink(input);
	unlink(hard);
	unlink(soft);
}

TEST_GROUP(own_folder_make, own_folder_remove);
