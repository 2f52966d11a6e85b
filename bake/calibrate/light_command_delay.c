/* SPDX-License-Identifier: MIT */
/* inlay-calibrate light delay. */
#include <errno.h>
#include <stdio.h>

#include "bake/calibrate/light_commands.h"
#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/response/light_delay.h"
#include "bake/calibrate/response/light_report.h"
#include "hal/base/clock.h"

#define CHANGES 8
#define FRAMES_EACH 24	/* after each change, and before the first */
#define FRAMES_FIRST 30 /* skipped after the first exposure is set */
#define TIMEOUT_MS 3000

static double mean_level(const struct image *picture)
{
	const size_t count = 3 * (size_t)picture->width * (size_t)picture->height;
	uint64_t sum = 0;

	for (size_t k = 0; k < count; k++)
		sum += picture->u8[k];
	return (double)sum / (double)count;
}

/* Takes the next frames, into the record unless it is NULL. */
static int record_frames(struct live *live, int count, struct image *picture,
			 struct light_record *record, struct fault *fault)
{
	for (int k = 0; k < count; k++) {
		int64_t captured;
		int err = live_next(live, TIMEOUT_MS, picture, &captured, fault);

		if (!err && record)
			err = light_record_frame(record, (double)captured / 1e6,
						 mean_level(picture));
		if (err)
			return err;
	}
	return 0;
}

static int alternate_control(struct live *live, const struct light_job *job, struct image *picture,
			     struct light_record *record, struct fault *fault)
{
	int err = live_control(live, job->control[0], fault);

	if (!err)
		err = record_frames(live, FRAMES_FIRST, picture, NULL, fault);
	if (!err)
		err = record_frames(live, FRAMES_EACH, picture, record, fault);
	for (int k = 1; !err && k <= CHANGES; k++) {
		err = light_record_change(record, (double)clock_now_ns() / 1e6);
		if (!err)
			err = live_control(live, job->control[k % 2], fault);
		if (!err)
			err = record_frames(live, FRAMES_EACH, picture, record, fault);
	}
	return err;
}

static int record_live(const struct light_job *job, struct light_record *record,
		       struct fault *fault)
{
	struct image picture = {.width = 0};
	struct live *live;
	int err = live_open(&live, job->config, (enum live_view)job->view, fault);

	if (err)
		return err;
	err = alternate_control(live, job, &picture, record, fault);
	image_free(&picture);
	live_close(live);
	return err;
}

int light_check_delay(const struct light_job *job, struct fault *fault)
{
	if (job->config ? !job->file_count && job->controls == 2
			: job->file_count == 1 && !job->controls)
		return 0;
	return fault_say(fault, -EINVAL,
			 "expected a record of frames and changes, or --config and two --control");
}

int light_command_delay(const struct light_job *job, struct fault *fault)
{
	struct light_record record = {.frames = 0};
	struct light_delay found = {.frames = 0};
	char text[16], comment[256];
	int err;

	err = job->config ? record_live(job, &record, fault)
			  : light_record_read(&record, job->files[0], fault);
	if (!err)
		err = light_delay_find(&found, &record, fault);
	if (!err) {
		printf("delay %d frames, %.1f ms (deviation %.1f, %.1f to %.1f); %d of %d changes "
		       "seen, correlation %.3f\n",
		       found.frames, found.time_ms, found.deviation_ms, found.shortest_ms,
		       found.longest_ms, found.seen, record.changes, found.correlation);
		if (job->report)
			err = light_report_delay(job->report, &found, fault);
	}
	light_record_free(&record);
	if (err)
		return err;
	snprintf(comment, sizeof(comment), "delay: %d frames, %.1f ms (deviation %.1f ms)",
		 found.frames, found.time_ms, found.deviation_ms);
	snprintf(text, sizeof(text), "%d", found.frames);
	return light_conclude(job, &found.verdict, "delay", text, comment, fault);
}
