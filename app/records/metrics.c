/* SPDX-License-Identifier: MIT */
#include "app/records/metrics.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/records/supply.h"
#include "hal/base/clock.h"
#include "hal/base/fault.h"
#include "hal/base/log.h"

#define ZONES_MAX 32
/* The exporter collects FILE.prom and passes over other names. */
#define TEMPORARY ".new"

/* ---- text ---- */

struct sheet {
	char *text;
	size_t length;
};

/* Adds a line, or nothing if it does not fit. */
__attribute__((format(printf, 2, 3))) static void sheet_add(struct sheet *s, const char *format,
							    ...)
{
	const size_t room = METRICS_TEXT_MAX - s->length;
	va_list args;
	int length;

	va_start(args, format);
	length = vsnprintf(s->text + s->length, room, format, args);
	va_end(args);
	if (length >= 0 && (size_t)length < room)
		s->length += (size_t)length;
	s->text[s->length] = '\0';
}

static void sheet_head(struct sheet *s, const char *name, const char *type, const char *help)
{
	sheet_add(s, "# HELP inlay_%s %s\n# TYPE inlay_%s %s\n", name, help, name, type);
}

static void sheet_figure(struct sheet *s, const char *name, const char *type, double value,
			 const char *help)
{
	sheet_head(s, name, type, help);
	sheet_add(s, "inlay_%s %.10g\n", name, value);
}

/* Writes a label's value: backslash, quotation mark and line break are escaped, other control
 * characters are left out. */
static void label_of(const char *value, char label[128])
{
	size_t used = 0;

	for (; *value && used < 124; value++) {
		if (*value == '\\' || *value == '"')
			label[used++] = '\\';
		if ((unsigned char)*value >= ' ')
			label[used++] = *value;
	}
	label[used] = '\0';
}

/* ---- figures ---- */

enum camera_figure { FINE, FRAMES, LOST, BROKEN, LOSSES, UNSETTLED, CAMERA_FIGURES };

static const struct {
	const char *name, *type, *help;
} camera_heads[CAMERA_FIGURES] = {
	[FINE] = {"camera_fine", "gauge", "Whether the camera works; its situation is a label."},
	[FRAMES] = {"camera_frames_total", "counter", "Frames that the camera gave."},
	[LOST] = {"camera_lost_frames_total", "counter", "Frames that were not used."},
	[BROKEN] = {"camera_broken_frames_total", "counter", "Frames that were damaged."},
	[LOSSES] = {"camera_losses_total", "counter", "How often the camera was lost."},
	[UNSETTLED] = {"camera_unsettled_frames_total", "counter",
		       "Pictures left out of the light, as the camera had just been opened."},
};

static uint64_t figure_of(const struct source *source, enum camera_figure figure)
{
	const struct source_counts counts = source_counts(source);

	switch (figure) {
	case FINE:
		return source->opening.situation == CAMERA_FINE;
	case FRAMES:
		return counts.frames;
	case LOST:
		return counts.lost;
	case BROKEN:
		return counts.broken;
	case LOSSES:
		return source->counts.losses;
	default:
		return source->settling.left_out;
	}
}

static void add_cameras(struct sheet *s, const struct source *sources, int count)
{
	for (int figure = 0; figure < CAMERA_FIGURES; figure++) {
		sheet_head(s, camera_heads[figure].name, camera_heads[figure].type,
			   camera_heads[figure].help);
		for (int i = 0; i < count; i++) {
			const char *situation =
				camera_situation_names[sources[i].opening.situation];

			sheet_add(s, "inlay_%s{camera=\"%s\"%s%s%s} %llu\n",
				  camera_heads[figure].name, sources[i].settings.name,
				  figure == FINE ? ",situation=\"" : "",
				  figure == FINE ? situation : "", figure == FINE ? "\"" : "",
				  (unsigned long long)figure_of(&sources[i], figure));
		}
	}
}

static void add_pictures(struct sheet *s, const struct stats *stats)
{
	sheet_figure(s, "frames_total", "counter", (double)stats->frames,
		     "Pictures that reached the screen.");
	sheet_figure(s, "late_frames_total", "counter", (double)stats->late_total,
		     "Pictures that were later than a frame and the work on them.");
	sheet_head(s, "latency_seconds", "summary", "From capture to screen.");
	sheet_add(s, "inlay_latency_seconds_sum %.6f\ninlay_latency_seconds_count %llu\n",
		  (double)stats->latency_total_ns / NS_PER_S,
		  (unsigned long long)stats->timed_total);
	sheet_figure(s, "latency_max_seconds", "gauge", (double)stats->latency_peak_ns / NS_PER_S,
		     "The longest since the file before.");
}

static void add_light(struct sheet *s, const struct pipeline_report *report)
{
	sheet_figure(s, "lights", "gauge", report->lights, "Lights of the basis.");
	sheet_figure(s, "lights_used", "gauge", report->lights_used, "Lights in use.");
	sheet_figure(s, "sky_clipped_ratio", "gauge", report->clipped,
		     "Share of the sky where the fisheye is at its limit.");
}

