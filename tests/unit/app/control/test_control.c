/* SPDX-License-Identifier: MIT */
/* The control socket: the commands, and that no client can harm the kiosk or other clients.
 * tests/vm/test_control.sh adds other users. */
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <unistd.h>

#include "app/control/control.h"
#include "app/control/control_socket.h"
#include "hal/base/clock.h"
#include "tests/support/test.h"

static char folder[] = "/tmp/inlay-control-XXXXXX";
static char path[64];

TEST("lines")
{
	static const struct {
		const char *line;
		enum control_request_kind kind;
		enum action action;
		double value;
		const char *words; /* words of the fault */
	} cases[] = {
		{"status", CONTROL_STATUS, ACTION_NONE, 0, NULL},
		{"snapshot", CONTROL_SNAPSHOT, ACTION_NONE, 0, NULL},
		{"snapshot x.png", CONTROL_NOTHING, 0, 0, "unknown action \"snapshot\""},
		{"view-next", CONTROL_ACTION, ACTION_VIEW_NEXT, 0, NULL},
		{"  quit\t\r", CONTROL_ACTION, ACTION_QUIT, 0, NULL},
		{"threshold-set 40", CONTROL_ACTION, ACTION_THRESHOLD_SET, 40, NULL},
		{"threshold-set\t0.5 ", CONTROL_ACTION, ACTION_THRESHOLD_SET, 0.5, NULL},
		{"threshold-set", CONTROL_NOTHING, 0, 0, "needs a level"},
		{"threshold-set 256", CONTROL_NOTHING, 0, 0, "expected one number 0..255"},
		{"threshold-set nan", CONTROL_NOTHING, 0, 0, "expected one number 0..255"},
		{"threshold-set 4 0", CONTROL_NOTHING, 0, 0, "at most one value"},
		{"view-next 3", CONTROL_NOTHING, 0, 0, "view-next takes no value, found \"3\""},
		{"status now", CONTROL_NOTHING, 0, 0, "unknown action \"status\""},
		{"veiw-next", CONTROL_NOTHING, 0, 0, "did you mean \"view-next\"?"},
		{"none", CONTROL_NOTHING, 0, 0, "unknown action \"none\""},
		{"zzzzzzzzzzzz", CONTROL_NOTHING, 0, 0, "expected one like view-next"},
		{"", CONTROL_NOTHING, 0, 0, "there is no command"},
		{" \t ", CONTROL_NOTHING, 0, 0, "there is no command"},
		{"quit\x1b[2J", CONTROL_NOTHING, 0, 0, "this is no text"},
		{"qu\xc3\xafit", CONTROL_NOTHING, 0, 0, "this is no text"},
	};
	struct control_request request;
	struct fault fault;

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		const int err = control_parse(cases[i].line, strlen(cases[i].line), &request,
					      &fault);

		assert_int_equal(err, cases[i].words ? -EINVAL : 0);
		assert_int_equal(request.kind, cases[i].kind);
		if (err && !strstr(fault.text, cases[i].words))
			fail_msg("%s (expected %s)", fault.text, cases[i].words);
		if (request.kind == CONTROL_ACTION) {
			assert_int_equal(request.press.action, cases[i].action);
			assert_true(request.press.value == cases[i].value);
		}
	}
	assert_int_equal(control_parse("quit\0quit", 9, &request, &fault), -EINVAL);
}

static struct control *open_control(const char *group)
{
	struct control *control;
	struct fault fault;

	if (control_open(&control, path, group, &fault))
		fail_msg("%s", fault.text);
	return control;
}

static int connect_client(void)
{
	const int fd = control_socket_connect(path);

	assert_true(fd >= 0);
	return fd;
}

static void send_text(int fd, const char *text)
{
	assert_int_equal(send(fd, text, strlen(text), MSG_NOSIGNAL), strlen(text));
}

static bool is_waiting(const struct control *control)
{
	struct pollfd p = {.fd = control_descriptor(control), .events = POLLIN};

	return poll(&p, 1, 0) == 1;
}

/* Answers all waiting requests as the kiosk does; a status request gets the given line. Returns the
 * number of requests. */
static int serve(struct control *control, const char *status)
{
	struct control_request request;
	int count = 0;

	while (is_waiting(control)) {
		int turn = 0;

		for (;; turn++) {
			control_next(control, &request);
			if (request.kind == CONTROL_NOTHING)
				break;
			if (request.kind == CONTROL_SNAPSHOT) {
				control_postpone(control);
				continue;
			}
			control_answer(control, request.kind == CONTROL_STATUS
							? status
							: action_names[request.press.action]);
		}
		assert_true(turn <= 16); /* a flood of requests leaves time for other work */
		count += turn;
	}
	return count;
}

