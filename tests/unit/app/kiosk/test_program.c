/* SPDX-License-Identifier: MIT */
/* Options, event loop and statistics. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/kiosk/loop.h"
#include "app/records/records.h"
#include "hal/base/clock.h"
#include "hal/options/options.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

/* ---- options ---- */

struct taken_values {
	const char *word, *out;
	struct option_list list;
	bool flag, given;
	int number, which, size[2];
	double real;
};

#define AT(field) .place = offsetof(struct taken_values, field)

static const char *const choices[] = {"one", "two", NULL};

static const struct option_row rows[] = {
	{"word", OPTION_TEXT, AT(word), .argument = "WORD", .help = "h"},
	{"out", OPTION_TEXT, AT(out), .argument = "WORD", .help = "h"},
	{"list", OPTION_LIST, AT(list), .argument = "WORD", .help = "h"},
	{"flag", OPTION_FLAG, AT(flag), .help = "h"},
	{"number", OPTION_INT, AT(number), .min = 1, .max = 9,
	 .given = offsetof(struct taken_values, given), .argument = "N", .help = "h"},
	{"real", OPTION_REAL, AT(real), .max = 255, .argument = "X", .help = "h"},
	{"size", OPTION_SIZE, AT(size), .argument = "WxH", .help = "h"},
	{"which", OPTION_CHOICE, AT(which), .choices = choices, .argument = "W", .help = "h"},
	{.name = NULL}};

static const struct command command = {.name = "try", .usage = "", .summary = ""};

static int read_words(struct taken_values *taken, const char *first, ...)
{
	char *argv[20] = {(char *)"try"};
	va_list args;
	int argc = 1;

	*taken = (struct taken_values){.word = NULL};
	va_start(args, first);
	for (const char *word = first; word; word = va_arg(args, const char *))
		argv[argc++] = (char *)word;
	va_end(args);
	return command_read_all(&command, argc, argv, rows, taken);
}

TEST("options are read")
{
	struct taken_values taken;

	assert_int_equal(read_words(&taken, NULL), COMMAND_GOES_ON);
	assert_false(taken.given);
	assert_int_equal(read_words(&taken, "--word=c=d", "--list", "a b", "-o", "--x",
				    "--list=", "--flag", "--number", "9", "--real=12.5", "--size",
				    "3x4", "--which", "two", NULL),
			 COMMAND_GOES_ON);
	assert_string_equal(taken.word, "c=d");
	assert_int_equal(taken.list.count, 2);
	assert_string_equal(taken.list.text[0], "a b");
	assert_string_equal(taken.list.text[1], "");
	assert_string_equal(taken.out, "--x");
	assert_true(taken.flag && taken.given);
	assert_int_equal(taken.number, 9);
	assert_true(taken.real == 12.5);
	assert_int_equal(taken.size[0], 3);
	assert_int_equal(taken.size[1], 4);
	assert_int_equal(taken.which, 1);
}

TEST("wrong options are wrong usage")
{
	static const char *const wrong[] = {"--wrod=a",	   "--word",	"--flag=1",   "--number=10",
					    "--number=5x", "--number=", "--real=nan", "--real=inf",
					    "--real=256",  "--real=1 ", "--size=3",   "--size=0x4",
					    "--which=x",   "word",	"-",	      "-q",
					    "-o"};
	char *argv[OPTION_LIST_MAX + 2] = {(char *)"try"};
	struct taken_values taken = {.word = NULL};

	for (size_t k = 0; k < sizeof(wrong) / sizeof(*wrong); k++)
		expect_equal(read_words(&taken, wrong[k], NULL), EXIT_USAGE, "%s", wrong[k]);
	for (int k = 0; k <= OPTION_LIST_MAX; k++)
		argv[1 + k] = (char *)"--list=a";
	assert_int_equal(command_read_all(&command, 2 + OPTION_LIST_MAX, argv, rows, &taken),
			 EXIT_USAGE);
}

/* ---- loop ---- */

