/* SPDX-License-Identifier: MIT */
#include "app/control/control.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include "app/control/control_socket.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

#define LISTENER CONTROL_CLIENTS_MAX /* its number in epoll's data, after those of the clients */
#define STEPS_AT_ONCE 16
#define GROUPS_MAX 1024

struct client {
	int fd;			     /* -1: free */
	char line[CONTROL_LINE_MAX]; /* the part of a line that has come so far */
	size_t length;
	int64_t heard_ns;
	int64_t second_ns;	  /* when the counted second began */
	int lines;		  /* counted in that second */
	bool waiting;		  /* for control_answer_waiting() */
	struct snapshot *picture; /* that it is being sent; NULL: none */
	size_t sent;		  /* bytes of it */
	int64_t moved_ns;	  /* when it began to wait, or last took some of its picture */
};

struct control {
	struct control_socket socket;
	int epoll;
	int spare; /* a descriptor in reserve, see turn_away() */
	gid_t group;
	bool has_group;
	struct client clients[CONTROL_CLIENTS_MAX];
	struct client *asking; /* whose request has not been answered; NULL: none */
	int steps;	       /* events handled since CONTROL_NOTHING */
};

int control_parse(const char *line, size_t length, struct control_request *request,
		  struct fault *fault)
{
	char text[CONTROL_LINE_MAX];
	char *words[3] = {NULL}, *rest = NULL;
	int count = 0;

	*request = (struct control_request){.kind = CONTROL_NOTHING};
	if (length && line[length - 1] == '\r')
		length--;
	if (length >= sizeof(text))
		return fault_say(fault, -EINVAL, "the line is too long, expected at most %zu bytes",
				 sizeof(text) - 1);
	for (size_t i = 0; i < length; i++)
		if ((line[i] < ' ' || line[i] > '~') && line[i] != '\t')
			return fault_say(fault, -EINVAL, "this is no text, expected a command");
	memcpy(text, line, length);
	text[length] = '\0';
	for (char *word = strtok_r(text, " \t", &rest); word && count < 3;
	     word = strtok_r(NULL, " \t", &rest))
		words[count++] = word;
	if (!count)
		return fault_say(fault, -EINVAL,
				 "there is no command, expected one like view-next");
	if (count == 3)
		return fault_say(fault, -EINVAL, "expected one command and at most one value");
	if (!words[1] && (!strcmp(words[0], "status") || !strcmp(words[0], "snapshot"))) {
		request->kind = words[0][1] == 't' ? CONTROL_STATUS : CONTROL_SNAPSHOT;
		return 0;
	}
	if (button_press_parse(words[0], words[1], &request->press, fault))
		return -EINVAL;
	request->kind = CONTROL_ACTION;
	return 0;
}

/* ---- who may ---- */

/* Checks the groups besides the client's first one, as they were when it connected. */
static bool is_member(int fd, gid_t group)
{
	gid_t groups[GROUPS_MAX];
	socklen_t bytes = sizeof(groups);

	if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups, &bytes))
		return false;
	for (size_t i = 0; i < bytes / sizeof(*groups); i++)
		if (groups[i] == group)
			return true;
	return false;
}

static bool may_command(const struct control *control, int fd)
{
	struct ucred peer;
	socklen_t bytes = sizeof(peer);

	if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &bytes))
		return false;
	if (peer.uid == 0 || peer.uid == geteuid())
		return true;
	return control->has_group && (peer.gid == control->group || is_member(fd, control->group));
}

/* ---- clients ---- */

static void cut_off(struct control *control, struct client *client)
{
	if (control->asking == client)
		control->asking = NULL;
	close(client->fd); /* which also removes it from epoll */
	snapshot_release(client->picture);
	*client = (struct client){.fd = -1};
}

/* Sends a line. 0 or -errno. The kernel having no room for another reply means that the client does
 * not read them. */
static int client_say(int fd, const char *before, const char *line)
{
	const struct iovec parts[] = {
		{.iov_base = (void *)(uintptr_t)before, .iov_len = strlen(before)},
		{.iov_base = (void *)(uintptr_t)line, .iov_len = strlen(line)},
		{.iov_base = (void *)(uintptr_t) "\n", .iov_len = 1},
	};
	const struct msghdr message = {
		.msg_iov = (struct iovec *)(uintptr_t)parts,
		.msg_iovlen = 3,
	};
	const size_t bytes = parts[0].iov_len + parts[1].iov_len + 1;
	const ssize_t sent = sendmsg(fd, &message, MSG_NOSIGNAL | MSG_DONTWAIT);

	if (sent < 0)
		return -errno;
	return (size_t)sent == bytes ? 0 : -EAGAIN;
}

