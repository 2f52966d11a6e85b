/* SPDX-License-Identifier: MIT */
/* The tick makes up for hotplug messages that do not arrive. */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <linux/netlink.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"

#define TICK_NS (250 * NS_PER_MS)
#define SOON_NS (4 * NS_PER_MS)
#define KERNEL_GROUP 1	    /* multicast group of NETLINK_KOBJECT_UEVENT for the kernel's own */
#define MESSAGES_AT_ONCE 64 /* limit for one call; the rest wakes the loop again */

static int watch_set_timer(int timer, int64_t first_ns)
{
	const struct itimerspec when = {
		.it_interval.tv_nsec = TICK_NS,
		.it_value.tv_nsec = first_ns,
	};

	return timerfd_settime(timer, 0, &when, NULL) ? -errno : 0;
}

/* Returns -1 where a sandbox forbids the socket; the tick then notices changes, a little later. */
static int open_netlink(void)
{
	const struct sockaddr_nl kernel = {.nl_family = AF_NETLINK, .nl_groups = KERNEL_GROUP};
	int netlink = socket(AF_NETLINK, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK,
			     NETLINK_KOBJECT_UEVENT);

	if (netlink >= 0 && bind(netlink, (const struct sockaddr *)&kernel, sizeof(kernel))) {
		close(netlink);
		netlink = -1;
	}
	if (netlink < 0)
		log_debug("kms display: no hotplug messages: %s", strerror(errno));
	return netlink;
}

static int watch_add(const struct kms_watch *watch, int fd, unsigned ready)
{
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = ready};

	return fd >= 0 && epoll_ctl(watch->set, EPOLL_CTL_ADD, fd, &event) ? -errno : 0;
}

int kms_watch_open(struct kms_watch *watch, int card, int console, struct fault *fault)
{
	int err = 0;

	watch->set = epoll_create1(EPOLL_CLOEXEC);
	if (watch->set < 0) {
		err = -errno;
		return fault_say(fault, err, "kms display: epoll: %s", strerror(-err));
	}
	watch->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (watch->timer < 0) {
		err = -errno;
		return fault_say(fault, err, "kms display: no timer: %s", strerror(-err));
	}
	watch->netlink = open_netlink();
	err = watch_set_timer(watch->timer, TICK_NS);
	if (!err)
		err = watch_add(watch, card, KMS_READY_CARD);
	if (!err)
		err = watch_add(watch, watch->timer, KMS_READY_TICK);
	if (!err)
		err = watch_add(watch, watch->netlink, KMS_READY_HOTPLUG);
	if (!err)
		err = watch_add(watch, console, KMS_READY_CONSOLE);
	return err ? fault_say(fault, err, "kms display: cannot wait for it: %s", strerror(-err))
		   : 0;
}

bool kms_watch_concerns(const char *message, size_t length)
{
	static const char wanted[] = "SUBSYSTEM=drm";

	for (size_t at = 0; at < length;) {
		const size_t text = strnlen(message + at, length - at);

		if (text == sizeof(wanted) - 1 && !memcmp(message + at, wanted, text))
			return true;
		at += text + 1;
	}
	return false;
}

/* Whether any message was about screens. Messages that were lost (ENOBUFS) count as such. */
static bool take_messages(int netlink)
{
	bool concerns = false;

	for (int i = 0; i < MESSAGES_AT_ONCE; i++) {
		char message[4096];
		struct sockaddr_nl from = {0};
		socklen_t length = sizeof(from);
		const ssize_t got = recvfrom(netlink, message, sizeof(message), 0,
					     (struct sockaddr *)&from, &length);

		if (got < 0 && errno == ENOBUFS)
			concerns = true;
		else if (got < 0)
			break;
		else if (from.nl_pid == 0) /* sent by the kernel; any process may send too */
			concerns |= kms_watch_concerns(message, (size_t)got);
	}
	return concerns;
}

unsigned kms_watch_take(struct kms_watch *watch)
{
	struct epoll_event events[4];
	const int count = epoll_wait(watch->set, events, 4, 0);
	unsigned ready = 0;
	uint64_t ticks;

	for (int i = 0; i < count; i++) {
		ready |= events[i].data.u32;
		if (events[i].data.u32 == KMS_READY_CARD &&
		    events[i].events & (EPOLLERR | EPOLLHUP))
			ready |= KMS_READY_GONE;
	}
	if (ready & KMS_READY_TICK && read(watch->timer, &ticks, sizeof(ticks)) < 0)
		ready &= ~(unsigned)KMS_READY_TICK;
	if (ready & KMS_READY_HOTPLUG && !take_messages(watch->netlink))
		ready &= ~(unsigned)KMS_READY_HOTPLUG;
	return ready;
}

void kms_watch_soon(struct kms_watch *watch)
{
	watch_set_timer(watch->timer, SOON_NS);
}

void kms_watch_close(struct kms_watch *watch)
{
	const int fds[] = {watch->netlink, watch->timer, watch->set};

	for (int i = 0; i < 3; i++)
		if (fds[i] >= 0)
			close(fds[i]);
	*watch = (struct kms_watch){-1, -1, -1};
}