TEST("slots are polled")
{
	struct fault fault = {.text = ""};
	struct loop loop;
	int a = eventfd(0, EFD_NONBLOCK), b = eventfd(1, EFD_NONBLOCK);

	assert_int_equal(loop_open(&loop, &fault), 0);
	assert_int_equal(loop_watch(&loop, 0, a, &fault), 0);
	assert_int_equal(loop_watch(&loop, 3, b, &fault), 0);
	assert_int_equal(loop_watch(&loop, 3, b, &fault), 0);
	assert_int_equal(loop_wait(&loop, &fault), 0);
	assert_false(loop_ready(&loop, 0));
	assert_true(loop_ready(&loop, 3));
	assert_int_equal(loop_watch(&loop, 3, -1, &fault), 0);
	assert_int_equal(eventfd_write(a, 1), 0);
	assert_int_equal(loop_wait(&loop, &fault), 0);
	assert_true(loop_ready(&loop, 0));
	assert_false(loop_ready(&loop, 3));
	/* A descriptor is closed and its number used again: the loop must have removed it first. */
	close(a);
	assert_int_equal(loop_watch(&loop, 0, -1, &fault), 0);
	assert_int_equal(dup2(b, a), a);
	assert_int_equal(loop_watch(&loop, 0, a, &fault), 0);
	assert_int_equal(loop_wait(&loop, &fault), 0);
	assert_true(loop_ready(&loop, 0));
	assert_int_equal(loop_watch(&loop, 1, 999, &fault), -EBADF);
	loop_close(&loop);
	loop_close(&loop);
	close(a);
	close(b);
}

TEST("signals end it and seconds tick")
{
	struct fault fault = {.text = ""};
	struct loop loop;
	int64_t start;

	(void)signal(SIGHUP, SIG_DFL); /* nohup leaves the signal ignored */
	assert_int_equal(loop_open(&loop, &fault), 0);
	start = clock_now_ns();
	loop_start(&loop);
	assert_int_equal(loop_wait(&loop, &fault), 0);
	assert_true(loop.tick);
	assert_true(clock_now_ns() - start >= 99 * NS_PER_S / 100);
	assert_false(loop.stop);
	assert_int_equal(raise(SIGHUP), 0);
	assert_int_equal(loop_wait(&loop, &fault), 0);
	assert_true(loop.reload); /* the terminal is still there */
	assert_false(loop.stop);
	assert_int_equal(raise(SIGTERM), 0);
	assert_int_equal(loop_wait(&loop, &fault), 0);
	assert_true(loop.stop);
	loop_close(&loop);
}

/* Runs in a session of its own, with a terminal of its own. */
static int hang_up(void)
{
	const struct rlimit none = {0, 0};
	const int master = posix_openpt(O_RDWR | O_NOCTTY);
	struct fault fault = {.text = ""};
	struct loop loop;

	alarm(60);
	(void)signal(SIGHUP, SIG_DFL);
	if (setsid() < 0 || master < 0 || grantpt(master) || unlockpt(master) ||
	    open(ptsname(master), O_RDWR) < 0 || loop_open(&loop, &fault))
		return 1;
	if (setrlimit(RLIMIT_NOFILE, &none) || raise(SIGHUP) || loop_wait(&loop, &fault) ||
	    !loop.reload || loop.stop)
		return 2;
	close(master);
	if (loop_wait(&loop, &fault) || loop.reload || !loop.stop)
		return 3;
	return 0;
}

/* A reload while no descriptor is free is not a hang-up. */
TEST("only a terminal that goes ends it")
{
	const pid_t child = fork();
	int status;

	if (!child)
		_exit(hang_up());
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
}

/* ---- statistics ---- */

