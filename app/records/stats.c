/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"

static const char *const stage_names[] = {"decode", "sample", "people", "composite", "show"};

static const char *const look_names[] = {"exposure", "flicker", "noise", "neutral"};

_Static_assert(STATS_TEXT_MAX + 8 <= PIPE_BUF, "a pipe takes a line whole");
_Static_assert(sizeof(stage_names) / sizeof(*stage_names) == STAGE_COUNT, "a name for each stage");
_Static_assert(sizeof(look_names) / sizeof(*look_names) == PIPELINE_LOOKS, "a name for each part");

/* Non-blocking, because the reader of a pipe may be absent, slow or stopped. Appending, because
 * other programs may cut the file short meanwhile. */
static int stats_open_file(struct stats *stats, int flags)
{
	stats->file = open(
		stats->path,
		O_WRONLY | O_CREAT | O_APPEND | O_NONBLOCK | O_NOCTTY | O_CLOEXEC | flags, 0666);
	return stats->file < 0 ? -errno : 0;
}

static bool is_pipe(const char *path)
{
	struct stat about;

	return stat(path, &about) == 0 && S_ISFIFO(about.st_mode);
}

int stats_open(struct stats *stats, const char *path, struct fault *fault)
{
	int err;

	*stats = (struct stats){.path = path, .file = -1};
	err = path ? stats_open_file(stats, O_TRUNC) : 0;
	if (err == -ENXIO && is_pipe(path))
		err = 0; /* the pipe has no reader yet */
	if (!err)
		return 0;
	return fault_say(fault, err, "%s: cannot write statistics: %s", path, strerror(-err));
}

void stats_reopen(struct stats *stats)
{
	stats_close(stats);
}

void stats_start(struct stats *stats, int64_t now_ns)
{
	stats->start_ns = stats->line_ns = now_ns;
}

void stats_close(struct stats *stats)
{
	if (stats->path && stats->file >= 0)
		close(stats->file);
	stats->file = -1;
}

void stats_made(struct stats *stats, int64_t captured_ns, const int64_t stage_ns[STAGE_COUNT],
		const int64_t look_ns[PIPELINE_LOOKS])
{
	int64_t work_ns = 0;

	stats->made++;
	for (int i = 0; i < STAGE_COUNT; i++) {
		stats->stage_ns[i] += stage_ns[i];
		work_ns += stage_ns[i];
	}
	for (int i = 0; i < PIPELINE_LOOKS; i++)
		stats->look_ns[i] += look_ns[i];
	stats->flying[stats->next_flying].captured_ns = captured_ns;
	stats->flying[stats->next_flying].work_ns = work_ns;
	stats->next_flying = (stats->next_flying + 1) % STATS_IN_FLIGHT;
}

static int64_t work_on(const struct stats *stats, int64_t captured_ns)
{
	for (int i = 0; i < STATS_IN_FLIGHT; i++) {
		if (stats->flying[i].captured_ns == captured_ns)
			return stats->flying[i].work_ns;
	}
	return 0;
}

void stats_shown(struct stats *stats, int64_t captured_ns, int64_t shown_ns, int64_t period_ns)
{
	int64_t latency_ns = shown_ns - captured_ns;

	stats->frames++;
	stats->line_frames++;
	if (!captured_ns)
		return;
	stats->timed++;
	if (latency_ns > stats->latency_max_ns)
		stats->latency_max_ns = latency_ns;
	if (latency_ns > stats->latency_peak_ns)
		stats->latency_peak_ns = latency_ns;
	stats->latency_sum_ns += latency_ns;
	stats->latency_total_ns += latency_ns;
	stats->timed_total++;
	if (latency_ns > period_ns + work_on(stats, captured_ns)) {
		stats->late++;
		stats->late_total++;
	}
}

static double ms(int64_t ns)
{
	return (double)ns / NS_PER_MS;
}

static double mean_ms(int64_t sum_ns, uint64_t count)
{
	return count ? ms(sum_ns) / (double)count : 0;
}

