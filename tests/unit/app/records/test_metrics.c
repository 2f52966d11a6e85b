/* SPDX-License-Identifier: MIT */
/* The text file for Prometheus' node exporter: its format, its figures, and how it is replaced. */
#include <ctype.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/records/metrics.h"
#include "app/records/supply.h"
#include "hal/base/clock.h"
#include "tests/support/captured_log.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static struct stats stats = {.frames = 123456789,
			     .late_total = 7,
			     .timed_total = 1000,
			     .latency_total_ns = 32500 * NS_PER_MS,
			     .latency_peak_ns = 81 * NS_PER_MS,
			     .last = {.t_s = 86400.5}};
static struct pipeline_report report = {.lights = 406, .lights_used = 32, .clipped = 0.25};
static struct source sources[2] = {
	{.settings = {.name = "sky"},
	 .counts.superseded = 2,
	 .counts.undecodable = 1,
	 .counts.losses = 3,
	 .settling = {.left_out = 9},
	 .camera = {.frames = 10, .lost = 3, .broken = 4}},
	{.settings = {.name = "front"}, .opening.situation = CAMERA_STALLED},
};

static struct metrics_facts facts_of(const char *sysfs)
{
	return (struct metrics_facts){.stats = &stats,
				      .report = &report,
				      .sources = sources,
				      .source_count = 2,
				      .screen = "off",
				      .resting = true,
				      .sysfs = sysfs};
}

static void put_file(const char *folder, const char *name, const char *text)
{
	char path[2048];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", folder, name);
	file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void make_folders(const char *path)
{
	char command[1200];

	snprintf(command, sizeof(command), "mkdir -p '%s/%s'", own_folder(), path);
	assert_int_equal(system(command), 0);
}

static const char *const lines[] = {
	"# TYPE inlay_frames_total counter",
	"inlay_info{version=\"" INLAY_VERSION "\"} 1",
	"inlay_uptime_seconds 86400.5",
	"inlay_rest 1",
	"inlay_screen_fine{situation=\"off\"} 0",
	"inlay_frames_total 123456789",
	"inlay_late_frames_total 7",
	"# TYPE inlay_latency_seconds summary",
	"inlay_latency_seconds_sum 32.500000",
	"inlay_latency_seconds_count 1000",
	"inlay_latency_max_seconds 0.081",
	"inlay_lights 406",
	"inlay_lights_used 32",
	"inlay_sky_clipped_ratio 0.25",
	"inlay_camera_fine{camera=\"sky\",situation=\"fine\"} 1",
	"inlay_camera_fine{camera=\"front\",situation=\"stalled\"} 0",
	"inlay_camera_frames_total{camera=\"sky\"} 10",
	"inlay_camera_lost_frames_total{camera=\"sky\"} 5",
	"inlay_camera_broken_frames_total{camera=\"sky\"} 5",
	"inlay_camera_losses_total{camera=\"sky\"} 3",
	"inlay_camera_unsettled_frames_total{camera=\"sky\"} 9",
	"inlay_camera_unsettled_frames_total{camera=\"front\"} 0",
	"inlay_temperature_celsius{zone=\"0\",type=\"cpu \\\"big\\\\\"} 48.500",
	"inlay_temperature_celsius{zone=\"3\",type=\"\"} -2.000",
	"inlay_undervoltage{when=\"now\"} 1",
	"inlay_undervoltage{when=\"before\"} 1",
	"inlay_throttled{when=\"now\"} 0",
	"inlay_throttled{when=\"before\"} 1",
};

/* Zone 1 has no temperature at present, zone 2 is not there. */
TEST("figures are told")
{
	char text[METRICS_TEXT_MAX], folder[1024], zone[2200];
	struct metrics_facts facts;
	size_t length;

	snprintf(folder, sizeof(folder), "%s", own_folder());
	make_folders("class/thermal");
	make_folders("devices/platform/soc/soc:firmware");
	put_file(own_folder(), "devices/platform/soc/soc:firmware/get_throttled", "50001\n");
	for (int i = 0; i <= 3; i++) {
		snprintf(zone, sizeof(zone), "%s/class/thermal/thermal_zone%d", folder, i);
		if (i == 2)
			continue;
		assert_int_equal(mkdir(zone, 0700), 0);
		put_file(zone, "temp", i == 0 ? "48500\n" : i == 1 ? "" : "-2000\n");
		if (i == 0)
			put_file(zone, "type", "cpu \"big\\\n");
	}
	facts = facts_of(folder);
	length = metrics_text(&facts, text);
	assert_int_equal(length, strlen(text));
	for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++) {
		char line[256];

		snprintf(line, sizeof(line), "\n%s\n", lines[i]);
		if (!strstr(text, line))
			fail_msg("no line \"%s\" in\n%s", lines[i], text);
	}
	assert_null(strstr(text, "zone=\"1\""));
	snprintf(zone, sizeof(zone), "rm -r '%s'/class '%s'/devices", folder, folder);
	assert_int_equal(system(zone), 0);
}

