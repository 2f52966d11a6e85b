/* SPDX-License-Identifier: MIT */
/* Buttons: the wrappers, timed scripts, the message for every mistake in a script, what counts as a
 * press of a line, and what the GPIO driver refuses. The simulated machine presses real lines. */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/gpio/button.h"
#include "drivers/gpio/edge_order.h"
#include "drivers/gpio/quadrature.h"
#include "hal/base/clock.h"
#include "tests/support/test.h"

static char folder[] = "/tmp/inlay-buttons-XXXXXX";
static char script[64];

/* the script driver's only option */
static char option[INI_PATH_MAX];

static int open_script(struct buttons *buttons, const char *text, struct fault *fault)
{
	FILE *stream = fopen(script, "w");

	assert_non_null(stream);
	assert_true(fputs(text, stream) >= 0);
	assert_int_equal(fclose(stream), 0);
	strcpy(option, script);
	return buttons_open(buttons, &buttons_script, option, fault);
}

TEST("script in time")
{
	static const struct {
		int64_t at_ms;
		enum action action;
		double value;
	} expected[] = {
		{0, ACTION_VIEW_NEXT, 0}, {50, ACTION_THRESHOLD_SET, 12.5},
		{50, ACTION_FREEZE, 0},	  {80, ACTION_THRESHOLD_UP, 0},
		{120, ACTION_QUIT, 0},
	};
	struct buttons buttons;
	struct button_press press;
	struct fault fault;
	struct pollfd ready = {.events = POLLIN};
	const int64_t start_ns = clock_now_ns();

	if (open_script(&buttons,
			"# later lines may come first\n"
			"\n"
			"0.08\tthreshold-up   # a remark\n"
			"0 view-next\n"
			"  0.05 threshold-set 12.5\r\n"
			".05 freeze\n"
			"   \n"
			"12e-2 quit",
			&fault))
		fail_msg("%s", fault.text);
	ready.fd = buttons_descriptor(&buttons);
	for (size_t i = 0; i < sizeof(expected) / sizeof(expected[0]); i++) {
		int64_t late_ns;

		assert_int_equal(poll(&ready, 1, 60000), 1);
		assert_int_equal(buttons_read(&buttons, &press, &fault), 0);
		late_ns = clock_now_ns() - start_ns - expected[i].at_ms * NS_PER_MS;
		assert_int_equal(press.action, expected[i].action);
		assert_true(press.value == expected[i].value);
		assert_true(late_ns >= 0); /* never early */
	}
	/* no more events */
	assert_int_equal(poll(&ready, 1, 20), 0);
	assert_int_equal(buttons_read(&buttons, &press, &fault), -EAGAIN);
	assert_int_equal(press.action, ACTION_NONE);
	buttons_close(&buttons);
	buttons_close(&buttons);
	assert_int_equal(buttons_read(&buttons, &press, &fault), -EBADF);
	assert_int_equal(buttons_descriptor(&buttons), -EBADF);
}

TEST("script empty")
{
	struct buttons buttons;
	struct button_press press;
	struct fault fault;

	assert_int_equal(open_script(&buttons, "# nothing\n", &fault), 0);
	assert_int_equal(buttons_read(&buttons, &press, &fault), -EAGAIN);
	buttons_close(&buttons);
}