/* Text that grows up to STATS_TEXT_MAX and no further. */
struct writing {
	char *text;
	size_t length;
};

__attribute__((format(printf, 2, 3))) static void append(struct writing *w, const char *format, ...)
{
	size_t room = STATS_TEXT_MAX - w->length;
	va_list args;
	int length;

	va_start(args, format);
	length = vsnprintf(w->text + w->length, room, format, args);
	va_end(args);
	w->length += length < 0 ? 0 : (size_t)length < room ? (size_t)length : room - 1;
}

static void append_cameras(struct writing *w, const struct source *sources, int count)
{
	append(w, ",\"cameras\":[");
	for (int i = 0; i < count; i++) {
		struct source_counts counts = source_counts(&sources[i]);
		const struct settling *settling = &sources[i].settling;

		append(w,
		       "%s{\"name\":\"%s\",\"situation\":\"%s\",\"frames\":%llu,\"lost\":%llu,\"broken\":%llu,\"losses\":%llu,\"settling\":%s,\"unsettled\":%llu}",
		       i ? "," : "", sources[i].settings.name,
		       camera_situation_names[sources[i].opening.situation],
		       (unsigned long long)counts.frames, (unsigned long long)counts.lost,
		       (unsigned long long)counts.broken,
		       (unsigned long long)sources[i].counts.losses,
		       settling->opening && !settling->settled ? "true" : "false",
		       (unsigned long long)settling->left_out);
	}
	append(w, "]");
}

static void append_lamp(struct writing *w, const struct coarse_lamp *lamp)
{
	if (lamp->there)
		append(w, ",\"coarse_lamp\":{\"azimuth\":%.1f,\"height\":%.1f,\"share\":%.3f}",
		       lamp->azimuth_deg, lamp->height_deg, lamp->share);
	else
		append(w, ",\"coarse_lamp\":null");
}

static void append_lamps_told(struct writing *w, const struct pipeline_report *report)
{
	const struct lamps_told *told = &report->told;

	append(w, ",\"lamps_missing\":[");
	for (int i = 0; report->missing_lamp[i]; i++)
		append(w, "%s\"%s\"", i ? "," : "", report->missing_lamp[i]);
	if (told->unnamed)
		append(w,
		       "],\"lamp_unnamed\":{\"azimuth\":%.1f,\"height\":%.1f,\"share\":%.3f,\"off\":%.3f}",
		       told->azimuth_deg, told->height_deg, told->share,
		       LAMPS_TOLD_OFF * told->share);
	else
		append(w, "],\"lamp_unnamed\":null");
}

uint64_t stats_drops(const struct source *sources, int source_count)
{
	uint64_t sum = 0;

	for (int i = 0; i < source_count; i++)
		sum += source_counts(&sources[i]).lost;
	return sum;
}

static void append_people(struct writing *w, const struct pipeline_people_seen *people)
{
	if (people->on)
		append(w,
		       ",\"people\":{\"learned\":%.3f,\"parts\":%d,\"in_front\":%d,\"sure\":%.2f,\"moved\":[%.1f,%.1f],\"lost\":%s}",
		       people->learned, people->parts, people->in_front, people->sure,
		       people->moved_px[0], people->moved_px[1], people->lost ? "true" : "false");
	else
		append(w, ",\"people\":null");
}

