/* SPDX-License-Identifier: MIT */
/* INI files read by tables of keys: what is accepted, and the exact message for what is not. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/ini/ini.h"
#include "hal/ini/ini_value.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static const char *const colours[] = {"red", "green", "blue", NULL};

struct ini_lamp {
	bool on;
	int count;
	double power;
	double place[3];
	char label[INI_TEXT_MAX];
	char file[INI_PATH_MAX];
	int colour;
};

struct extra {
	double speed;
};

struct camera_part {
	char name[64];
	int width;
	struct sim {
		double noise;
	} sim;
};

struct root {
	struct ini_lamp lamp;
	struct extra extra;
	struct camera_part cameras[2];
	int camera_count;
	struct {
		int must;
	} strict;
};

static const struct ini_key lamp_keys[] = {
	{"on", INI_BOOL, offsetof(struct ini_lamp, on), .fallback = "yes", .help = "Lit or not."},
	{"count", INI_INT, offsetof(struct ini_lamp, count), .min = 0, .max = 255, .fallback = "7",
	 .unit = "lamps", .help = "How many."},
	{"power", INI_REAL, offsetof(struct ini_lamp, power), .min = -1, .max = 1e3,
	 .fallback = "0.1", .unit = "W", .help = "How strong."},
	{"place", INI_REALS, offsetof(struct ini_lamp, place), .count = 3, .fallback = "1 2 3",
	 .help = "Where."},
	{"label", INI_TEXT, offsetof(struct ini_lamp, label), .fallback = "", .help = "Name."},
	{"file", INI_PATH, offsetof(struct ini_lamp, file), .fallback = "", .help = "Of the lamp."},
	{"colour", INI_CHOICE, offsetof(struct ini_lamp, colour), .choices = colours,
	 .fallback = "green", .help = "Tint."},
	INI_KEYS_END};

static const struct ini_key extra_keys[] = {{"speed", INI_REAL, offsetof(struct extra, speed),
					     .min = 0, .max = 9, .fallback = "2", .help = "Turns."},
					    INI_KEYS_END};

static const struct ini_key camera_part_keys[] = {
	{"width", INI_INT, offsetof(struct camera_part, width), .min = 0, .max = 4096,
	 .fallback = "640", .unit = "px", .help = "Wanted."},
	INI_KEYS_END};

static const struct ini_key sim_keys[] = {{"noise", INI_REAL, offsetof(struct sim, noise), .min = 0,
					   .max = 1, .fallback = "0", .help = "Grain."},
					  INI_KEYS_END};

static const struct ini_key strict_keys[] = {
	{"must", INI_INT, 0, .min = 1, .max = 5, .help = "No default."}, INI_KEYS_END};

static void *place_lamp(void *root, const char *instance)
{
	assert_null(instance);
	return &((struct root *)root)->lamp;
}

static void *place_extra(void *root, const char *instance)
{
	assert_null(instance);
	return &((struct root *)root)->extra;
}

static void *place_strict(void *root, const char *instance)
{
	assert_null(instance);
	return &((struct root *)root)->strict;
}

static void *place_camera(void *user, const char *instance)
{
	struct root *root = user;
	struct camera_part *part;

	for (int i = 0; i < root->camera_count; i++) {
		if (!strcmp(root->cameras[i].name, instance))
			return &root->cameras[i];
	}
	if (root->camera_count == 2)
		return NULL;
	part = &root->cameras[root->camera_count++];
	snprintf(part->name, sizeof(part->name), "%s", instance);
	ini_defaults(camera_part_keys, part);
	ini_defaults(sim_keys, &part->sim);
	return part;
}

static const struct ini_table tables[] = {
	{.section = "lamp", .keys = lamp_keys, .help = "A lamp.", .place = place_lamp},
	{.section = "lamp", .prefix = "spin.", .keys = extra_keys, .place = place_extra},
	{.section = "camera",
	 .named = true,
	 .keys = camera_part_keys,
	 .help = "A camera.",
	 .place = place_camera,
	 .sample = "left right"},
	{.section = "camera",
	 .named = true,
	 .prefix = "sim.",
	 .keys = sim_keys,
	 .place = place_camera,
	 .part = offsetof(struct camera_part, sim)},
	{.section = "strict", .keys = strict_keys, .place = place_strict},
	INI_TABLES_END};

struct outcome {
	struct root root;
	struct ini_report report;
	char said[120][FAULT_TEXT_MAX];
	int said_count;
};

static void note(void *context, const char *text)
{
	struct outcome *o = context;

	assert_true(o->said_count < 120);
	snprintf(o->said[o->said_count++], FAULT_TEXT_MAX, "%s", text);
}

static struct outcome *outcome_fresh(void)
{
	struct outcome *o = calloc(1, sizeof(*o));

	assert_non_null(o);
	ini_defaults(lamp_keys, &o->root.lamp);
	ini_defaults(extra_keys, &o->root.extra);
	o->report.say = note;
	o->report.context = o;
	return o;
}

static struct outcome *parse_bytes(const char *text, size_t bytes)
{
	struct outcome *o = outcome_fresh();
	int err = ini_read_memory(text, bytes, "k.conf", "/etc/inlay", tables, &o->root,
				  &o->report);

	assert_int_equal(o->report.count, o->said_count);
	assert_int_equal(err, o->said_count ? -EINVAL : 0);
	if (o->said_count)
		assert_string_equal(o->report.first.text, o->said[0]);
	return o;
}

static struct outcome *parse(const char *text)
{
	return parse_bytes(text, strlen(text));
}

static void expect_faults(const char *text, ...)
{
	struct outcome *o = parse(text);
	const char *want;
	va_list args;
	int i = 0;

	va_start(args, text);
	while ((want = va_arg(args, const char *))) {
		assert_true(i < o->said_count);
		assert_string_equal(o->said[i++], want);
	}
	va_end(args);
	assert_int_equal(i, o->said_count);
	free(o);
}

TEST("every type is read")
{
	struct outcome *o = parse(
		"; a comment\n# another\n\n[lamp]\non = off\ncount=12 ; twelve\n"
		"  power : -0.25e0\nplace = 1.5, -2  3e1\nlabel = two words\n"
		"file = a b/c.txt\ncolour=blue\nspin.speed = 9\n"
		"[camera  one]\nsim.noise=0.5\n[camera two]\nwidth=10\n[camera one]\n"
		"width=4096\n");
	const struct ini_lamp *lamp = &o->root.lamp;

	assert_int_equal(o->said_count, 0);
	assert_false(lamp->on);
	assert_int_equal(lamp->count, 12);
	assert_true(lamp->power == -0.25);
	assert_true(lamp->place[0] == 1.5 && lamp->place[1] == -2 && lamp->place[2] == 30);
	assert_string_equal(lamp->label, "two words");
	assert_string_equal(lamp->file, "/etc/inlay/a b/c.txt");
	assert_int_equal(lamp->colour, 2);
	assert_true(o->root.extra.speed == 9);
	assert_int_equal(o->root.camera_count, 2);
	assert_string_equal(o->root.cameras[0].name, "one");
	assert_int_equal(o->root.cameras[0].width, 4096);
	assert_true(o->root.cameras[0].sim.noise == 0.5);
	assert_int_equal(o->root.cameras[1].width, 10);
	free(o);
}

TEST("defaults fill every field")
{
	struct outcome *o = outcome_fresh();
	const struct ini_lamp *lamp = &o->root.lamp;

	assert_true(lamp->on);
	assert_int_equal(lamp->count, 7);
	assert_true(lamp->power == 0.1);
	assert_true(lamp->place[0] == 1 && lamp->place[1] == 2 && lamp->place[2] == 3);
	assert_string_equal(lamp->label, "");
	assert_string_equal(lamp->file, "");
	assert_int_equal(lamp->colour, 1);
	free(o);
}

TEST("windows text is tolerated")
{
	struct outcome *o = parse("\xef\xbb\xbf[lamp]\r\ncount = 9\r\n\r\nlabel = x\r\n");

	assert_int_equal(o->said_count, 0);
	assert_int_equal(o->root.lamp.count, 9);
	assert_string_equal(o->root.lamp.label, "x");
	free(o);
}

TEST("paths start at the files folder")
{
	struct outcome *o = parse("[lamp]\nfile = /abs\n");

	assert_string_equal(o->root.lamp.file, "/abs");
	free(o);
	o = parse("[lamp]\nfile =\n");
	assert_int_equal(o->said_count, 0);
	assert_string_equal(o->root.lamp.file, "");
	free(o);
}

TEST("names are checked")
{
	expect_faults("[lamp]\n\ncuont = 5\n",
		      "k.conf:3: [lamp] cuont: unknown key, did you mean \"count\"?", NULL);
	expect_faults("[lamp]\nspin.sped = 5\n",
		      "k.conf:2: [lamp] spin.sped: unknown key, did you mean \"spin.speed\"?",
		      NULL);
	expect_faults("[lamp]\nzzzzzz = 5\n", "k.conf:2: [lamp] zzzzzz: unknown key", NULL);
	expect_faults("[lmap]\nanything = 1\nmore\n[lamp]\ncount=1\n",
		      "k.conf:1: [lmap] unknown section, did you mean \"lamp\"?", NULL);
	expect_faults("[qqqqqq]\n", "k.conf:1: [qqqqqq] unknown section", NULL);
	expect_faults("[camera]\nwidth=1\n",
		      "k.conf:1: [camera] has no name, expected [camera NAME]", NULL);
	expect_faults("[lamp big]\ncount=1\n",
		      "k.conf:1: [lamp big] takes no name, expected [lamp]", NULL);
	expect_faults(
		"[camera a]\n[camera b]\n[camera c]\nwidth=1\n",
		"k.conf:3: [camera c] is one section [camera NAME] more than there is room for",
		NULL);
}

TEST("values are checked")
{
	expect_faults("[lamp]\ncount = 300\n",
		      "k.conf:2: [lamp] count: is \"300\", expected a whole number 0..255 lamps",
		      NULL);
	expect_faults("[lamp]\ncount = 12x\n",
		      "k.conf:2: [lamp] count: is \"12x\", expected a whole number 0..255 lamps",
		      NULL);
	expect_faults("[lamp]\ncount =\n",
		      "k.conf:2: [lamp] count: has no value, expected a whole number 0..255 lamps",
		      NULL);
	expect_faults(
		"[lamp]\ncount = 99999999999999999999\n",
		"k.conf:2: [lamp] count: is \"99999999999999999999\", expected a whole number 0..255 lamps",
		NULL);
	expect_faults("[lamp]\npower = nan\n",
		      "k.conf:2: [lamp] power: is \"nan\", expected a number -1..1000 W", NULL);
	expect_faults("[lamp]\npower = 1e999\n",
		      "k.conf:2: [lamp] power: is \"1e999\", expected a number -1..1000 W", NULL);
	expect_faults("[lamp]\npower = 0x10\n",
		      "k.conf:2: [lamp] power: is \"0x10\", expected a number -1..1000 W", NULL);
	expect_faults("[lamp]\nplace = 1 2\n",
		      "k.conf:2: [lamp] place: is \"1 2\", expected 3 numbers", NULL);
	expect_faults("[lamp]\nplace = 1 2 3 4\n",
		      "k.conf:2: [lamp] place: is \"1 2 3 4\", expected 3 numbers", NULL);
	expect_faults("[lamp]\nplace = inf 0 0\n",
		      "k.conf:2: [lamp] place: is \"inf 0 0\", expected 3 numbers", NULL);
	expect_faults("[lamp]\nplace = 1,,2,3\n",
		      "k.conf:2: [lamp] place: is \"1,,2,3\", expected 3 numbers", NULL);
	expect_faults("[lamp]\non = maybe\n",
		      "k.conf:2: [lamp] on: is \"maybe\", expected yes or no", NULL);
	expect_faults(
		"[lamp]\ncolour = gren\n",
		"k.conf:2: [lamp] colour: is \"gren\", expected one of red, green, blue; did you mean \"green\"?",
		NULL);
}

/* Lists with a limited number of numbers. */
TEST("lists end where they end")
{
	struct shutter {
		double times[3];
	} shutter = {{9, 9, 9}};
	static const struct ini_key keys[] = {{"times", INI_LIST, offsetof(struct shutter, times),
					       .count = 3, .min = 0.5, .max = 100, .fallback = "",
					       .help = "In turn."},
					      INI_KEYS_END};
	static const struct {
		const char *text, *again;
		double times[3];
	} good[] = {
		{"", "", {0, 0, 0}},
		{"4", "4", {4, 0, 0}},
		{"4, 2", "4 2", {4, 2, 0}},
		{"4 2 ,0.5", "4 2 0.5", {4, 2, 0.5}},
	};
	static const char *const bad[] = {"0", "4, 0", "4 2 1 0.5", "4,", ",4", "4;2", "x", "101"};
	char why[INI_WHY_MAX], text[64];

	ini_defaults(keys, &shutter);
	assert_true(shutter.times[0] == 0 && shutter.times[2] == 0);
	for (size_t k = 0; k < sizeof(good) / sizeof(*good); k++) {
		assert_int_equal(ini_value_read(&keys[0], good[k].text, NULL, &shutter, why), 0);
		for (int n = 0; n < 3; n++)
			expect_equal(shutter.times[n], good[k].times[n], "k=%zu, n=%d", k, n);
		ini_value_text(&keys[0], &shutter, text, sizeof(text));
		assert_string_equal(text, good[k].again);
	}
	for (size_t k = 0; k < sizeof(bad) / sizeof(*bad); k++) {
		expect_equal(ini_value_read(&keys[0], bad[k], NULL, &shutter, why), -EINVAL,
			     "k=%zu", k);
		assert_non_null(strstr(why, "expected at most 3 numbers 0.5..100"));
		expect_equal(shutter.times[2], 0.5, "k=%zu", k); /* unchanged */
	}
}