TEST("script mistakes")
{
	static const struct {
		const char *text, *words;
	} cases[] = {
		{"1 view-next\nsoon freeze\n", ":2: \"soon\" is not a time"},
		{"-1 freeze\n", ":1: \"-1\" is not a time"},
		{"nan freeze\n", ":1: \"nan\" is not a time"},
		{"1e9 freeze\n", "from 0 to 86400"},
		{"\n\n3\n", ":3: expected an action"},
		{"3 veiw-next\n", ":1: unknown action \"veiw-next\", did you mean \"view-next\"?"},
		{"3 none\n", ":1: unknown action \"none\""},
		{"3 threshold-set\n", ":1: threshold-set needs a level"},
		{"3 threshold-set x\n", ":1: threshold-set needs a level"},
		{"3 threshold-set 1 2\n", ":1: expected a time, an action and at most one value"},
		{"3 threshold-set 256\n",
		 ":1: threshold-set needs a level, expected one number 0..255"},
		{"3 threshold-set nan\n", ":1: threshold-set needs a level"},
		{"3 threshold-set -1\n", ":1: threshold-set needs a level"},
		{"3 quit 1\n", ":1: quit takes no value, found \"1\""},
		{"3 freeze maybe\n", ":1: freeze takes on, off or nothing, found \"maybe\""},
		{"3 view\n", ":1: view needs a value"},
	};
	char longest[400];
	struct buttons buttons;
	struct fault fault;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		assert_int_equal(open_script(&buttons, cases[i].text, &fault), -EINVAL);
		if (strncmp(fault.text, script, strlen(script)) ||
		    !strstr(fault.text, cases[i].words))
			fail_msg("%s (expected %s)", fault.text, cases[i].words);
	}
	memset(longest, ' ', sizeof(longest));
	longest[sizeof(longest) - 1] = '\0';
	assert_int_equal(open_script(&buttons, longest, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, ":1: the line is too long"));
}

TEST("script missing")
{
	struct buttons buttons;
	struct fault fault;

	snprintf(option, sizeof(option), "%s/none", folder);
	assert_int_equal(buttons_open(&buttons, &buttons_script, option, &fault), -ENOENT);
	assert_non_null(strstr(fault.text, option));
	option[0] = '\0';
	assert_int_equal(buttons_open(&buttons, &buttons_script, option, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "script.file"));
	strcpy(option, folder);
	assert_int_equal(buttons_open(&buttons, &buttons_script, option, &fault), -EISDIR);
}

TEST("wrappers")
{
	struct buttons buttons = {0};
	struct fault fault;

	buttons_close(&buttons);
	assert_int_equal(buttons_open(&buttons, NULL, option, &fault), -EINVAL);
	assert_int_equal(buttons_open(&buttons, &buttons_script, NULL, &fault), -EINVAL);
	assert_string_equal(action_names[ACTION_THRESHOLD_SET], "threshold-set");
	assert_string_equal(action_names[ACTION_QUIT], "quit");
}

/* Each action's name is a press; actions that step repeat. */
TEST("every action")
{
	struct button_press press;
	struct fault fault;
	int repeating = 0;

	for (int i = ACTION_NONE + 1; i < ACTION_COUNT; i++) {
		const bool level = i == ACTION_THRESHOLD_SET;
		const bool pose = i == ACTION_POSE_SET || i == ACTION_VIEW_SET;
		const char *value = level || pose ? "255" : NULL;

		assert_int_equal(button_press_parse(action_names[i], value, &press, &fault), 0);
		assert_int_equal(press.action, i);
		assert_true(press.value == (level ? 255 : 0));
		assert_string_equal(press.name, pose ? "255" : "");
		repeating += action_repeats((enum action)i);
	}
	assert_int_equal(repeating, 4);
	assert_int_equal(button_press_parse("none", NULL, &press, &fault), -EINVAL);
	assert_int_equal(button_press_parse("threshold-set", "inf", &press, &fault), -EINVAL);
	assert_int_equal(button_press_parse("threshold-set", "", &press, &fault), -EINVAL);
	assert_false(press.percent);
	assert_int_equal(button_press_parse("threshold-set", "0.5%", &press, &fault), 0);
	assert_true(press.value == 0.5 && press.percent);
	assert_int_equal(button_press_parse("threshold-set", "100.1%", &press, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "0..255 or a percentage 0%..100%"));
}

