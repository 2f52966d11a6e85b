/* SPDX-License-Identifier: MIT */
/* Files of measured light that the configuration names: read, counted, and watched for changes. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/kiosk/reload.h"
#include "app/pipeline/pipeline_config.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static const struct config_driver none[] = {{NULL, NULL, 0}};
static const struct config_drivers drivers = {{none, none, none}};
static char path[80];

static int make_folder(void **state)
{
	if (own_folder_make(state))
		return -1;
	snprintf(path, sizeof(path), "%.70s", own_folder_path("light.ini"));
	return 0;
}

#define POWER                                                                                      \
	"response = 0 .001 .004 .009 .016 .024 .035 .048 .063 .079 .098 .118 .141 .165 .191 .22 "  \
	".25 .282 .316 .353 .391 .431 .473 .517 .563 .61 .66 .712 .766 .821 .879 .938 1\n"

static void write_light(const char *text)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fprintf(file, "[light]\n%s", text);
	assert_int_equal(fclose(file), 0);
}

static struct config *read_config(const char *text, int expected, struct ini_report *report)
{
	struct config *config;

	assert_int_equal(config_create(&config, &drivers), 0);
	assert_int_equal(config_read_memory(config, text, strlen(text), "k.conf", report), 0);
	assert_int_equal(config_read_files(config, report), expected);
	return config;
}

TEST("what is measured goes first")
{
	struct ini_report report = {.count = 0};
	struct pipeline_settings settings;
	struct config *config;
	char text[512];

	snprintf(text, sizeof(text),
		 "[fisheye]\nlight = %s\ntransfer = bt709\nblack_level = 9\ngain = 3\n"
		 "[background]\nlight = %s\n",
		 path, path);
	write_light("gain = 2.5\ncolours = 1 0 0 0 2 0 0 0 1\n");
	config = read_config(text, 0, &report);
	settings = pipeline_settings_of(config);
	assert_true(settings.sampler.gain == 2.5);
	assert_true(settings.sampler.colours[4] == 2);
	assert_false(settings.sampler.curve.measured);
	assert_int_equal(settings.sampler.curve.named, TRANSFER_BT709);
	assert_true(settings.sampler.curve.black == 9);
	config_destroy(config);
	write_light("black_level = 16.5\n" POWER);
	config = read_config(text, 0, &report);
	settings = pipeline_settings_of(config);
	assert_true(settings.sampler.gain == 3 && settings.sampler.colours[4] == 0);
	assert_true(settings.sampler.curve.measured && settings.sampler.curve.black == 16.5);
	assert_true(settings.background.measured && settings.background.black == 16.5);
	config_destroy(config);
	config = read_config("[fisheye]\ngain = 3\n", 0, &report);
	settings = pipeline_settings_of(config);
	assert_false(settings.background.measured);
	assert_true(settings.background.black == 0 && settings.sampler.gain == 3);
	config_destroy(config);
	unlink(path);
}

TEST("faults name the file")
{
	struct ini_report report = {.count = 0};
	char text[256];

	snprintf(text, sizeof(text), "[background]\nlight = %s\n", path);
	write_light("gain = loud\nblack_level = 300\n");
	config_destroy(read_config(text, -EINVAL, &report));
	assert_int_equal(report.count, 2);
	assert_non_null(strstr(report.first.text, "light.ini:2: [light] gain"));
	unlink(path);
	report.count = 0;
	config_destroy(read_config(text, -ENOENT, &report));
	assert_int_equal(report.count, 1);
}

/* The file changes under its name: a reload reads it again. */
TEST("a reload sees another file")
{
	struct ini_report report = {.count = 0};
	struct config *config, *fresh;
	char text[256];

	snprintf(text, sizeof(text), "[fisheye]\nlight = %s\n", path);
	write_light("gain = 2\n");
	config = read_config(text, 0, &report);
	fresh = read_config(text, 0, &report);
	assert_int_equal(reload_compare(config, fresh), 0);
	config_destroy(fresh);
	write_light("gain = 4\n");
	fresh = read_config(text, 0, &report);
	assert_true(reload_compare(config, fresh) & RELOAD_LIGHT);
	reload_adopt(config, fresh);
	config_destroy(fresh);
	assert_true(pipeline_settings_of(config).sampler.gain == 4);
	snprintf(text, sizeof(text), "[background]\nlight = %s\n", path);
	write_light("black_level = 20\n");
	fresh = read_config(text, 0, &report);
	assert_true(reload_compare(config, fresh) & RELOAD_PIPELINE);
	reload_adopt(config, fresh);
	config_destroy(fresh);
	assert_true(pipeline_settings_of(config).background.black == 20);
	assert_true(pipeline_settings_of(config).sampler.gain == 1);
	config_destroy(config);
	unlink(path);
}

TEST_GROUP(make_folder, own_folder_remove);