TEST("long values are refused")
{
	char text[4096];
	struct outcome *o;

	snprintf(text, sizeof(text), "[lamp]\nlabel = %0*d\n", INI_TEXT_MAX - 1, 1);
	o = parse(text);
	assert_int_equal(o->said_count, 0);
	assert_int_equal(strlen(o->root.lamp.label), INI_TEXT_MAX - 1);
	free(o);
	snprintf(text, sizeof(text), "[lamp]\nlabel = %0*d\n", INI_TEXT_MAX, 1);
	o = parse(text);
	assert_int_equal(o->said_count, 1);
	assert_non_null(strstr(o->said[0], "k.conf:2: [lamp] label: is \"000"));
	assert_non_null(strstr(o->said[0], "expected text of at most 255 bytes"));
	free(o);
	snprintf(text, sizeof(text), "[lamp]\nfile = %0*d\n", INI_PATH_MAX - 12, 1);
	o = parse(text);
	assert_int_equal(o->said_count, 0);
	assert_int_equal(strlen(o->root.lamp.file), INI_PATH_MAX - 1);
	free(o);
	snprintf(text, sizeof(text), "[lamp]\nfile = %0*d\n", INI_PATH_MAX - 11, 1);
	o = parse(text);
	assert_int_equal(o->said_count, 1);
	free(o);
	snprintf(text, sizeof(text), "[lamp]\nlabel = %0*d\ncount = 8\n", 3000, 1);
	o = parse(text);
	assert_int_equal(o->said_count, 1);
	assert_string_equal(o->said[0],
			    "k.conf:2: the line is too long (3008 bytes), expected at most 2046");
	assert_int_equal(o->root.lamp.count, 8);
	free(o);
}

