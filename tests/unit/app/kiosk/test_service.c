/* SPDX-License-Identifier: MIT */
/* What the service manager is told; the test plays the manager. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "app/kiosk/service.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static int manager = -1;

static int test_service_begin(void **state)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};

	(void)state;
	snprintf(address.sun_path, sizeof(address.sun_path), "%.100s", own_folder_path("notify"));
	manager = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
	if (manager < 0 || bind(manager, (struct sockaddr *)&address, sizeof(address)))
		return -1;
	setenv("NOTIFY_SOCKET", address.sun_path, 1);
	setenv("WATCHDOG_USEC", "8000000", 1);
	unsetenv("WATCHDOG_PID");
	return 0;
}

static int test_service_end(void **state)
{
	(void)state;
	unsetenv("NOTIFY_SOCKET");
	unsetenv("WATCHDOG_USEC");
	close(manager);
	return unlink(own_folder_path("notify"));
}

/* The next message; empty: there is none. */
static const char *heard(void)
{
	static char text[512];
	ssize_t bytes = recv(manager, text, sizeof(text) - 1, 0);

	text[bytes > 0 ? bytes : 0] = '\0';
	return text;
}

TEST_BETWEEN("each thing is told once", test_service_begin, test_service_end)
{
	struct service service;

#if !WITH_SYSTEMD
	skip();
#endif
	service_start(&service);
	assert_string_equal(heard(), "");
	service_reloading(&service, 5); /* before it is ready nothing is sent */
	service_reloaded(&service);
	assert_string_equal(heard(), "");
	service_ready(&service);
	service_ready(&service);
	assert_string_equal(heard(), "READY=1");
	assert_string_equal(heard(), "");
	service_status(&service, "fine");
	service_status(&service, "fine");
	service_status(&service, "not so");
	assert_string_equal(heard(), "STATUS=fine");
	assert_string_equal(heard(), "STATUS=not so");
	assert_string_equal(heard(), "");
	service_reloading(&service, 7 * NS_PER_S);
	assert_string_equal(heard(), "RELOADING=1\nMONOTONIC_USEC=7000000");
	service_reloaded(&service);
	assert_string_equal(heard(), "READY=1");
	service_stopping(&service);
	assert_string_equal(heard(), "STOPPING=1");
}

TEST_BETWEEN("the watchdog is fed four times an interval", test_service_begin, test_service_end)
{
	struct service service;
	int fed = 0;

#if !WITH_SYSTEMD
	skip();
#endif
	service_start(&service);
	assert_true(service.watchdog_ns == 8 * NS_PER_S);
	for (int i = 0; i < 800; i++) {
		service_alive(&service, 100 * NS_PER_S + i * 10 * NS_PER_MS);
		if (*heard())
			fed++;
	}
	assert_int_equal(fed, 4);
}

TEST_BETWEEN("without a watchdog nothing is fed", test_service_begin, test_service_end)
{
	struct service service;

	unsetenv("WATCHDOG_USEC");
	service_start(&service);
	service_alive(&service, 100 * NS_PER_S);
	assert_string_equal(heard(), "");
}

/* The journal gets a level, everybody else the program's name. */
TEST("messages carry a level for the journal")
{
	char text[512] = "", name[64];
	int ends[2], before = dup(STDERR_FILENO);
	struct stat s;

	assert_int_equal(pipe(ends), 0);
	assert_true(dup2(ends[1], STDERR_FILENO) >= 0);
	assert_int_equal(fstat(STDERR_FILENO, &s), 0);
	snprintf(name, sizeof(name), "%llu:%llu", (unsigned long long)s.st_dev,
		 (unsigned long long)s.st_ino);
	setenv("JOURNAL_STREAM", name, 1);
	log_setup("inlay", LOG_LEVEL_INFO);
	log_error("a");
	log_warning("b");
	log_info("c");
	setenv("JOURNAL_STREAM", "1:1", 1); /* stderr is not the journal */
	log_setup("inlay", LOG_LEVEL_INFO);
	log_info("d");
	unsetenv("JOURNAL_STREAM");
	log_setup("inlay", LOG_LEVEL_INFO);
	log_info("e");
	dup2(before, STDERR_FILENO);
	assert_true(read(ends[0], text, sizeof(text) - 1) > 0);
	assert_string_equal(text, "<3>a\n<4>b\n<6>c\ninlay: d\ninlay: e\n");
	close(ends[0]);
	close(ends[1]);
	close(before);
}

TEST_GROUP(own_folder_make, own_folder_remove);
