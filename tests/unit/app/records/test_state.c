/* SPDX-License-Identifier: MIT */
/* The operator's choices, kept in a file. */
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/records/records.h"
#include "hal/base/clock.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static const struct state_values start = {{0, false}, SHOW_COMPOSITE, 0};

static struct config_state settings_for(const char *name, double interval_s)
{
	struct config_state settings = {.interval_s = interval_s};

	snprintf(settings.file, sizeof(settings.file), "%.1000s", own_folder_path(name));
	return settings;
}

static struct keeper *keeper;

static int begin_keeper(void **state)
{
	return own_folder_make(state) || keeper_create(&keeper);
}

/* Ends the keeper, which has then written all, and begins another. */
static void state_end(struct state *state)
{
	state_destroy(state);
	keeper_destroy(keeper);
	assert_int_equal(keeper_create(&keeper), 0);
}

static int end_keeper(void **state)
{
	keeper_destroy(keeper);
	return own_folder_remove(state);
}

/* Waits until the file holds that threshold, and looks as the kiosk does. */
static bool comes_to_hold(struct state *kept, const char *name, double threshold)
{
	int64_t end = clock_now_ns() + 60 * NS_PER_S;
	struct state_values values = start;

	while (clock_now_ns() < end) {
		if (state_read(own_folder_path(name), &values, NULL) == 0 &&
		    values.threshold.value == threshold)
			return true;
		state_look(kept);
		usleep(2000);
	}
	return false;
}

TEST("what is kept reads back")
{
	const struct config_state settings = settings_for("state", 0);
	const struct state_values chosen = {{40.5, false}, SHOW_SPLIT, 3};
	struct state_values values = start;
	struct fault fault = {.text = ""};
	struct state *kept;

	assert_int_equal(state_read(settings.file, &values, &fault), -ENOENT);
	assert_int_equal(state_create(&kept, keeper, &settings, &start), 0);
	state_keep(kept, &chosen);
	assert_true(comes_to_hold(kept, "state", 40.5));
	state_end(kept);
	assert_int_equal(state_read(settings.file, &values, &fault), 0);
	assert_true(values.threshold.value == 40.5);
	assert_int_equal(values.view, SHOW_SPLIT);
	assert_int_equal(values.pose, 3);
	unlink(settings.file);
}

TEST("nothing chosen writes nothing")
{
	const struct config_state settings = settings_for("state", 0);
	const struct config_state none = {.interval_s = 0};
	struct state *kept;

	assert_int_equal(state_create(&kept, keeper, &settings, &start), 0);
	state_keep(kept, &start);
	state_end(kept);
	assert_int_equal(access(settings.file, F_OK), -1);
	assert_int_equal(state_create(&kept, keeper, &none, &start), 0);
	state_keep(kept, &(struct state_values){{1, false}, 1, 1}); /* no file is set */
	state_end(kept);
	state_destroy(NULL);
	state_keep(NULL, &start);
	state_move(NULL, &settings);
}

/* The first choice is written at once, the next after an interval that never passes in this test,
 * and the last at the end. */
TEST("the interval is kept and the end writes the last")
{
	const struct config_state settings = settings_for("state", 86400);
	struct state_values values = start;
	struct state *kept;
	struct stat before, after;

	assert_int_equal(state_create(&kept, keeper, &settings, &start), 0);
	state_keep(kept, &(struct state_values){{1, false}, SHOW_COMPOSITE, 0});
	assert_true(comes_to_hold(kept, "state", 1));
	assert_int_equal(stat(settings.file, &before), 0);
	for (int i = 2; i <= 50; i++)
		state_keep(kept, &(struct state_values){{i, false}, SHOW_COMPOSITE, 0});
	state_look(kept);
	usleep(50000);
	assert_int_equal(stat(settings.file, &after), 0);
	assert_int_equal(before.st_ino, after.st_ino);
	state_end(kept);
	assert_int_equal(state_read(settings.file, &values, NULL), 0);
	assert_true(values.threshold.value == 50);
	unlink(settings.file);
}

TEST("a missing folder is tried again")
{
	struct config_state settings = settings_for("gone", 0);
	struct state *kept;
	char folder[PATH_MAX];

	snprintf(folder, sizeof(folder), "%s", settings.file);
	strcat(settings.file, "/state");
	assert_int_equal(state_create(&kept, keeper, &settings, &start), 0);
	state_keep(kept, &(struct state_values){{7, false}, SHOW_COMPOSITE, 0});
	usleep(50000);
	assert_int_equal(mkdir(folder, 0700), 0);
	assert_true(comes_to_hold(kept, "gone/state", 7));
	state_end(kept);
	unlink(settings.file);
	rmdir(folder);
}

/* A limit on the size of files stands for a full disk. */
TEST("what cannot be written leaves the old file")
{
	const struct config_state settings = settings_for("state", 0);
	struct state_values values = start;
	struct rlimit before, full;
	struct state *kept;
	FILE *stream = fopen(settings.file, "w");

	assert_non_null(stream);
	fputs("[chosen]\nthreshold = 12\n", stream);
	fclose(stream);
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	full = (struct rlimit){20, before.rlim_max};
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &full), 0);
	assert_int_equal(state_create(&kept, keeper, &settings, &start), 0);
	state_keep(kept, &(struct state_values){{7, false}, SHOW_COMPOSITE, 0});
	state_end(kept);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
	assert_int_equal(state_read(settings.file, &values, NULL), 0);
	assert_true(values.threshold.value == 12);
	unlink(settings.file);
}

TEST("another file gets all of it")
{
	const struct config_state first = settings_for("state", 0);
	const struct config_state second = settings_for("other", 0);
	struct state *kept;

	assert_int_equal(state_create(&kept, keeper, &first, &start), 0);
	state_keep(kept, &(struct state_values){{9, false}, SHOW_COMPOSITE, 0});
	assert_true(comes_to_hold(kept, "state", 9));
	state_move(kept, &second);
	assert_true(comes_to_hold(kept, "other", 9)); /* although nothing has been chosen since */
	state_end(kept);
	unlink(first.file);
	unlink(second.file);
}

TEST("damage is named and leaves all alone")
{
	static const struct {
		const char *text, *said;
	} cases[] = {
		{"[chosen]\npose = 1\nthreshold = 256\n", "x:3: [chosen] threshold"},
		{"[chosen]\nview = upside-down\n", "x:2: [chosen] view"},
		{"[chosen]\nthreshold = nan\n", "x:2: [chosen] threshold"},
		{"\1\2\3", "x:1:"},
		{"[other]\na = 1\n", "x:1:"},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct state_values values = {{5, false}, SHOW_QUAD, 6};
		struct fault fault = {.text = ""};

		assert_int_equal(state_read_memory(cases[i].text, strlen(cases[i].text), "x",
						   &values, &fault),
				 -EINVAL);
		assert_memory_equal(fault.text, cases[i].said, strlen(cases[i].said));
		assert_true(values.threshold.value == 5 && values.view == SHOW_QUAD &&
			    values.pose == 6);
	}
}

TEST("missing keys leave their value")
{
	struct state_values values = {{5, false}, SHOW_QUAD, 6};

	assert_int_equal(state_read_memory("", 0, "x", &values, NULL), 0);
	assert_int_equal(state_read_memory("[chosen]\npose = 2\n", 18, "x", &values, NULL), 0);
	assert_true(values.threshold.value == 5 && values.view == SHOW_QUAD && values.pose == 2);
}

TEST_GROUP(begin_keeper, end_keeper);