TEST("structure is checked")
{
	expect_faults("count = 1\n[lamp]\n",
		      "k.conf:1: key \"count\" stands before the first section, expected [section]",
		      NULL);
	expect_faults("[lamp]\njust words\ncount=1\n",
		      "k.conf:2: [lamp] not understood, expected key = value", NULL);
	expect_faults("[lamp]\nlast words", "k.conf:2: [lamp] not understood, expected key = value",
		      NULL);
	expect_faults("[lamp]\n= 5\n",
		      "k.conf:2: [lamp] has \"=\" without a key, expected key = value", NULL);
	expect_faults("[lamp]\ncount = 1\n[lamp]\n\ncount = 2\n",
		      "k.conf:5: [lamp] count: is given twice, first in line 2; expected once",
		      NULL);
	expect_faults(
		"[lamp\ncount = 999\n",
		"k.conf:1: not a section, expected [section] or [section name] of letters, digits, \"-\" and \"_\"",
		NULL);
	expect_faults("[lamp] count = 1\n",
		      "k.conf:1: text follows the section's \"]\", expected nothing", NULL);
	expect_faults("[lamp]junk\n",
		      "k.conf:1: text follows the section's \"]\", expected nothing", NULL);
	expect_faults("[camera xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx]\n",
		      "k.conf:1: the section's title is too long, expected at most 49 bytes", NULL);
	expect_faults("[strict]\n",
		      "k.conf:1: [strict] must: is missing, expected a whole number 1..5", NULL);
	expect_faults("[strict]\nmust = 3\n", NULL);
}