TEST("poses")
{
	struct button_press press;
	struct fault fault;

	assert_int_equal(button_press_parse("pose", "next", &press, &fault), 0);
	assert_int_equal(press.action, ACTION_POSE_NEXT);
	assert_int_equal(button_press_parse("pose", "prev", &press, &fault), 0);
	assert_int_equal(press.action, ACTION_POSE_PREV);
	assert_int_equal(button_press_parse("pose", "front", &press, &fault), 0);
	assert_int_equal(press.action, ACTION_POSE_SET);
	assert_string_equal(press.name, "front");
	assert_int_equal(button_press_parse("pose", NULL, &press, &fault), -EINVAL);
	assert_int_equal(button_press_parse("pose", "", &press, &fault), -EINVAL);
	assert_int_equal(
		button_press_parse("pose", "a-name-of-thirty-two-characters-x", &press, &fault),
		-EINVAL);
	assert_int_equal(button_press_parse("pose-next", "2", &press, &fault), -EINVAL);
}

TEST("views and switches")
{
	static const char *const switches[] = {"object", "information", "freeze"};
	struct button_press press;
	struct fault fault;

	assert_int_equal(button_press_parse("view", "fisheye", &press, &fault), 0);
	assert_int_equal(press.action, ACTION_VIEW_SET);
	assert_string_equal(press.name, "fisheye");
	assert_int_equal(button_press_parse("view", "next", &press, &fault), 0);
	assert_int_equal(press.action, ACTION_VIEW_NEXT);
	assert_int_equal(button_press_parse("view", NULL, &press, &fault), -EINVAL);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(button_press_parse(switches[i], NULL, &press, &fault), 0);
		assert_int_equal(press.turn, TURN_OVER);
		assert_int_equal(button_press_parse(switches[i], "on", &press, &fault), 0);
		assert_int_equal(press.turn, TURN_ON);
		assert_int_equal(button_press_parse(switches[i], "off", &press, &fault), 0);
		assert_int_equal(press.turn, TURN_OFF);
		assert_int_equal(button_press_parse(switches[i], "maybe", &press, &fault), -EINVAL);
		assert_non_null(strstr(fault.text, "on, off or nothing"));
	}
	assert_int_equal(button_press_parse("quit", "on", &press, &fault), -EINVAL);
}

/* ---- a rotary encoder ---- */

/* Edges of one line at a time, "a" or "b" each. Returns the sum of steps. */
static int test_buttons_turn(struct quadrature *q, const char *edges)
{
	int sum = 0;

	for (; *edges; edges++)
		sum += quadrature_edge(q, *edges == 'a' ? !q->a : q->a,
				       *edges == 'b' ? !q->b : q->b);
	return sum;
}

/* Takes edges until none is due and appends "a" or "b" for each to text. Returns when the next is
 * due. */
static int64_t take_all(struct edge_order *order, int64_t now_ns, char *text)
{
	struct gpio_edge edge;
	int64_t until_ns;
	int line;

	while ((line = edge_order_take(order, now_ns, &edge, &until_ns)) >= 0)
		strcat(text, line ? "b" : "a");
	assert_int_equal(line, -EAGAIN);
	return until_ns;
}

/* In whatever order the kernel delivers edges, they come out in the order of their times. */
TEST("edges in order")
{
	static const int64_t ms = 1000000;
	struct edge_order order = {0};
	char text[2 * EDGE_ORDER_MAX + 1] = "";

	assert_int_equal(take_all(&order, 5 * ms, text), INT64_MAX);
	/* The second line's edge arrives first, and an earlier edge of the first line only
	 * later. */
	edge_order_add(&order, 1, (struct gpio_edge){.at_ns = 11 * ms});
	edge_order_add(&order, 1, (struct gpio_edge){.at_ns = 13 * ms});
	assert_int_equal(take_all(&order, 14 * ms, text), 11 * ms + EDGE_ORDER_NS);
	assert_string_equal(text, "");
	edge_order_add(&order, 0, (struct gpio_edge){.at_ns = 10 * ms});
	edge_order_add(&order, 0, (struct gpio_edge){.at_ns = 12 * ms});
	assert_int_equal(take_all(&order, 15 * ms, text), 13 * ms + EDGE_ORDER_NS);
	assert_string_equal(text, "aba");
	/* The last edge waits only until its own time. */
	assert_int_equal(take_all(&order, 13 * ms + EDGE_ORDER_NS, text), INT64_MAX);
	assert_string_equal(text, "abab");
	/* A time of another clock is not waited for, and a full queue does not wait. */
	edge_order_add(&order, 0, (struct gpio_edge){.at_ns = 1000 * ms});
	take_all(&order, 30 * ms, text);
	assert_string_equal(text, "ababa");
	text[0] = '\0';
	for (int i = 0; edge_order_has_room(&order, 1); i++)
		edge_order_add(&order, 1, (struct gpio_edge){.at_ns = 40 * ms + i});
	take_all(&order, 41 * ms, text);
	assert_string_equal(text, "b");
}

