/* SPDX-License-Identifier: MIT */
/* A picture that goes from the kiosk to a client: whole, and sealed against both. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "app/control/snapshot.h"

static void draw(struct snapshot *s, int width, int height)
{
	struct fault fault;

	assert_int_equal(snapshot_create(s, width, height, &fault), 0);
	assert_true(s->stride >= 4 * (size_t)width);
	for (int y = 0; y < height; y++)
		memset(s->pixels + (size_t)y * s->stride, y + 1, 4 * (size_t)width);
}

static void whole_and_sealed(void **state)
{
	static const int size[][2] = {{1, 1}, {641, 3}, {48, 32}};
	char line[SNAPSHOT_LINE_MAX];
	struct snapshot kiosk, client;
	struct fault fault;

	(void)state;
	for (int k = 0; k < 3; k++) {
		const int width = size[k][0], height = size[k][1];

		draw(&kiosk, width, height);
		assert_int_equal(snapshot_seal(&kiosk, line, &fault), 0);
		assert_null(kiosk.pixels);
		assert_int_equal(snapshot_open(&client, dup(kiosk.fd), line, &fault), 0);
		snapshot_close(&kiosk);
		snapshot_close(&kiosk);
		assert_int_equal(client.width, width);
		assert_int_equal(client.height, height);
		for (int y = 0; y < height; y++)
			for (int x = 0; x < 4 * width; x++)
				assert_int_equal(
					client.pixels[(size_t)y * client.stride + (size_t)x],
					y + 1);
		/* nobody can change it any more */
		assert_int_equal(ftruncate(client.fd, 0), -1);
		assert_int_equal(write(client.fd, "x", 1), -1);
		assert_true(mmap(NULL, 1, PROT_READ | PROT_WRITE, MAP_SHARED, client.fd, 0) ==
			    MAP_FAILED);
		snapshot_close(&client);
	}
}

static void refused(int fd, const char *line, const char *words)
{
	struct snapshot client;
	struct fault fault;

	assert_int_equal(snapshot_open(&client, fd, line, &fault), -EBADMSG);
	if (!strstr(fault.text, words))
		fail_msg("%s (expected %s)", fault.text, words);
	snapshot_close(&client);
}

/* Whoever listens at the socket is not trusted to be a kiosk. */
static void what_is_no_picture(void **state)
{
	char line[SNAPSHOT_LINE_MAX];
	struct snapshot kiosk;
	struct fault fault;
	FILE *plain = tmpfile();

	(void)state;
	refused(-1, "snapshot 8 8", "answered \"snapshot 8 8\", expected a picture");
	refused(dup(0), "ok", "answered \"ok\"");
	refused(dup(0), "snapshot 8", "expected a picture");
	refused(dup(0), "snapshot 0 8", "expected a picture");
	refused(dup(0), "snapshot 8 99999", "expected a picture");
	refused(dup(0), "snapshot 8 999999999999", "expected a picture");
	refused(dup(0), "snapshot 8 8 8", "expected a picture");
	assert_int_equal(ftruncate(fileno(plain), 64 * 8), 0);
	refused(dup(fileno(plain)), "snapshot 8 8", "no sealed one of 8x8");
	fclose(plain);
	draw(&kiosk, 16, 8);
	refused(dup(kiosk.fd), "snapshot 16 8", "no sealed one"); /* not yet */
	assert_int_equal(snapshot_seal(&kiosk, line, &fault), 0);
	refused(dup(kiosk.fd), "snapshot 16 9", "no sealed one of 16x9");
	refused(dup(kiosk.fd), "snapshot 17 8", "no sealed one of 17x8");
	snapshot_close(&kiosk);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whole_and_sealed),
		cmocka_unit_test(what_is_no_picture),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