TEST("everything wrong is said")
{
	expect_faults("[lamp]\ncuont = 5\npower = 1e9\nwords\n[nope]\n[strict]\n",
		      "k.conf:2: [lamp] cuont: unknown key, did you mean \"count\"?",
		      "k.conf:3: [lamp] power: is \"1e9\", expected a number -1..1000 W",
		      "k.conf:4: [lamp] not understood, expected key = value",
		      "k.conf:5: [nope] unknown section",
		      "k.conf:6: [strict] must: is missing, expected a whole number 1..5", NULL);
}

/* What an editor put in, and nobody sees, is called by its name. */
TEST("invisible oddities are named")
{
	static const char *const utf16[] = {"\xff\xfe[\0l\0", "\xfe\xff\0[\0l", "[\0l\0", "\0[\0l"};
	static const char *const inside = "[lamp]\nlabel = a\u00a0b \"c\"\n";
	static const int bytes[] = {6, 6, 4, 4};
	static const struct {
		const char *text, *part;
	} cases[] = {
		{"[lamp]\ncount\u00a0= 5\n",
		 "k.conf:2: [lamp] the key \"count\u00a0\" holds a no-break"},
		{"[lamp]\ncount =\u00a05\n", "k.conf:2: [lamp] count: holds a no-break"},
		{"[lamp]\ncount = 5\u200b\n", "k.conf:2: [lamp] count: holds a no-break"},
		{"[\u00a0lamp]\ncount = 5\n", "k.conf:1: the section's title holds a no-break"},
		{"[lamp]\ncount = \"5\"\n", "k.conf:2: [lamp] count: stands in quotation marks"},
		{"[lamp]\nlabel = 'left'\n", "k.conf:2: [lamp] label: stands in quotation marks"},
		{"[lamp]\nlabel = \u201cleft\u201d\n",
		 "k.conf:2: [lamp] label: stands in quotation"},
	};
	struct outcome *o;

	for (int i = 0; i < 4; i++) {
		o = parse_bytes(utf16[i], (size_t)bytes[i]);

		assert_int_equal(o->said_count, 1);
		assert_string_equal(o->said[0],
				    "k.conf: is UTF-16, expected UTF-8: save it in that encoding");
		free(o);
	}
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		o = parse_bytes(cases[i].text, strlen(cases[i].text));
		expect_above(o->said_count, 0, "%s", cases[i].text);
		if (strncmp(o->said[0], cases[i].part, strlen(cases[i].part)) != 0)
			fail_msg("%s, expected %s", o->said[0], cases[i].part);
		free(o);
	}
	o = parse_bytes(inside, strlen(inside));
	assert_int_equal(o->said_count, 0);
	free(o);
}