/* events 0: only that the client has gone. */
static void client_await(struct control *control, struct client *client, uint32_t events)
{
	struct epoll_event event = {.events = events,
				    .data.u32 = (uint32_t)(client - control->clients)};

	client->moved_ns = clock_now_ns();
	if (epoll_ctl(control->epoll, EPOLL_CTL_MOD, client->fd, &event))
		cut_off(control, client);
}

/* Sends as much of its picture as the kernel has room for. */
static void client_send_more(struct control *control, struct client *client)
{
	const size_t left = snapshot_bytes(client->picture) - client->sent;
	const ssize_t sent = send(client->fd, client->picture->pixels + client->sent, left,
				  MSG_NOSIGNAL | MSG_DONTWAIT);

	if (sent < 0 && errno != EAGAIN && errno != EINTR) {
		cut_off(control, client);
		return;
	}
	if (sent <= 0)
		return;
	client->sent += (size_t)sent;
	client->moved_ns = clock_now_ns();
	if ((size_t)sent < left)
		return;
	snapshot_release(client->picture);
	client->picture = NULL;
	client_await(control, client, EPOLLIN);
}

static void client_refuse(struct control *control, struct client *client, const char *why)
{
	(void)client_say(client->fd, "error: ", why);
	cut_off(control, client);
}

static struct client *find_place(struct control *control)
{
	struct client *silent = NULL;

	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++) {
		struct client *client = &control->clients[i];

		if (client->fd < 0)
			return client;
		if (!silent || client->heard_ns < silent->heard_ns)
			silent = client;
	}
	client_refuse(control, silent, "another needs the place of this client");
	return silent;
}

/* Closes a connection that cannot be accepted because descriptors have run out, with the help of
 * the one in reserve. Otherwise it would keep the listener readable for ever. */
static void turn_away(struct control *control)
{
	int fd;

	if (control->spare >= 0)
		close(control->spare);
	fd = accept4(control->socket.fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);
	if (fd >= 0)
		close(fd);
	control->spare = open("/dev/null", O_RDONLY | O_CLOEXEC);
}

static void take_client(struct control *control)
{
	struct epoll_event event = {.events = EPOLLIN};
	struct client *client;
	const int fd = accept4(control->socket.fd, NULL, NULL, SOCK_NONBLOCK | SOCK_CLOEXEC);

	if (fd < 0) {
		if (errno == EMFILE || errno == ENFILE)
			turn_away(control);
		return;
	}
	if (!may_command(control, fd)) {
		(void)client_say(
			fd, "error: ",
			"this user may not, expected root, the kiosk's own or a member of the group of [control]");
		close(fd);
		return;
	}
	client = find_place(control);
	event.data.u32 = (uint32_t)(client - control->clients);
	if (epoll_ctl(control->epoll, EPOLL_CTL_ADD, fd, &event)) {
		close(fd);
		return;
	}
	*client = (struct client){.fd = fd, .heard_ns = clock_now_ns()};
}

static bool is_too_fast(struct client *client)
{
	client->heard_ns = clock_now_ns();
	if (client->heard_ns - client->second_ns >= NS_PER_S) {
		client->second_ns = client->heard_ns;
		client->lines = 0;
	}
	return ++client->lines > CONTROL_RATE_MAX;
}

/*
 * Takes bytes up to the end of one line from the kernel, and no more: the rest stays there and
 * keeps the descriptor readable. 1: a line is complete, without its newline; 0: not yet; -errno:
 * the client is to be disconnected.
 */
static int client_take_line(struct client *client)
{
	char *end = client->line + client->length;
	const size_t room = sizeof(client->line) - client->length;
	ssize_t bytes = recv(client->fd, end, room, MSG_PEEK | MSG_DONTWAIT);
	const char *newline;

	if (bytes < 0)
		return errno == EAGAIN || errno == EINTR ? 0 : -errno;
	if (bytes == 0)
		return -EPIPE;
	newline = memchr(end, '\n', (size_t)bytes);
	if (newline)
		bytes = newline + 1 - end;
	bytes = recv(client->fd, end, (size_t)bytes, MSG_DONTWAIT);
	if (bytes <= 0)
		return -EPIPE;
	client->length += (size_t)bytes;
	if (!newline)
		return client->length < sizeof(client->line) ? 0 : -EMSGSIZE;
	client->length--;
	return 1;
}

static void client_hear(struct control *control, struct client *client,
			struct control_request *request)
{
	struct fault fault;
	const int whole = client_take_line(client);
	int err;

	if (whole == 0)
		return;
	if (whole == -EMSGSIZE)
		client_refuse(control, client, "the line is too long, expected at most 255 bytes");
	else if (whole < 0)
		cut_off(control, client);
	else if (is_too_fast(client))
		client_refuse(control, client, "too many commands in a second");
	if (client->fd < 0)
		return;
	err = control_parse(client->line, client->length, request, &fault);
	client->length = 0;
	if (!err)
		control->asking = client;
	else if (client_say(client->fd, "error: ", fault.text))
		cut_off(control, client);
}