/* All replies so far, with "EOF" at the end when the other side has closed. */
static const char *replies(int fd)
{
	static char text[8192];
	size_t length = 0;
	ssize_t bytes;

	while (length < sizeof(text) - 4 &&
	       (bytes = recv(fd, text + length, sizeof(text) - 4 - length, MSG_DONTWAIT)) > 0)
		length += (size_t)bytes;
	strcpy(text + length, bytes == 0 || (bytes < 0 && errno == ECONNRESET) ? "EOF" : "");
	return text;
}

TEST("one after the other")
{
	struct control *control = open_control("");
	const int one = connect_client(), other = connect_client();

	assert_int_equal(serve(control, ""), 0);
	assert_false(is_waiting(control));
	send_text(one, "view-next\nstatus\nfoo\nthreshold-set 12\n");
	assert_int_equal(serve(control, "{}"), 3);
	assert_string_equal(replies(one),
			    "view-next\n{}\n"
			    "error: unknown action \"foo\", expected one like view-next\n"
			    "threshold-set\n");
	send_text(one, "pose-");
	send_text(other, "object\n");
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(other), "object\n");
	assert_string_equal(replies(one), "");
	send_text(one, "next\n");
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(one), "pose-next\n");
	/* Half a line of a client that has gone is no command. */
	send_text(other, "quit");
	close(other);
	assert_int_equal(serve(control, ""), 0);
	control_close(control);
	assert_string_equal(replies(one), "EOF");
	close(one);
	assert_int_equal(access(path, F_OK), -1);
}

/* A client that goes between its command and the answer. */
TEST("gone before the answer")
{
	struct control *control = open_control("");
	struct control_request request;
	const int one = connect_client();

	send_text(one, "freeze\n");
	do
		control_next(control, &request);
	while (request.kind == CONTROL_NOTHING);
	assert_int_equal(request.press.action, ACTION_FREEZE);
	close(one);
	control_answer(control, "ok");
	control_answer(control, "ok"); /* without a request */
	assert_int_equal(serve(control, ""), 0);
	control_close(control);
	control_close(NULL);
}

/* Reads a line and so many bytes of value after it, as far as they come. Returns how many bytes
 * came. */
static size_t take_picture(struct control *control, int fd, const char *line, int value,
			   size_t most)
{
	static char bytes[1 << 16];
	size_t got = 0, skip = strlen(line);
	ssize_t n;

	while (got < skip + most) {
		const size_t left = (got < skip ? skip : skip + most) - got;

		serve(control, "");
		n = recv(fd, bytes, left < sizeof(bytes) ? left : sizeof(bytes), MSG_DONTWAIT);
		if (n <= 0)
			break;
		for (ssize_t k = 0; k < n; k++, got++)
			assert_int_equal(bytes[k], got < skip ? line[got] : value);
	}
	return got < skip ? 0 : got - skip;
}

static struct snapshot *picture_of(int width, int height, int value)
{
	struct snapshot *s;

	assert_int_equal(snapshot_create(&s, width, height, NULL), 0);
	memset(s->pixels, value, s->stride * (size_t)height);
	return s;
}

/* The kiosk's part of an answer. */
static void answer_with(struct control *control, struct snapshot *s)
{
	char line[SNAPSHOT_LINE_MAX];

	snapshot_finish(s, line);
	control_answer_waiting(control, line, s);
	snapshot_release(s);
}

/* Clients that wait for a picture: others are answered meanwhile, and what a client asks for while
 * it waits or reads is done afterwards. */
TEST("answers that wait")
{
	struct control *control = open_control("");
	const int one = connect_client(), two = connect_client(), other = connect_client();
	const size_t bytes = 4 * 641 * 480;

	assert_false(control_has_waiting(control));
	assert_true(control_look(control, 0) == INT64_MAX);
	send_text(one, "snapshot\n");
	send_text(other, "object\n");
	assert_int_equal(serve(control, ""), 2);
	assert_true(control_has_waiting(control));
	assert_true(control_look(control, 0) < INT64_MAX);
	assert_string_equal(replies(other), "object\n");
	send_text(two, "snapshot\n");
	send_text(one, "view-next\nsnapshot\n");
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(one), "");
	answer_with(control, picture_of(641, 480, 7));
	assert_false(control_has_waiting(control));
	assert_int_equal(take_picture(control, one, "snapshot 641 480\n", 7, bytes), bytes);
	serve(control, "");
	assert_string_equal(replies(one), "view-next\n");
	assert_true(control_has_waiting(control));
	assert_int_equal(take_picture(control, two, "snapshot 641 480\n", 7, bytes), bytes);
	control_answer_waiting(control, "error: no", NULL);
	assert_string_equal(replies(one), "error: no\n");
	/* one that goes while it waits, and one whose kiosk ends */
	send_text(one, "snapshot\n");
	send_text(two, "snapshot\n");
	serve(control, "");
	close(one);
	serve(control, "");
	control_close(control);
	assert_string_equal(replies(two), "error: the kiosk ends, or takes another socket\nEOF");
	close(two);
	close(other);
}

