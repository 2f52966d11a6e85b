#include "app/stats.h"

#include <errno.h>
#include <string.h>

#include "hal/clock.h"
#include "hal/log.h"

static const char *const stage_names[] = {"decode", "sample", "composite", "show"};

_Static_assert(sizeof(stage_names) / sizeof(*stage_names) == STAGE_COUNT, "a name for each stage");

int stats_open(struct stats *stats, const char *path, struct fault *fault)
{
	int err;

	*stats = (struct stats){.path = path};
	if (!path)
		return 0;
	stats->stream = fopen(path, "we");
	if (stats->stream) {
		setvbuf(stats->stream, stats->buffer, _IOFBF, sizeof(stats->buffer));
		return 0;
	}
	err = -errno;
	return fault_say(fault, err, "%s: cannot write statistics: %s", path, strerror(-err));
}

void stats_start(struct stats *stats, int64_t now_ns)
{
	stats->start_ns = stats->line_ns = now_ns;
}

void stats_close(struct stats *stats)
{
	if (stats->stream)
		fclose(stats->stream);
	stats->stream = NULL;
}

void stats_made(struct stats *stats, const int64_t stage_ns[STAGE_COUNT])
{
	stats->made++;
	for (int i = 0; i < STAGE_COUNT; i++)
		stats->stage_ns[i] += stage_ns[i];
}

void stats_shown(struct stats *stats, int64_t latency_ns)
{
	stats->frames++;
	stats->line_frames++;
	stats->latency_sum_ns += latency_ns;
	if (latency_ns > stats->latency_max_ns)
		stats->latency_max_ns = latency_ns;
}

static double ms(int64_t ns)
{
	return (double)ns / NS_PER_MS;
}

static double mean_ms(int64_t sum_ns, uint64_t count)
{
	return count ? ms(sum_ns) / (double)count : 0;
}

static double largest(const double v[3])
{
	double m = v[0] > v[1] ? v[0] : v[1];

	return m > v[2] ? m : v[2];
}

static void write_cameras(FILE *stream, const struct source *sources, int count)
{
	fputs(",\"cameras\":[", stream);
	for (int i = 0; i < count; i++) {
		struct source_counts counts = source_counts(&sources[i]);

		fprintf(stream,
			"%s{\"name\":\"%s\",\"situation\":\"%s\",\"frames\":%llu,\"lost\":%llu,"
			"\"broken\":%llu}",
			i ? "," : "", sources[i].settings.name,
			camera_situation_names[sources[i].camera.situation],
			(unsigned long long)counts.frames, (unsigned long long)counts.lost,
			(unsigned long long)counts.broken);
	}
	fputs("]}\n", stream);
}

static uint64_t dropped(const struct source *sources, int count)
{
	uint64_t sum = 0;

	for (int i = 0; i < count; i++)
		sum += source_counts(&sources[i]).lost;
	return sum;
}

static void write_line(const struct stats *s, int64_t now_ns, const struct pipeline *pipeline,
		       const struct source *sources, int source_count)
{
	double seconds = (double)(now_ns - s->line_ns) / NS_PER_S;

	fprintf(s->stream, "{\"t\":%.3f,\"frames\":%llu,\"fps\":%.2f,\"drops\":%llu",
		(double)(now_ns - s->start_ns) / NS_PER_S, (unsigned long long)s->frames,
		seconds > 0 ? (double)s->line_frames / seconds : 0,
		(unsigned long long)dropped(sources, source_count));
	fprintf(s->stream, ",\"latency_ms\":{\"mean\":%.3f,\"max\":%.3f},\"stage_ms\":{",
		mean_ms(s->latency_sum_ns, s->line_frames), ms(s->latency_max_ns));
	for (int i = 0; i < STAGE_COUNT; i++)
		fprintf(s->stream, "%s\"%s\":%.3f", i ? "," : "", stage_names[i],
			mean_ms(s->stage_ns[i], s->made));
	fprintf(s->stream,
		"},\"lights_used\":%d,\"lights\":%d,\"threshold\":%g,\"dropped_error\":%.6g,"
		"\"clipped\":%.6f",
		pipeline->selection.used_count, pipeline->selection.count,
		pipeline->choice.threshold, largest(pipeline->selection.dropped_error),
		pipeline->clipped);
	write_cameras(s->stream, sources, source_count);
}

void stats_line(struct stats *stats, int64_t now_ns, const struct pipeline *pipeline,
		const struct source *sources, int source_count)
{
	if (stats->stream) {
		write_line(stats, now_ns, pipeline, sources, source_count);
		if (fflush(stats->stream) || ferror(stats->stream)) {
			log_error("%s: cannot write statistics: %s", stats->path, strerror(errno));
			stats_close(stats);
		}
	}
	stats->line_ns = now_ns;
	stats->line_frames = stats->made = 0;
	stats->latency_sum_ns = stats->latency_max_ns = 0;
	memset(stats->stage_ns, 0, sizeof(stats->stage_ns));
}