void control_next(struct control *control, struct control_request *request)
{
	struct epoll_event ready;
	struct client *client;

	*request = (struct control_request){.kind = CONTROL_NOTHING};
	while (control->steps < STEPS_AT_ONCE && epoll_wait(control->epoll, &ready, 1, 0) == 1) {
		control->steps++;
		client = &control->clients[ready.data.u32 % CONTROL_CLIENTS_MAX];
		if (ready.data.u32 == LISTENER)
			take_client(control);
		else if (client->waiting) /* it has gone */
			cut_off(control, client);
		else if (client->picture)
			client_send_more(control, client);
		else
			client_hear(control, client, request);
		if (request->kind != CONTROL_NOTHING)
			return;
	}
	control->steps = 0;
}

void control_answer(struct control *control, const char *line)
{
	struct client *client = control->asking;

	control->asking = NULL;
	if (client && client_say(client->fd, "", line))
		cut_off(control, client);
}

void control_postpone(struct control *control)
{
	struct client *client = control->asking;

	control->asking = NULL;
	if (!client)
		return;
	client->waiting = true;
	client_await(control, client, 0);
}

bool control_has_waiting(const struct control *control)
{
	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++)
		if (control->clients[i].waiting)
			return true;
	return false;
}

void control_answer_waiting(struct control *control, const char *line, struct snapshot *snapshot)
{
	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++) {
		struct client *client = &control->clients[i];

		if (!client->waiting)
			continue;
		client->waiting = false;
		if (client_say(client->fd, "", line)) {
			cut_off(control, client);
			continue;
		}
		client->picture = snapshot;
		client->sent = 0;
		if (snapshot)
			snapshot->holders++;
		client_await(control, client, snapshot ? EPOLLOUT : EPOLLIN);
	}
}

int64_t control_look(struct control *control, int64_t now_ns)
{
	int64_t since_ns = INT64_MAX;

	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++) {
		struct client *client = &control->clients[i];

		if (client->waiting && client->moved_ns < since_ns)
			since_ns = client->moved_ns;
		if (client->picture &&
		    now_ns - client->moved_ns >= CONTROL_PICTURE_SECONDS * NS_PER_S)
			cut_off(control, client);
	}
	return since_ns;
}

bool control_is_full(const struct control *control)
{
	const struct snapshot *pictures[CONTROL_CLIENTS_MAX];
	int count = 0;

	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++) {
		const struct snapshot *picture = control->clients[i].picture;
		int k = 0;

		while (k < count && pictures[k] != picture)
			k++;
		if (picture && k == count)
			pictures[count++] = picture;
	}
	return count >= CONTROL_PICTURES_MAX;
}

int control_descriptor(const struct control *control)
{
	return control->epoll;
}

static int wait_for_clients(struct control *control)
{
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = LISTENER};

	control->spare = open("/dev/null", O_RDONLY | O_CLOEXEC);
	control->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (control->spare < 0 || control->epoll < 0 ||
	    epoll_ctl(control->epoll, EPOLL_CTL_ADD, control->socket.fd, &event))
		return -errno;
	return 0;
}

int control_open(struct control **out, const char *path, const char *group, struct fault *fault)
{
	struct control *control = calloc(1, sizeof(*control));
	int err;

	*out = NULL;
	if (!control)
		return fault_say(fault, -ENOMEM, "control: not enough memory");
	control->epoll = -1;
	control->spare = -1;
	control->socket.fd = -1;
	control->has_group = group[0];
	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++)
		control->clients[i].fd = -1;
	err = control_socket_group(group, &control->group, fault);
	if (!err)
		err = control_socket_open(&control->socket, path,
					  control->has_group ? &control->group : NULL, fault);
	if (err)
		goto close_control;
	err = wait_for_clients(control);
	if (err) {
		fault_say(fault, err, "control: cannot wait for clients: %s", strerror(-err));
		goto close_control;
	}
	*out = control;
	return 0;

close_control:
	control_close(control);
	return err;
}

void control_close(struct control *control)
{
	if (!control)
		return;
	control_answer_waiting(control, "error: the kiosk ends, or takes another socket", NULL);
	for (int i = 0; i < CONTROL_CLIENTS_MAX; i++)
		if (control->clients[i].fd >= 0)
			cut_off(control, &control->clients[i]);
	control_socket_close(&control->socket);
	if (control->epoll >= 0)
		close(control->epoll);
	if (control->spare >= 0)
		close(control->spare);
	free(control);
}