TEST("encoder")
{
	struct quadrature q;

	quadrature_start(&q, 4, false, false);
	assert_int_equal(test_buttons_turn(&q, "aba"), 0); /* not there yet */
	assert_int_equal(test_buttons_turn(&q, "b"), 1);
	assert_int_equal(test_buttons_turn(&q, "abababab"), 2);
	assert_int_equal(test_buttons_turn(&q, "babababa"), -2);
	assert_int_equal(test_buttons_turn(&q, "babab"),
			 -1); /* half of the next step, and back: nothing */
	assert_int_equal(test_buttons_turn(&q, "b"), 0);
	/* each contact bounces on its way */
	assert_int_equal(test_buttons_turn(&q, "aaabbbaaabbb"), 1);
	assert_int_equal(test_buttons_turn(&q, "bbbbbaaaaabbbbbaaaaa"), -1);
	assert_int_equal(test_buttons_turn(&q, "aaaaaaaa"), 0);
	/* the knob may rest with both contacts closed, and at each half period */
	quadrature_start(&q, 4, true, true);
	assert_int_equal(test_buttons_turn(&q, "abab"), 1);
	quadrature_start(&q, 2, false, false);
	assert_int_equal(test_buttons_turn(&q, "abab"), 2);
	quadrature_start(&q, 1, true, false);
	assert_int_equal(test_buttons_turn(&q, "bab"), 3);
	/* Both contacts change at once, so one edge was lost. Later edges count again. */
	quadrature_start(&q, 1, false, false);
	assert_int_equal(quadrature_edge(&q, true, true), 0);
	assert_int_equal(test_buttons_turn(&q, "ab"), 2);
	quadrature_start(&q, 4, false, false);
	assert_int_equal(test_buttons_turn(&q, "a"), 0);
	assert_int_equal(quadrature_edge(&q, false, true), 0);
	assert_int_equal(test_buttons_turn(&q, "b"), 0);
	assert_int_equal(test_buttons_turn(&q, "abab"),
			 1); /* a step counts at rest, not on the way there */
}

/* ---- lines: levels at times, in milliseconds ---- */

static const struct button_timing timing = {
	.settle_ns = 20 * NS_PER_MS,
	.repeat_after_ns = 500 * NS_PER_MS,
	.repeat_every_ns = 100 * NS_PER_MS,
};

static bool edge(struct button *button, int at_ms, bool level)
{
	return button_edge(button, &timing, level, at_ms * NS_PER_MS);
}

static bool settled(struct button *button, int at_ms)
{
	return button_settle(button, &timing, at_ms * NS_PER_MS);
}

/* Number of presses between two times; the button's timer is kept to the millisecond. */
static int presses_between(struct button *button, int from_ms, int to_ms)
{
	int count = 0;

	for (int ms = from_ms; ms < to_ms; ms++)
		if (button_deadline_ns(button, &timing) <= ms * NS_PER_MS)
			count += settled(button, ms);
	return count;
}