void stats_text(const struct stats *stats, const struct pipeline_report *report,
		const struct ini_level *threshold, const struct source *sources, int source_count,
		char text[STATS_TEXT_MAX])
{
	const struct stats_figures *last = &stats->last;
	struct writing w = {.text = text};

	append(&w, "\"t\":%.3f,\"frames\":%llu,\"fps\":%.2f,\"drops\":%llu", last->t_s,
	       (unsigned long long)stats->frames, last->fps,
	       (unsigned long long)stats_drops(sources, source_count));
	append(&w, ",\"latency_ms\":{\"mean\":%.3f,\"max\":%.3f},\"late\":%llu,\"stage_ms\":{",
	       last->latency_mean_ms, last->latency_max_ms, (unsigned long long)last->late);
	for (int i = 0; i < STAGE_COUNT; i++)
		append(&w, "%s\"%s\":%.3f", i ? "," : "", stage_names[i], last->stage_ms[i]);
	append(&w, "},\"look_ms\":{");
	for (int i = 0; i < PIPELINE_LOOKS; i++)
		append(&w, "%s\"%s\":%.4f", i ? "," : "", look_names[i], last->look_ms[i]);
	append(&w,
	       "},\"lights_used\":%d,\"lights\":%d,\"threshold\":%g,\"threshold_unit\":\"%s\","
	       "\"dropped_error\":%.6g,\"clipped\":%.6f,\"recovered\":\"%s\",\"exposures\":%d,\"unfit\":%llu,\"lines_lost\":%llu",
	       report->lights_used, report->lights, threshold->value,
	       threshold->percent ? "percent" : "grey level", report->dropped_error,
	       report->clipped,
	       !report->recovered ? "no"
	       : report->at_bound ? "in part"
				  : "yes",
	       report->exposures, (unsigned long long)report->unfit,
	       (unsigned long long)stats->lines_lost);
	append_lamp(&w, &report->lamp);
	append_lamps_told(&w, report);
	append_people(&w, &report->people);
	append_cameras(&w, sources, source_count);
}

static struct stats_figures line_figures(const struct stats *s, int64_t now_ns)
{
	double seconds = (double)(now_ns - s->line_ns) / NS_PER_S;
	struct stats_figures f = {
		.t_s = (double)(now_ns - s->start_ns) / NS_PER_S,
		.fps = seconds > 0 ? (double)s->line_frames / seconds : 0,
		.latency_mean_ms = mean_ms(s->latency_sum_ns, s->timed),
		.latency_max_ms = ms(s->latency_max_ns),
		.late = s->late,
	};

	for (int i = 0; i < STAGE_COUNT; i++)
		f.stage_ms[i] = mean_ms(s->stage_ns[i], s->made);
	for (int i = 0; i < PIPELINE_LOOKS; i++)
		f.look_ms[i] = mean_ms(s->look_ns[i], s->made);
	return f;
}

/* Removes the part of a line that a disk took before it was full. A pipe takes a line whole or not
 * at all. */
static int write_whole(int file, const char *text, size_t length)
{
	size_t done = 0;

	while (done < length) {
		const ssize_t written = write(file, text + done, length - done);
		const int err = -errno;
		const off_t end = written < 0 ? lseek(file, 0, SEEK_CUR) : 0;

		if (written < 0 && done && end >= (off_t)done)
			(void)!ftruncate(file, end - (off_t)done);
		if (written < 0)
			return err;
		done += (size_t)written;
	}
	return 0;
}

static void write_line(struct stats *stats, const struct pipeline_report *report,
		       const struct source *sources, int source_count)
{
	char text[STATS_TEXT_MAX], line[STATS_TEXT_MAX + 8];
	int err = stats->file < 0 ? stats_open_file(stats, 0) : 0;

	stats_text(stats, report, &report->threshold, sources, source_count, text);
	if (!err)
		err = write_whole(stats->file, line,
				  (size_t)snprintf(line, sizeof(line), "{%s}\n", text));
	if (!err)
		return;
	stats->lines_lost++;
	log_warning_once("%s: statistics cannot be written: %s; lines are left out", stats->path,
			 err == -EAGAIN || err == -ENXIO || err == -EPIPE ? "nobody reads them"
									  : strerror(-err));
}

void stats_line(struct stats *stats, int64_t now_ns, const struct pipeline_report *report,
		const struct source *sources, int source_count)
{
	stats->last = line_figures(stats, now_ns);
	if (stats->path)
		write_line(stats, report, sources, source_count);
	stats->line_ns = now_ns;
	stats->line_frames = stats->made = stats->timed = stats->late = 0;
	stats->latency_sum_ns = stats->latency_max_ns = 0;
	memset(stats->stage_ns, 0, sizeof(stats->stage_ns));
	memset(stats->look_ns, 0, sizeof(stats->look_ns));
}
