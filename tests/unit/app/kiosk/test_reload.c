/* SPDX-License-Identifier: MIT */
/* What reading the configuration again changes, key by key. */
#include <stdio.h>
#include <string.h>

#include "app/kiosk/reload.h"
#include "app/settings.h"
#include "tests/support/test.h"

static struct config *running, *fresh;

static struct config *config_of(const char *text)
{
	struct config *config;

	assert_int_equal(config_create(&config, driver_list()), 0);
	assert_int_equal(config_read_memory(config, text, strlen(text), "x", NULL), 0);
	return config;
}

static void test_reload_begin(const char *before, const char *after)
{
	running = config_of(before);
	fresh = config_of(after);
}

static void test_reload_end(void)
{
	config_destroy(running);
	config_destroy(fresh);
}

TEST("the same changes nothing")
{
	static const char text[] = "[camera a]\ndriver = sim\nsim.eye = 1 2 3\n[basis]\nfile = b\n";

	test_reload_begin(text, text);
	assert_int_equal(reload_compare(running, fresh), 0);
	test_reload_end();
}

TEST("each key has its effect")
{
	static const struct {
		const char *text;
		unsigned effects;
	} cases[] = {
		{"[lights]\nthreshold = 9\n", RELOAD_THRESHOLD | RELOAD_DRAWING},
		{"[lights]\nfollow = 0\n", RELOAD_PIPELINE},
		{"[lights]\nthreshold_step = 9\n", RELOAD_DRAWING},
		{"[lights]\nthreshold_mode = drop\n", RELOAD_PIPELINE | RELOAD_DRAWING},
		{"[fisheye]\ngain = 2\n", RELOAD_LIGHT | RELOAD_DRAWING},
		{"[fisheye]\nx = 2\n", 0},
		{"[fisheye]\ncamera = other\n", 0},
		{"[fisheye]\nposition = 0 0 0.1\n", RELOAD_PIPELINE | RELOAD_DRAWING},
		{"[lamp a]\nposition = 0 0 2\nradius = 0.1\n", RELOAD_PIPELINE | RELOAD_DRAWING},
		{"[background]\ntransfer = linear\n", RELOAD_PIPELINE | RELOAD_DRAWING},
		{"[background]\nwidth = 9\n", 0},
		{"[composite]\nthreads = 3\n", RELOAD_PIPELINE | RELOAD_DRAWING},
		{"[composite]\nkernel = c\n", RELOAD_PIPELINE | RELOAD_DRAWING},
		{"[composite]\nmode = exact\n", 0},
		{"[screen]\nshow = quad\n", RELOAD_VIEW | RELOAD_DRAWING},
		{"[screen]\nsplit = 0.25\n", RELOAD_SPLIT | RELOAD_DRAWING},
		{"[screen]\ndriver = null\n", 0},
		{"[buttons]\nscript.file = x\n", RELOAD_BUTTONS},
		{"[control]\ngroup = x\n", RELOAD_CONTROL},
		{"[state]\ninterval = 1\n", RELOAD_STATE},
		{"[basis]\npose = 1\n", RELOAD_POSE | RELOAD_DRAWING},
		{"[basis]\nfile = x\n", RELOAD_DRAWING},
		{"[camera new]\ndriver = sim\n", 0},
		{"[lights]\nthreshold = 9\n[screen]\nwidth = 9\n[state]\nfile = x\n",
		 RELOAD_THRESHOLD | RELOAD_DRAWING | RELOAD_STATE},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		test_reload_begin("", cases[i].text);
		assert_int_equal(reload_compare(running, fresh), cases[i].effects);
		test_reload_end();
	}
}

TEST("lamps come, move and go")
{
	test_reload_begin("[lamp a]\nposition = 0 0 1\nradius = 0.1\n"
			  "[lamp b]\nposition = 1 0 1\nradius = 0.1\n",
			  "[lamp c]\nposition = 0 0 3\nradius = 0.2\n");
	assert_int_equal(reload_compare(running, fresh), RELOAD_PIPELINE | RELOAD_DRAWING);
	assert_int_equal(running->lamps.count, 2);
	reload_adopt(running, fresh);
	assert_int_equal(running->lamps.count, 1);
	assert_string_equal(running->lamp_name[0], "c");
	assert_true(running->lamps.lamp[0].position[2] == 3 &&
		    running->lamps.lamp[0].radius == 0.2);
	assert_int_equal(reload_compare(running, fresh), 0);
	test_reload_end();
}

TEST("what can change is taken over and nothing else")
{
	test_reload_begin(
		"[camera a]\ndevice = one\n[screen]\nwidth = 100\n[basis]\nfile = old\n",
		"[camera a]\ndevice = two\n[camera b]\n[screen]\nwidth = 200\nshow = split\n"
		"[basis]\nfile = new\npose = 4\n[fisheye]\nfocal = 7 8\n[state]\nfile = there\n");
	reload_adopt(running, fresh);
	assert_string_equal(running->cameras[0]->settings.device, "one");
	assert_int_equal(running->camera_count, 1);
	assert_int_equal(running->screen->settings.width, 100);
	assert_string_equal(running->basis.file, "new");
	assert_int_equal(running->screen->show, SHOW_SPLIT);
	assert_int_equal(running->basis.pose, 4);
	assert_true(running->fisheye.lens.focal_px[1] == 8);
	assert_string_equal(running->state.file, "there");
	/* The remaining keys wait for the next start, and have no effect now. */
	assert_int_equal(reload_compare(running, fresh), 0);
	test_reload_end();
}