TEST("lines say what was counted")
{
	char path[] = "/tmp/test_app_stats_XXXXXX", text[2000] = "";
	int file = mkstemp(path);
	struct pipeline_report report = {.clipped = 0.25,
					 .exposures = 1,
					 .threshold = {.value = 33.5},
					 .lights = 406,
					 .lights_used = 32,
					 .dropped_error = 0.003};
	struct source source = {.settings = {.name = "sky"},
				.counts.superseded = 2,
				.counts.undecodable = 1,
				.counts.losses = 3,
				.settling = {.opening = 1, .left_out = 9},
				.camera = {.frames = 10, .lost = 3, .broken = 4}};
	struct stats stats;
	FILE *stream;

	assert_true(file >= 0);
	assert_int_equal(stats_open(&stats, path, NULL), 0);
	stats_start(&stats, 5 * NS_PER_S);
	for (int i = 1; i <= 3; i++) {
		const int64_t stage[STAGE_COUNT] = {i * NS_PER_MS, 2 * NS_PER_MS, 0, 7 * NS_PER_MS,
						    0};
		const int64_t look[PIPELINE_LOOKS] = {i * 20000, 0, NS_PER_MS, 400};

		stats_made(&stats, i * NS_PER_S, stage, look);
		stats_shown(&stats, i * NS_PER_S, i * NS_PER_S + i * 10 * NS_PER_MS,
			    15 * NS_PER_MS);
	}
	stats_made(&stats, 0,
		   (const int64_t[STAGE_COUNT]){2 * NS_PER_MS, 2 * NS_PER_MS, 0, 7 * NS_PER_MS},
		   (const int64_t[PIPELINE_LOOKS]){0});
	stats_shown(&stats, 0, 999 * NS_PER_S, 1); /* without a new frame there is no latency */
	stats_line(&stats, 5 * NS_PER_S + 2 * NS_PER_S, &report, &source, 1);
	source.opening.situation = CAMERA_STALLED;
	report.lamp = (struct coarse_lamp){
		.there = true, .share = 0.31, .azimuth_deg = 134, .height_deg = 22.5};
	report.told = (struct lamps_told){
		.unnamed = true, .share = 0.3, .azimuth_deg = 134, .height_deg = 22.5};
	report.missing_lamp[0] = "desk";
	report.missing_lamp[1] = "door";
	report.people = (struct pipeline_people_seen){.on = true,
						      .learned = 0.98,
						      .parts = 2,
						      .in_front = 1,
						      .sure = 0.4,
						      .moved_px = {10, -0.5},
						      .lost = true};
	stats_line(&stats, 5 * NS_PER_S + 3 * NS_PER_S, &report, &source, 1);
	stats_close(&stats);
	stats_close(&stats);
	stream = fdopen(file, "r");
	assert_non_null(stream);
	assert_true(fread(text, 1, sizeof(text) - 1, stream) > 0);
	fclose(stream);
	unlink(path);
	assert_string_equal(
		text,
		"{\"t\":2.000,\"frames\":4,\"fps\":2.00,\"drops\":5,"
		"\"latency_ms\":{\"mean\":20.000,\"max\":30.000},\"late\":1,"
		"\"stage_ms\":{\"decode\":2.000,\"sample\":2.000,\"people\":0.000,"
		"\"composite\":7.000,\"show\":0.000},"
		"\"look_ms\":{\"exposure\":0.0300,\"flicker\":0.0000,"
		"\"noise\":0.7500,\"neutral\":0.0003},"
		"\"lights_used\":32,\"lights\":406,\"threshold\":33.5,"
		"\"threshold_unit\":\"grey level\",\"dropped_error\":0.003,"
		"\"clipped\":0.250000,\"recovered\":\"no\",\"exposures\":1,\"unfit\":0,"
		"\"lines_lost\":0,\"coarse_lamp\":null,\"lamps_missing\":[],\"lamp_unnamed\":null,\"people\":null,\"cameras\":"
		"[{\"name\":\"sky\",\"situation\":\"fine\","
		"\"frames\":10,\"lost\":5,\"broken\":5,\"losses\":3,\"settling\":true,"
		"\"unsettled\":9}]}\n"
		"{\"t\":3.000,\"frames\":4,\"fps\":0.00,\"drops\":5,"
		"\"latency_ms\":{\"mean\":0.000,\"max\":0.000},\"late\":0,"
		"\"stage_ms\":{\"decode\":0.000,\"sample\":0.000,\"people\":0.000,"
		"\"composite\":0.000,\"show\":0.000},"
		"\"look_ms\":{\"exposure\":0.0000,\"flicker\":0.0000,"
		"\"noise\":0.0000,\"neutral\":0.0000},"
		"\"lights_used\":32,\"lights\":406,\"threshold\":33.5,"
		"\"threshold_unit\":\"grey level\",\"dropped_error\":0.003,"
		"\"clipped\":0.250000,\"recovered\":\"no\",\"exposures\":1,\"unfit\":0,"
		"\"lines_lost\":0,"
		"\"coarse_lamp\":{\"azimuth\":134.0,\"height\":22.5,\"share\":0.310},"
		"\"lamps_missing\":[\"desk\",\"door\"],"
		"\"lamp_unnamed\":{\"azimuth\":134.0,\"height\":22.5,\"share\":0.300,\"off\":0.100},"
		"\"people\":{\"learned\":0.980,\"parts\":2,\"in_front\":1,\"sure\":0.40,"
		"\"moved\":[10.0,-0.5],\"lost\":true},\"cameras\":"
		"[{\"name\":\"sky\",\"situation\":\"stalled\",\"frames\":10,\"lost\":5,\"broken\":5,\"losses\":3,\"settling\":true,\"unsettled\":9}]}\n");
}

static void line(struct stats *stats, int second)
{
	static const struct pipeline_report report = {.clipped = 0};

	stats_line(stats, second * NS_PER_S, &report, NULL, 0);
}

static int open_stats(struct stats *stats, const char *path)
{
	struct fault fault;

	alarm(60); /* it must not wait */
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
	return stats_open(stats, path, &fault);
}

