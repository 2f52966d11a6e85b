/* SPDX-License-Identifier: MIT */
/* The text file for Prometheus' node exporter: its format, its figures, and how it is replaced. */
#include <ctype.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/records/records.h"
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

static struct metrics_facts facts_of(void)
{
	return (struct metrics_facts){.stats = &stats,
				      .report = &report,
				      .sources = sources,
				      .source_count = 2,
				      .screen = "off",
				      .resting = true,
				      .sysfs = "/nowhere"};
}

/* What metrics_print() writes; the caller frees it. */
static char *printed(void)
{
	const struct metrics_facts facts = facts_of();
	char *text = NULL;
	size_t length;
	FILE *stream = open_memstream(&text, &length);

	assert_non_null(stream);
	metrics_print(&facts, stream);
	assert_int_equal(fclose(stream), 0);
	return text;
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
};

TEST("figures are told")
{
	char *text = printed();

	for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++) {
		char line[256];

		snprintf(line, sizeof(line), "\n%s\n", lines[i]);
		if (!strstr(text, line))
			fail_msg("no line \"%s\" in\n%s", lines[i], text);
	}
	free(text);
}

/* Each figure follows its HELP and TYPE, each name has one of them, and each line ends. */
TEST("the format is prometheus")
{
	char *text = printed(), head[64] = "", type[64], name[64], *rest = NULL;
	int count = 0;

	assert_true(*text);
	assert_int_equal(text[strlen(text) - 1], '\n');
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
	free(text);
}

static ino_t number_of(const char *path)
{
	struct stat file;

	return stat(path, &file) ? 0 : file.st_ino;
}

TEST("the file is replaced every 15 s")
{
	const struct metrics_facts facts = facts_of();
	struct metrics metrics = {.written_ns = 0};
	char path[1024];
	struct stat file;
	ino_t first;

	snprintf(path, sizeof(path), "%s", own_folder_path("inlay.prom"));
	assert_false(metrics_write(&metrics, "", &facts, 1));
	umask(0077);
	assert_true(metrics_write(&metrics, path, &facts, 1));
	umask(0022);
	first = number_of(path);
	assert_int_equal(stat(path, &file), 0);
	assert_int_equal(file.st_mode & 0777, 0644);
	assert_false(metrics_write(&metrics, path, &facts, 15 * NS_PER_S));
	assert_int_equal(number_of(path), first);
	assert_true(metrics_write(&metrics, path, &facts, 15 * NS_PER_S + 1));
	assert_int_not_equal(number_of(path), first);
	unlink(path);
}

TEST("a failure is said once")
{
	const struct metrics_facts facts = facts_of();
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
	assert_non_null(strstr(text, "inlay.prom: cannot be written: No such file"));
	assert_non_null(strstr(text, "inlay.prom is written again\n"));
	assert_null(strstr(strstr(text, "cannot") + 1, "cannot"));
	assert_null(strstr(strstr(text, "again") + 1, "again"));
}

static void put_file(const char *folder, const char *name, const char *text)
{
	char path[2048];
	FILE *file;

	snprintf(path, sizeof(path), "%s/%s", own_folder(), folder);
	for (char *slash = path + strlen(own_folder()) + 1; slash; slash = strchr(slash + 1, '/')) {
		const char was = *slash;

		*slash = was == '/' ? '\0' : was;
		(void)mkdir(path, 0700);
		*slash = was;
	}
	(void)mkdir(path, 0700);
	snprintf(path, sizeof(path), "%s/%s/%s", own_folder(), folder, name);
	file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

/* The firmware goes before the monitor of the voltage, which tells whatever its number is. */
TEST("a Raspberry Pi tells of its supply")
{
	const char *const firmware = "devices/platform/soc/soc:firmware";
	char command[1200];
	struct supply supply;

	assert_false(supply_read("/nowhere").told);
	put_file("class/hwmon/hwmon0", "name", "cpu_thermal\n");
	put_file("class/hwmon/hwmon0", "in0_lcrit_alarm", "0\n");
	put_file("class/hwmon/hwmon2", "name", "rpi_volt\n");
	put_file("class/hwmon/hwmon2", "in0_lcrit_alarm", "1\n");
	assert_true(supply_read(own_folder()).undervoltage);
	put_file(firmware, "get_throttled", "50001\n");
	supply = supply_read(own_folder());
	assert_true(supply.undervoltage && supply.undervoltage_before);
	assert_true(!supply.throttled && supply.throttled_before);
	snprintf(command, sizeof(command), "rm -r '%s'/class '%s'/devices", own_folder(),
		 own_folder());
	assert_int_equal(system(command), 0);
}

TEST("a pipe is not replaced")
{
	const struct metrics_facts facts = facts_of();
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