TEST("binary data is refused")
{
	static const char nul[] = "[lamp]\ncount\0 = 5\n";
	struct outcome *o = parse_bytes(nul, sizeof(nul) - 1);

	assert_int_equal(o->said_count, 1);
	assert_string_equal(o->said[0],
			    "k.conf:2: holds a control character, expected a text file");
	free(o);
	o = parse("\x7f"
		  "ELF\x02\x01\x01");
	assert_int_equal(o->said_count, 1);
	free(o);
	o = parse("[lamp]\nlabel = \x1b[2J\n");
	assert_int_equal(o->said_count, 1);
	free(o);
	o = parse("");
	assert_int_equal(o->said_count, 0);
	free(o);
}

TEST("thousands of faults are cut")
{
	char *text = malloc(200000);
	struct outcome *o;

	assert_non_null(text);
	memset(text, 'x', 199999);
	for (int i = 10; i < 199999; i += 11)
		text[i] = '\n';
	memcpy(text, "[lamp]\n", 7);
	text[199999] = '\0';
	o = parse(text);
	assert_int_equal(o->said_count, 100);
	free(o);
	free(text);
}

TEST("assignments are read")
{
	static const struct {
		const char *assignment, *fault;
	} wrong[] = {
		{"lamp.count=300",
		 "--set lamp.count=300: [lamp] count: is \"300\", expected a whole number 0..255 lamps"},
		{"lamp.cout=3",
		 "--set lamp.cout=3: [lamp] cout: unknown key, did you mean \"count\"?"},
		{"lmp.count=3", "--set lmp.count=3: [lmp] unknown section, did you mean \"lamp\"?"},
		{"camera.width=3",
		 "--set camera.width=3: [camera] has named sections, expected camera.NAME.key=value, NAME of letters, digits, \"-\" and \"_\""},
		{"camera.o\"o.width=3",
		 "--set camera.o\"o.width=3: [camera] has named sections, expected camera.NAME.key=value, NAME of letters, digits, \"-\" and \"_\""},
		{"lamp.count", "--set lamp.count: expected section.key=value"},
		{"count=3", "--set count=3: expected section.key=value"},
		{"=", "--set =: expected section.key=value"},
		{"", "--set : expected section.key=value"},
		{"camera.three.width=3",
		 "--set camera.three.width=3: [camera three] is one section [camera NAME] more than there is room for"},
	};
	struct outcome *o = outcome_fresh();

	assert_int_equal(ini_set(" lamp.count = 31 ", tables, &o->root, &o->report), 0);
	assert_int_equal(ini_set("lamp.count=32", tables, &o->root, &o->report), 0);
	assert_int_equal(ini_set("lamp.label=a = b", tables, &o->root, &o->report), 0);
	assert_int_equal(ini_set("lamp.file=rel/x", tables, &o->root, &o->report), 0);
	assert_int_equal(ini_set("lamp.spin.speed=1", tables, &o->root, &o->report), 0);
	assert_int_equal(ini_set("camera.one.sim.noise=1", tables, &o->root, &o->report), 0);
	assert_int_equal(ini_set("camera.two.width=1", tables, &o->root, &o->report), 0);
	assert_int_equal(o->said_count, 0);
	assert_int_equal(o->root.lamp.count, 32);
	assert_string_equal(o->root.lamp.label, "a = b");
	assert_string_equal(o->root.lamp.file, "rel/x");
	assert_true(o->root.extra.speed == 1);
	assert_true(o->root.cameras[0].sim.noise == 1);
	assert_int_equal(o->root.cameras[1].width, 1);
	for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++) {
		o->said_count = 0;
		expect_equal(ini_set(wrong[i].assignment, tables, &o->root, &o->report), -EINVAL,
			     "i=%zu", i);
		expect_equal(o->said_count, 1, "i=%zu", i);
		assert_string_equal(o->said[0], wrong[i].fault);
	}
	free(o);
}