TEST("a full disk takes lines only")
{
	struct stats stats;

	if (access("/dev/full", W_OK))
		skip();
	assert_int_equal(open_stats(&stats, "/dev/full"), 0);
	stats_start(&stats, 0);
	line(&stats, 1);
	line(&stats, 2);
	assert_int_equal(stats.lines_lost, 2);
	stats_close(&stats);
}

/* Number of whole lines; the first must say that `lost` lines were lost before it. */
static int count_lines(int file, int lost)
{
	static char text[1 << 17];
	const ssize_t bytes = read(file, text, sizeof(text) - 1);
	char said[40], *rest = NULL;
	int lines = 0;

	assert_true(bytes >= 0 && bytes < (ssize_t)sizeof(text) - 1);
	assert_true(!bytes || text[bytes - 1] == '\n');
	text[bytes] = '\0';
	snprintf(said, sizeof(said), "\"lines_lost\":%d,", lost);
	for (char *at = strtok_r(text, "\n", &rest); at; at = strtok_r(NULL, "\n", &rest)) {
		assert_int_equal(strncmp(at, "{\"t\":", 5), 0);
		assert_string_equal(at + strlen(at) - 2, "]}");
		assert_true(lines++ || strstr(at, said));
	}
	return lines;
}

TEST("a pipe is not waited for")
{
	const char *path = own_folder_path("pipe");
	struct stats stats;
	int reader, lines;

	assert_int_equal(mkfifo(path, 0600), 0);
	assert_int_equal(open_stats(&stats, path), 0);
	stats_start(&stats, 0);
	line(&stats, 1);
	reader = open(path, O_RDONLY | O_NONBLOCK);
	line(&stats, 2);
	assert_int_equal(count_lines(reader, 1), 1);
	for (int k = 0; k < 1000; k++) /* more than the pipe holds: 64 KiB */
		line(&stats, 3);
	assert_true(stats.lines_lost > 100 && stats.lines_lost < 999);
	lines = count_lines(reader, 1);
	assert_int_equal(lines + stats.lines_lost, 1001);
	line(&stats, 4);
	assert_int_equal(count_lines(reader, 1001 - lines), 1);
	close(reader);
	line(&stats, 5);
	assert_int_equal(stats.lines_lost, 1002 - lines);
	reader = open(path, O_RDONLY | O_NONBLOCK);
	line(&stats, 6);
	assert_int_equal(count_lines(reader, 1002 - lines), 1);
	close(reader);
	stats_close(&stats);
	unlink(path);
}

TEST("files are cut short and moved away")
{
	char path[PATH_MAX], old[PATH_MAX];
	struct stats stats;
	int reader;

	snprintf(path, sizeof(path), "%s", own_folder_path("stats"));
	snprintf(old, sizeof(old), "%s", own_folder_path("stats.1"));
	assert_int_equal(open_stats(&stats, path), 0);
	stats_start(&stats, 0);
	line(&stats, 1);
	assert_int_equal(truncate(path, 0), 0);
	line(&stats, 2);
	assert_int_equal(rename(path, old), 0);
	line(&stats, 3);
	stats_reopen(&stats);
	line(&stats, 4);
	stats_reopen(&stats); /* reopening keeps the contents */
	line(&stats, 5);
	stats_close(&stats);
	for (int k = 0; k < 2; k++) {
		reader = open(k ? path : old, O_RDONLY);
		assert_int_equal(count_lines(reader, 0), 2);
		close(reader);
		unlink(k ? path : old);
	}
}

TEST("a file as large as it may be has whole lines")
{
	const char *path = own_folder_path("stats");
	const struct rlimit small = {1000, RLIM_INFINITY};
	struct rlimit before;
	struct stats stats;
	int reader;

	assert_int_equal(mknod(path, S_IFREG | 0600, 0), 0);
	assert_int_equal(truncate(path, 100), 0); /* a file of another run */
	assert_int_equal(open_stats(&stats, path), 0);
	stats_start(&stats, 0);
	getrlimit(RLIMIT_FSIZE, &before);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
	for (int k = 0; k < 6; k++)
		line(&stats, k);
	setrlimit(RLIMIT_FSIZE, &before);
	reader = open(path, O_RDONLY);
	assert_int_equal(count_lines(reader, 0) + stats.lines_lost, 6);
	assert_true(stats.lines_lost > 0 && stats.lines_lost < 6);
	close(reader);
	stats_close(&stats);
	unlink(path);
}

TEST_GROUP(own_folder_make, own_folder_remove);