/* A client that asks without end and takes nothing: the kiosk holds one picture of it, and lets it
 * go. */
TEST("pictures that nobody takes")
{
	struct control *control = open_control("");
	const int64_t late_ns = clock_now_ns() + 3600 * NS_PER_S;
	int client[3];

	for (int k = 0; k < 3; k++)
		client[k] = connect_client();
	for (int k = 0; k < 2; k++) {
		assert_false(control_is_full(control));
		for (int n = 0; n < 10; n++)
			send_text(client[k], "snapshot\n");
		assert_int_equal(serve(control, ""), 1);
		answer_with(control, picture_of(1000, 1000, k));
		serve(control, "");
		assert_false(control_has_waiting(control));
	}
	assert_true(control_is_full(control));
	control_look(control, late_ns);
	assert_false(control_is_full(control));
	/* two that wait for the same picture hold it once */
	for (int k = 0; k < 2; k++) {
		close(client[k]);
		client[k] = connect_client();
		send_text(client[k], "snapshot\n");
	}
	assert_int_equal(serve(control, ""), 2);
	answer_with(control, picture_of(1000, 1000, 9));
	assert_false(control_is_full(control));
	for (int k = 0; k < 3; k++)
		close(client[k]);
	serve(control, "");
	control_close(control);
}

TEST("line without end")
{
	struct control *control = open_control("");
	const int one = connect_client(), other = connect_client();
	char text[CONTROL_LINE_MAX + 1];

	memset(text, ' ', sizeof(text));
	memcpy(text, "quit", 4);
	text[CONTROL_LINE_MAX - 1] = '\n';
	text[CONTROL_LINE_MAX] = '\0';
	send_text(one, text);
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(one), "quit\n");
	text[CONTROL_LINE_MAX - 1] = ' ';
	send_text(one, text);
	send_text(other, "object\n");
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(one),
			    "error: the line is too long, expected at most 255 bytes\nEOF");
	assert_string_equal(replies(other), "object\n");
	close(one);
	close(other);
	control_close(control);
}

TEST("flood")
{
	struct control *control = open_control("");
	const int one = connect_client(), other = connect_client();
	const char *end;

	for (int i = 0; i <= CONTROL_RATE_MAX; i++) {
		send_text(one, "object\n");
		if (i % 100 == 0 && i < CONTROL_RATE_MAX) {
			serve(control, "");
			(void)replies(one);
		}
	}
	send_text(other, "object\n");
	serve(control, "");
	end = strstr(replies(one), "error: too many");
	assert_non_null(end);
	assert_string_equal(end, "error: too many commands in a second\nEOF");
	assert_string_equal(replies(other), "object\n");
	close(one);
	close(other);
	control_close(control);
}

TEST("deaf client")
{
	struct control *control = open_control("");
	const int one = connect_client(), other = connect_client();
	static char status[4096];
	int sent = 0;

	memset(status, 'x', sizeof(status) - 1);
	while (sent < CONTROL_RATE_MAX && send(one, "status\n", 7, MSG_NOSIGNAL) == 7) {
		serve(control, status);
		sent++;
	}
	assert_in_range(sent, 2, CONTROL_RATE_MAX - 1);
	send_text(other, "object\n");
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(other), "object\n");
	close(one);
	close(other);
	control_close(control);
}

TEST("one client more")
{
	struct control *control = open_control("");
	int clients[CONTROL_CLIENTS_MAX + 1];

	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++) {
		clients[i] = connect_client();
		serve(control, "");
	}
	send_text(clients[0], "object\n"); /* so that the next client has been silent longest */
	serve(control, "");
	clients[CONTROL_CLIENTS_MAX] = connect_client();
	send_text(clients[CONTROL_CLIENTS_MAX], "freeze\n");
	assert_int_equal(serve(control, ""), 1);
	assert_string_equal(replies(clients[CONTROL_CLIENTS_MAX]), "freeze\n");
	assert_string_equal(replies(clients[1]),
			    "error: another needs the place of this client\nEOF");
	assert_string_equal(replies(clients[0]), "object\n");
	for (int i = 0; i <= CONTROL_CLIENTS_MAX; i++)
		close(clients[i]);
	serve(control, "");
	control_close(control);
}