TEST("line bounces")
{
	struct button button;

	button_start(&button, false, false);
	assert_true(button_deadline_ns(&button, &timing) == BUTTON_NEVER);
	for (int ms = 1000; ms < 1010; ms += 2) {
		assert_false(edge(&button, ms, true));
		assert_false(edge(&button, ms + 1, false));
	}
	assert_false(edge(&button, 1010, true));
	assert_false(settled(&button, 1029));
	assert_true(button_deadline_ns(&button, &timing) == 1030 * NS_PER_MS);
	assert_true(settled(&button, 1030));
	assert_int_equal(presses_between(&button, 1031, 5000), 0); /* it does not repeat */
	/* released, with as many bounces: no press */
	for (int ms = 5000; ms < 5010; ms += 2) {
		assert_false(edge(&button, ms, false));
		assert_false(edge(&button, ms + 1, true));
	}
	assert_false(edge(&button, 5010, false));
	assert_int_equal(presses_between(&button, 5010, 6000), 0);
	assert_true(button_deadline_ns(&button, &timing) == BUTTON_NEVER);
	/* a spike is no press either */
	assert_false(edge(&button, 7000, true));
	assert_false(edge(&button, 7005, false));
	assert_int_equal(presses_between(&button, 7000, 8000), 0);
}

/* The program looks late: edges count by their own times. */
TEST("line seen late")
{
	struct button button;

	button_start(&button, false, true);
	assert_false(edge(&button, 1000, true));
	assert_true(edge(&button, 1100, false));
	assert_false(edge(&button, 1200, true));
	assert_true(edge(&button, 1300, false));
	assert_false(settled(&button, 9000));
	/* a button that was held in the meantime does not catch up */
	assert_false(edge(&button, 10000, true));
	assert_true(settled(&button, 10020));
	assert_true(settled(&button, 15000));
	assert_false(settled(&button, 15099));
	assert_true(settled(&button, 15100));
}

TEST("line repeats")
{
	const struct button_timing never = {.settle_ns = timing.settle_ns, .repeat_every_ns = 1};
	struct button button;

	button_start(&button, false, true);
	assert_false(edge(&button, 1000, true));
	assert_int_equal(presses_between(&button, 1000, 1520), 1);
	assert_int_equal(presses_between(&button, 1520, 2020), 5);
	assert_false(edge(&button, 2020, false));
	assert_int_equal(presses_between(&button, 2020, 9000), 0);
	/* stuck: quiet after ten seconds, until it is released */
	assert_false(edge(&button, 10000, true));
	assert_in_range(presses_between(&button, 10000, 21000), 90, 100);
	assert_int_equal(presses_between(&button, 21000, 90000), 0);
	assert_false(edge(&button, 90000, false));
	assert_false(settled(&button, 90020));
	assert_false(edge(&button, 91000, true));
	assert_true(settled(&button, 91020));

	button_start(&button, false, true);
	assert_false(button_edge(&button, &never, true, 0));
	assert_true(button_settle(&button, &never, NS_PER_S));
	assert_true(button_deadline_ns(&button, &never) == BUTTON_NEVER);
}

TEST("line pressed at the start")
{
	struct button button;

	button_start(&button, true, true);
	assert_int_equal(presses_between(&button, 0, 30000), 0);
	assert_false(edge(&button, 30000, true)); /* an edge was lost before this one */
	assert_int_equal(presses_between(&button, 30000, 31000), 0);
	assert_false(edge(&button, 31000, false));
	assert_false(settled(&button, 31020));
	assert_false(edge(&button, 32000, true));
	assert_true(settled(&button, 32020));
}

#if WITH_GPIO
TEST("gpio missing")
{
	/* through the key table, as the program does, because the driver's struct is private */
	void *options = calloc(1, buttons_gpio.options_size);
	struct buttons buttons;
	struct fault fault;

	assert_non_null(options);
	ini_defaults(buttons_gpio.keys, options);
	for (const struct ini_key *key = buttons_gpio.keys; key->name; key++)
		if (!strcmp(key->name, "chip"))
			strcpy((char *)options + key->offset, "no-such-chip");
	assert_int_equal(buttons_open(&buttons, &buttons_gpio, options, &fault), -ENODEV);
	assert_non_null(strstr(fault.text, "there is no chip \"no-such-chip\""));
	free(options);
}
#endif

static int make_folder(void **state)
{
	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(script, sizeof(script), "%s/script", folder);
	return 0;
}

static int remove_folder(void **state)
{
	(void)state;
	unlink(script);
	return rmdir(folder);
}

TEST_GROUP(make_folder, remove_folder);