TEST("long assignments do no harm")
{
	char text[5000];
	struct outcome *o = outcome_fresh();

	for (size_t length = 40; length < sizeof(text); length += 17) {
		memset(text, 'n', length);
		memcpy(text, "camera.", 7);
		text[length] = '\0';
		assert_int_not_equal(ini_set(text, tables, &o->root, NULL), 0);
		memcpy(text + length - 8, ".width=1", 8);
		(void)ini_set(text, tables, &o->root, NULL);
	}
	free(o);
}

TEST("text of values reads back")
{
	struct outcome *o = parse("[lamp]\non=no\ncount=3\npower=0.30000000000000004\n"
				  "place=1e-7 -3.25 123456.789\nlabel=x y\nfile=/p\ncolour=red\n");
	char all[4096] = "[lamp]\n";
	struct outcome *again;

	for (const struct ini_key *key = lamp_keys; key->name; key++) {
		char value[INI_PATH_MAX];
		int n = ini_value_text(key, &o->root.lamp, value, sizeof(value));

		assert_int_equal(n, strlen(value));
		sprintf(all + strlen(all), "%s = %s\n", key->name, value);
	}
	again = parse(all);
	assert_int_equal(again->said_count, 0);
	assert_memory_equal(&again->root.lamp, &o->root.lamp, sizeof(o->root.lamp));
	assert_int_equal(ini_value_text(&lamp_keys[4], &o->root.lamp, all, 2), 3);
	assert_string_equal(all, "x");
	free(o);
	free(again);
}