TEST("out of descriptors")
{
	struct control *control = open_control("");
	const int one = connect_client(), other = connect_client();
	const int free_one = dup(0);
	struct rlimit limit, none;

	assert_true(free_one >= 0);
	close(free_one);
	assert_int_equal(getrlimit(RLIMIT_NOFILE, &limit), 0);
	none = limit;
	none.rlim_cur = (rlim_t)free_one; /* all lower descriptors are in use */
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
	serve(control, ""); /* ends: no client waits for ever */
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &limit), 0);
	assert_string_equal(replies(one), "EOF");
	assert_string_equal(replies(other), "EOF");
	close(one);
	close(other);
	const int later = connect_client();

	send_text(later, "object\n");
	assert_int_equal(serve(control, ""), 1);
	close(later);
	control_close(control);
}

static int refusal(const char *at, const char *group, const char *words)
{
	struct control *control;
	struct fault fault;
	const int err = control_open(&control, at, group, &fault);

	assert_true(err < 0);
	assert_null(control);
	if (!strstr(fault.text, words))
		fail_msg("%s (expected %s)", fault.text, words);
	return err;
}

TEST("place")
{
	const struct group *own = getgrgid(getegid());
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	struct control *control;
	struct stat file;
	char long_path[200];
	int dead, plain;

	control = open_control("");
	assert_int_equal(stat(path, &file), 0);
	assert_int_equal(file.st_mode & 07777, 0600);
	assert_int_equal(refusal(path, "", "another kiosk listens"), -EADDRINUSE);
	/* The other kiosk has only connected. */
	assert_int_equal(serve(control, ""), 0);
	/* Another file of that name is not the kiosk's, and stays. */
	assert_int_equal(unlink(path), 0);
	plain = open(path, O_CREAT | O_WRONLY, 0600);
	assert_true(plain >= 0);
	close(plain);
	control_close(control);
	assert_int_equal(refusal(path, "", "is there and no socket"), -EEXIST);
	assert_int_equal(unlink(path), 0);

	dead = socket(AF_UNIX, SOCK_STREAM, 0);
	strcpy(address.sun_path, path);
	assert_int_equal(bind(dead, (struct sockaddr *)&address, sizeof(address)), 0);
	close(dead);
	assert_non_null(own);
	control = open_control(own->gr_name);
	assert_int_equal(stat(path, &file), 0);
	assert_int_equal(file.st_mode & 07777, 0660);
	assert_int_equal(file.st_gid, own->gr_gid);
	control_close(control);
	assert_int_equal(access(path, F_OK), -1);

	assert_int_equal(refusal(path, "no-such-group", "expected a group"), -EINVAL);
	memset(long_path, 'x', sizeof(long_path) - 1);
	long_path[0] = '/';
	long_path[sizeof(long_path) - 1] = '\0';
	assert_int_equal(refusal(long_path, "", "too long"), -ENAMETOOLONG);
	assert_int_equal(refusal("/nowhere/at/all", "", "folder of"), -ENOENT);
}

/* Whoever can read the folder can lock it. That must not keep a kiosk from starting. */
TEST("locks")
{
	const int reader = open(folder, O_RDONLY | O_DIRECTORY);
	struct control *control;
	char lock[sizeof(path) + 8];
	struct stat file;
	int other;

	assert_int_equal(flock(reader, LOCK_EX | LOCK_NB), 0);
	control = open_control("");
	control_close(control);
	close(reader);
	/* The lock of a running kiosk does. */
	snprintf(lock, sizeof(lock), "%s.lock", path);
	other = open(lock, O_RDWR | O_CREAT, 0644);
	assert_int_equal(flock(other, LOCK_EX | LOCK_NB), 0);
	assert_int_equal(refusal(path, "", "another kiosk is opening"), -EADDRINUSE);
	assert_int_equal(stat(lock, &file), 0); /* the socket belongs to the other kiosk */
	/* Files of a kiosk that has ended in the meantime are no obstacle. */
	close(other);
	control = open_control("");
	control_close(control);
}

static int make_folder(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/socket", folder);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	return rmdir(folder); /* works, because the folder is empty */
}

TEST_GROUP(make_folder, remove_folder);