/* Where the firmware is silent the monitor of the voltage tells, whatever its number is. */
TEST("the monitor tells of the voltage")
{
	char command[1200];

	make_folders("class/hwmon/hwmon0");
	make_folders("class/hwmon/hwmon2");
	put_file(own_folder(), "class/hwmon/hwmon0/name", "cpu_thermal\n");
	put_file(own_folder(), "class/hwmon/hwmon0/in0_lcrit_alarm", "0\n");
	put_file(own_folder(), "class/hwmon/hwmon2/name", "rpi_volt\n");
	put_file(own_folder(), "class/hwmon/hwmon2/in0_lcrit_alarm", "1\n");
	assert_true(supply_read(own_folder()).undervoltage);
	put_file(own_folder(), "class/hwmon/hwmon2/in0_lcrit_alarm", "0\n");
	assert_true(supply_read(own_folder()).told);
	assert_false(supply_read(own_folder()).undervoltage);
	assert_false(supply_read("/nowhere").told);
	snprintf(command, sizeof(command), "rm -r '%s'/class", own_folder());
	assert_int_equal(system(command), 0);
}

/* Each figure follows its HELP and TYPE, each name has one of them, and each line ends. */
TEST("the format is prometheus")
{
	char text[METRICS_TEXT_MAX], head[64] = "", type[64], name[64], *rest = NULL;
	struct metrics_facts facts = facts_of("/nowhere");
	int count = 0;

	assert_true(metrics_text(&facts, text) > 0);
	assert_int_equal(text[strlen(text) - 1], '\n');
	assert_null(strstr(text, "temperature"));
	assert_null(strstr(text, "undervoltage"));
	for (char *line = strtok_r(text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
		if (!strncmp(line, "# HELP ", 7)) {
			assert_int_equal(sscanf(line, "# HELP %63s", head), 1);
			line = strtok_r(NULL, "\n", &rest);
			assert_int_equal(sscanf(line, "# TYPE %63s %63s", name, type), 2);
			assert_string_equal(name, head);
			continue;
		}
		assert_int_equal(sscanf(line, "%63[a-z_]", name), 1);
		if (strncmp(name, head, strlen(head)) != 0)
			fail_msg("\"%s\" below %s", line, head);
		assert_non_null(strrchr(line, ' '));
		assert_true(isdigit((unsigned char)strrchr(line, ' ')[1]));
		count++;
	}
	assert_int_equal(count, 12 + 12);
}

static ino_t number_of(const char *path)
{
	struct stat file;

	return stat(path, &file) ? 0 : file.st_ino;
}

TEST("the file is replaced every 15 s")
{
	const struct metrics_facts facts = facts_of("/nowhere");
	struct metrics metrics = {.written_ns = 0};
	char path[1024], temporary[1040];
	struct stat file;
	ino_t first;

	snprintf(path, sizeof(path), "%s", own_folder_path("inlay.prom"));
	snprintf(temporary, sizeof(temporary), "%s.new", path);
	/* What lies in its way, even a link to another's file. */
	assert_int_equal(symlink("/dev/full", temporary), 0);
	assert_false(metrics_write(&metrics, "", &facts, 1));
	umask(0077);
	assert_true(metrics_write(&metrics, path, &facts, 1));
	umask(0022);
	first = number_of(path);
	assert_int_equal(stat(path, &file), 0);
	assert_int_equal(file.st_mode & 0777, 0644);
	assert_int_equal(number_of(temporary), 0);
	assert_false(metrics_write(&metrics, path, &facts, 15 * NS_PER_S));
	assert_int_equal(number_of(path), first);
	assert_true(metrics_write(&metrics, path, &facts, 15 * NS_PER_S + 1));
	assert_int_not_equal(number_of(path), first);
	unlink(path);
}

TEST("a failure is said once")
{
	const struct metrics_facts facts = facts_of("/nowhere");
	struct metrics metrics = {.written_ns = 0};
	struct captured_log log = captured_log_begin();
	char path[1024], text[2000] = "";
	FILE *stream;

	snprintf(path, sizeof(path), "%s/later/inlay.prom", own_folder());
	for (int i = 1; i < 5; i++)
		assert_false(metrics_write(&metrics, path, &facts, i * 15 * NS_PER_S));
	assert_int_equal(mkdir(own_folder_path("later"), 0700), 0);
	for (int i = 5; i < 8; i++)
		assert_true(metrics_write(&metrics, path, &facts, i * 15 * NS_PER_S));
	stream = captured_log_end(&log);
	assert_true(fread(text, 1, sizeof(text) - 1, stream) > 0);
	fclose(stream);
	unlink(path);
	assert_int_equal(rmdir(own_folder_path("later")), 0);
	assert_non_null(strstr(text, "inlay.prom: metrics cannot be written: No such file"));
	assert_non_null(strstr(text, "inlay.prom: metrics are written again\n"));
	assert_null(strstr(strstr(text, "cannot") + 1, "cannot"));
	assert_null(strstr(strstr(text, "again") + 1, "again"));
}

TEST("a pipe is not replaced")
{
	const struct metrics_facts facts = facts_of("/nowhere");
	struct metrics metrics = {.written_ns = 0};
	struct captured_log log = captured_log_begin();
	const char *path = own_folder_path("pipe");
	struct stat about;

	assert_int_equal(mkfifo(path, 0600), 0);
	assert_false(metrics_write(&metrics, path, &facts, 15 * NS_PER_S));
	fclose(captured_log_end(&log));
	assert_int_equal(lstat(path, &about), 0);
	assert_true(S_ISFIFO(about.st_mode));
	unlink(path);
}

TEST_GROUP(own_folder_make, own_folder_remove);
