/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <sys/stat.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

static void print_head(FILE *s, const char *name, const char *type, const char *help)
{
	fprintf(s, "# HELP inlay_%s %s\n# TYPE inlay_%s %s\n", name, help, name, type);
}

static void print_figure(FILE *s, const char *name, const char *type, double value,
			 const char *help)
{
	print_head(s, name, type, help);
	fprintf(s, "inlay_%s %.10g\n", name, value);
}

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

static void print_cameras(FILE *s, const struct source *sources, int count)
{
	for (int figure = 0; figure < CAMERA_FIGURES; figure++) {
		print_head(s, camera_heads[figure].name, camera_heads[figure].type,
			   camera_heads[figure].help);
		for (int i = 0; i < count; i++) {
			const char *situation =
				camera_situation_names[sources[i].opening.situation];

			fprintf(s, "inlay_%s{camera=\"%s\"%s%s%s} %llu\n",
				camera_heads[figure].name, sources[i].settings.name,
				figure == FINE ? ",situation=\"" : "",
				figure == FINE ? situation : "", figure == FINE ? "\"" : "",
				(unsigned long long)figure_of(&sources[i], figure));
		}
	}
}

static void print_pictures(FILE *s, const struct stats *stats)
{
	print_figure(s, "frames_total", "counter", (double)stats->frames,
		     "Pictures that reached the screen.");
	print_figure(s, "late_frames_total", "counter", (double)stats->late_total,
		     "Pictures that were later than a frame and the work on them.");
	print_head(s, "latency_seconds", "summary", "From capture to screen.");
	fprintf(s, "inlay_latency_seconds_sum %.6f\ninlay_latency_seconds_count %llu\n",
		(double)stats->latency_total_ns / NS_PER_S, (unsigned long long)stats->timed_total);
	print_figure(s, "latency_max_seconds", "gauge", (double)stats->latency_peak_ns / NS_PER_S,
		     "The longest since the file before.");
}

static void print_light(FILE *s, const struct pipeline_report *report)
{
	print_figure(s, "lights", "gauge", report->lights, "Lights of the basis.");
	print_figure(s, "lights_used", "gauge", report->lights_used, "Lights in use.");
	print_figure(s, "sky_clipped_ratio", "gauge", report->clipped,
		     "Share of the sky where the fisheye is at its limit.");
}

static void print_supply(FILE *s, const char *sysfs)
{
	const struct supply supply = supply_read(sysfs);

	if (!supply.told)
		return;
	print_head(s, "undervoltage", "gauge", "Whether the power supply's voltage is too low.");
	fprintf(s, "inlay_undervoltage{when=\"now\"} %d\ninlay_undervoltage{when=\"before\"} %d\n",
		supply.undervoltage, supply.undervoltage_before);
	print_head(s, "throttled", "gauge", "Whether the processor is slowed down.");
	fprintf(s, "inlay_throttled{when=\"now\"} %d\ninlay_throttled{when=\"before\"} %d\n",
		supply.throttled, supply.throttled_before);
}

void metrics_print(const struct metrics_facts *facts, FILE *s)
{
	print_head(s, "info", "gauge", "The version that runs.");
	fprintf(s, "inlay_info{version=\"%s\"} 1\n", INLAY_VERSION);
	print_figure(s, "uptime_seconds", "gauge", facts->stats->last.t_s, "Since the start.");
	print_figure(s, "rest", "gauge", facts->resting,
		     "Whether it rests outside of its screen's hours.");
	print_head(s, "screen_fine", "gauge",
		   "Whether the screen shows pictures; its situation is a label.");
	fprintf(s, "inlay_screen_fine{situation=\"%s\"} %d\n", facts->screen,
		facts->screen_is_fine);
	print_pictures(s, facts->stats);
	print_light(s, facts->report);
	print_cameras(s, facts->sources, facts->source_count);
	print_supply(s, facts->sysfs);
}

static int write_file(const char *path, const struct metrics_facts *facts, struct fault *fault)
{
	struct output out;
	int err = output_open(&out, path, fault);

	if (err)
		return err;
	out.unsynced = true; /* the loop must not wait for a disk */
	metrics_print(facts, out.stream);
	/* The exporter runs as another user, whatever this one's umask is. */
	(void)fchmod(fileno(out.stream), 0644);
	return output_commit(&out, fault);
}

bool metrics_write(struct metrics *metrics, const char *path, const struct metrics_facts *facts,
		   int64_t now_ns)
{
	struct fault fault = {.text = ""};
	int err;

	if (!*path ||
	    (metrics->written_ns && now_ns - metrics->written_ns < METRICS_EVERY_S * NS_PER_S))
		return false;
	metrics->written_ns = now_ns;
	err = write_file(path, facts, &fault);
	if (err && !metrics->failed)
		log_warning("metrics: %s", fault.text);
	else if (!err && metrics->failed)
		log_info("metrics: %s is written again", path);
	metrics->failed = err != 0;
	return !err;
}