static void add_temperatures(struct sheet *s, const char *sysfs)
{
	char millidegrees[64], type[64], label[128];
	bool begun = false;
	int value;

	for (int zone = 0; zone < ZONES_MAX; zone++) {
		/* A zone that is off answers with an error. */
		if (!supply_line(millidegrees, "%s/class/thermal/thermal_zone%d/temp", sysfs,
				 zone) ||
		    sscanf(millidegrees, "%d", &value) != 1)
			continue;
		if (!supply_line(type, "%s/class/thermal/thermal_zone%d/type", sysfs, zone))
			*type = '\0';
		label_of(type, label);
		if (!begun)
			sheet_head(s, "temperature_celsius", "gauge", "Of the kernel's zones.");
		begun = true;
		sheet_add(s, "inlay_temperature_celsius{zone=\"%d\",type=\"%s\"} %.3f\n", zone,
			  label, value / 1000.0);
	}
}

static void add_supply(struct sheet *s, const char *sysfs)
{
	const struct supply supply = supply_read(sysfs);

	if (!supply.told)
		return;
	sheet_head(s, "undervoltage", "gauge", "Whether the power supply's voltage is too low.");
	sheet_add(s,
		  "inlay_undervoltage{when=\"now\"} %d\ninlay_undervoltage{when=\"before\"} %d\n",
		  supply.undervoltage, supply.undervoltage_before);
	sheet_head(s, "throttled", "gauge", "Whether the processor is slowed down.");
	sheet_add(s, "inlay_throttled{when=\"now\"} %d\ninlay_throttled{when=\"before\"} %d\n",
		  supply.throttled, supply.throttled_before);
}

size_t metrics_text(const struct metrics_facts *facts, char text[METRICS_TEXT_MAX])
{
	struct sheet s = {.text = text};

	sheet_head(&s, "info", "gauge", "The version that runs.");
	sheet_add(&s, "inlay_info{version=\"%s\"} 1\n", INLAY_VERSION);
	sheet_figure(&s, "uptime_seconds", "gauge", facts->stats->last.t_s, "Since the start.");
	sheet_figure(&s, "rest", "gauge", facts->resting,
		     "Whether it rests outside of its screen's hours.");
	sheet_head(&s, "screen_fine", "gauge",
		   "Whether the screen shows pictures; its situation is a label.");
	sheet_add(&s, "inlay_screen_fine{situation=\"%s\"} %d\n", facts->screen,
		  facts->screen_is_fine);
	add_pictures(&s, facts->stats);
	add_light(&s, facts->report);
	add_cameras(&s, facts->sources, facts->source_count);
	add_temperatures(&s, facts->sysfs);
	add_supply(&s, facts->sysfs);
	return s.length;
}

/* ---- file ---- */

static int write_all(int file, const char *text, size_t length)
{
	for (size_t done = 0; done < length;) {
		const ssize_t bytes = write(file, text + done, length - done);

		if (bytes < 0)
			return -errno;
		done += (size_t)bytes;
	}
	/* The exporter runs as another user, whatever this one's umask is. */
	return fchmod(file, 0644) ? -errno : 0;
}

static int replace_file(const char *path, const char *text, size_t length)
{
	char temporary[PATH_MAX];
	struct stat about;
	int file, err;

	/* A device or a pipe would be replaced for whoever reads it. */
	if (lstat(path, &about) == 0 && !S_ISREG(about.st_mode) && !S_ISLNK(about.st_mode))
		return S_ISDIR(about.st_mode) ? -EISDIR : -EEXIST;
	if ((size_t)snprintf(temporary, sizeof(temporary), "%s" TEMPORARY, path) >=
	    sizeof(temporary))
		return -ENAMETOOLONG;
	/* Whatever has this name, a link or a pipe, makes room. */
	if (unlink(temporary) && errno != ENOENT)
		return -errno;
	file = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
	if (file < 0)
		return -errno;
	err = write_all(file, text, length);
	close(file);
	if (!err && rename(temporary, path))
		err = -errno;
	if (err)
		unlink(temporary);
	return err;
}

bool metrics_write(struct metrics *metrics, const char *path, const struct metrics_facts *facts,
		   int64_t now_ns)
{
	char text[METRICS_TEXT_MAX];
	int err;

	if (!*path ||
	    (metrics->written_ns && now_ns - metrics->written_ns < METRICS_EVERY_S * NS_PER_S))
		return false;
	metrics->written_ns = now_ns;
	err = replace_file(path, text, metrics_text(facts, text));
	if (err && !metrics->failed)
		log_warning("%s: metrics cannot be written: %s", path, strerror(-err));
	else if (!err && metrics->failed)
		log_info("%s: metrics are written again", path);
	metrics->failed = err != 0;
	return !err;
}
