/* SPDX-License-Identifier: MIT */
/* A picture that goes from the kiosk to a client: its line and its rows. */
#include <errno.h>
#include <string.h>

#include "app/control/snapshot.h"
#include "tests/support/test.h"

TEST("rows follow each other")
{
	static const int size[][2] = {{1, 1}, {641, 3}, {48, 32}};
	char line[SNAPSHOT_LINE_MAX];
	struct snapshot *kiosk, *client;
	struct fault fault;

	for (int k = 0; k < 3; k++) {
		const int width = size[k][0], height = size[k][1];

		assert_int_equal(snapshot_create(&kiosk, width, height, &fault), 0);
		assert_int_equal(kiosk->stride % 64, 0);
		for (int y = 0; y < height; y++)
			memset(kiosk->pixels + (size_t)y * kiosk->stride, y + 1, 4 * (size_t)width);
		snapshot_finish(kiosk, line);
		for (size_t i = 0; i < snapshot_bytes(kiosk); i++)
			assert_int_equal(kiosk->pixels[i], i / (4 * (size_t)width) + 1);
		assert_int_equal(snapshot_expect(&client, line, &fault), 0);
		assert_int_equal(client->width, width);
		assert_int_equal(client->height, height);
		assert_int_equal(client->stride, 4 * width);
		snapshot_release(client);
		snapshot_release(kiosk);
	}
	snapshot_release(NULL);
}

/* Whoever listens at the socket is not trusted to be a kiosk. */
TEST("what is no picture")
{
	static const char *const lines[] = {"ok",
					    "snapshot 8",
					    "snapshot 0 8",
					    "snapshot 8 99999",
					    "snapshot 8 999999999999",
					    "snapshot 8 8 8"};
	struct snapshot *client;
	struct fault fault;

	for (size_t k = 0; k < sizeof(lines) / sizeof(*lines); k++) {
		assert_int_equal(snapshot_expect(&client, lines[k], &fault), -EBADMSG);
		assert_non_null(strstr(fault.text, lines[k]));
		assert_non_null(strstr(fault.text, "expected a picture"));
	}
}