TEST("sample equals the defaults")
{
	char *text = NULL;
	size_t bytes;
	FILE *stream = open_memstream(&text, &bytes);
	struct outcome *o, *fresh = outcome_fresh();

	assert_non_null(stream);
	ini_write_sample(stream, tables);
	fclose(stream);
	o = parse_bytes(text, bytes);
	/* A key without a default cannot be in the sample: it is the only one missing. */
	assert_int_equal(o->said_count, 1);
	assert_non_null(strstr(o->said[0], "[strict] must: is missing"));
	assert_memory_equal(&o->root.lamp, &fresh->root.lamp, sizeof(fresh->root.lamp));
	assert_memory_equal(&o->root.extra, &fresh->root.extra, sizeof(fresh->root.extra));
	assert_int_equal(o->root.camera_count, 2);
	assert_string_equal(o->root.cameras[0].name, "left");
	assert_int_equal(o->root.cameras[0].width, 640);
	assert_string_equal(o->root.cameras[1].name, "right");
	assert_int_equal(o->root.cameras[1].width, 640);
	/* The full stop comes after the range. */
	assert_non_null(strstr(text, "; How many (a whole number 0..255 lamps).\ncount = 7\n"));
	assert_non_null(strstr(text, "; Tint (one of red, green, blue).\ncolour = green\n"));
	assert_non_null(strstr(text, "; Of the lamp.\nfile =\n"));
	free(text);
	free(o);
	free(fresh);
}

TEST("files that cannot be read")
{
	char folder[] = "/tmp/test_ini_XXXXXX", path[64], big[64];
	struct outcome *o = outcome_fresh();
	FILE *f;

	assert_non_null(mkdtemp(folder));
	snprintf(path, sizeof(path), "%s/x.conf", folder);
	snprintf(big, sizeof(big), "%s/big.conf", folder);
	assert_int_equal(ini_read(path, tables, &o->root, &o->report), -ENOENT);
	assert_non_null(strstr(o->said[0], "x.conf: No such file or directory"));
	assert_int_equal(ini_read(folder, tables, &o->root, &o->report), -EISDIR);
	f = fopen(big, "w");
	assert_non_null(f);
	assert_int_equal(ftruncate(fileno(f), 2 << 20), 0);
	fclose(f);
	assert_int_equal(ini_read(big, tables, &o->root, &o->report), -EFBIG);
	f = fopen(path, "w");
	assert_non_null(f);
	fputs("[lamp]\nfile = x.png\ncount = 900\n", f);
	fclose(f);
	o->said_count = 0;
	assert_int_equal(ini_read(path, tables, &o->root, &o->report), -EINVAL);
	assert_memory_equal(o->root.lamp.file, folder, strlen(folder));
	assert_string_equal(o->root.lamp.file + strlen(folder), "/x.png");
	assert_memory_equal(o->said[0], path, strlen(path));
	assert_string_equal(o->said[0] + strlen(path),
			    ":3: [lamp] count: is \"900\", expected a whole number 0..255 lamps");
	unlink(path);
	unlink(big);
	rmdir(folder);
	free(o);
}

TEST("nearest is near")
{
	static const char *const names[] = {"threshold", "transfer", "gain", "x", "y"};

	assert_string_equal(ini_nearest("treshold", names, 5), "threshold");
	assert_string_equal(ini_nearest("THRESHOLD", names, 5), "threshold");
	assert_string_equal(ini_nearest("gian", names, 5), "gain");
	assert_string_equal(ini_nearest("tarnsfer", names, 5), "transfer");
	assert_null(ini_nearest("q", names, 5));
	assert_null(ini_nearest("elephant", names, 5));
	assert_null(ini_nearest("", names, 5));
	assert_null(ini_nearest("gain", names, 0));
}
