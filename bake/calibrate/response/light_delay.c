/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_delay.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/number.h"
#include "hal/base/text_file.h"

/* ---- records ---- */

static int grow_list(double **list, int count, int room)
{
	double *more;

	if (count < room)
		return room;
	room = room ? 2 * room : 256;
	more = realloc(*list, (size_t)room * sizeof(*more));
	if (!more)
		return -ENOMEM;
	*list = more;
	return room;
}

int light_record_frame(struct light_record *r, double time_ms, double level)
{
	const int times = grow_list(&r->time_ms, r->frames, r->room_frames);
	const int levels = grow_list(&r->level, r->frames, r->room_frames);

	if (times < 0 || levels < 0)
		return -ENOMEM;
	r->room_frames = times;
	r->time_ms[r->frames] = time_ms;
	r->level[r->frames++] = level;
	return 0;
}

int light_record_change(struct light_record *r, double time_ms)
{
	const int room = grow_list(&r->change_ms, r->changes, r->room_changes);

	if (room < 0)
		return room;
	r->room_changes = room;
	r->change_ms[r->changes++] = time_ms;
	return 0;
}

void light_record_free(struct light_record *r)
{
	free(r->time_ms);
	free(r->level);
	free(r->change_ms);
	memset(r, 0, sizeof(*r));
}

static bool is_blank_line(const char *text)
{
	text += strspn(text, " \t\r");
	return !*text || *text == '#';
}

/* Reads a number after blanks. */
static bool read_level(const char **text, double *number)
{
	*text += strspn(*text, " \t");
	return !number_read(text, number);
}

/* Reads a line. Returns 0; 1: the line is wrong; -ENOMEM. */
static int read_record_line(struct light_record *r, const char *line)
{
	double a, b;

	line += strspn(line, " \t");
	if (!strncmp(line, "change", 6)) {
		line += 6;
		if (!read_level(&line, &a) || !is_blank_line(line) ||
		    (r->changes && a <= r->change_ms[r->changes - 1]))
			return 1;
		return light_record_change(r, a);
	}
	if (!read_level(&line, &a) || !read_level(&line, &b) || !is_blank_line(line) ||
	    (r->frames && a <= r->time_ms[r->frames - 1]))
		return 1;
	return light_record_frame(r, a, b);
}

int light_record_read(struct light_record *r, const char *path, struct fault *fault)
{
	struct text_file file;
	int err = text_file_open(&file, path, fault);

	while (!err && (err = text_file_next(&file, fault)) > 0) {
		err = is_blank_line(file.line) ? 0 : read_record_line(r, file.line);
		if (err == 1)
			err = fault_say(fault, -EINVAL,
					"%s:%d: expected \"time_ms level\" of a frame or \"change "
					"time_ms\", later than those before it",
					path, file.number);
		else if (err)
			fault_say(fault, err, "%s: not enough memory", path);
	}
	text_file_close(&file);
	return err;
}

/* ---- delay ---- */

/* Index of the first frame captured after a time. */
static int frame_after(const struct light_record *r, double time_ms)
{
	int k = 0;

	while (k < r->frames && r->time_ms[k] < time_ms)
		k++;
	return k;
}

/* State of the control, delayed by `delay` frames: -1 before the first change, 1 after it, and so
 * on. */
static double control_at(const struct light_record *r, const int *first, int frame, int delay)
{
	int changes = 0;

	while (changes < r->changes && first[changes] + delay <= frame)
		changes++;
	return changes % 2 ? 1 : -1;
}

static double correlation_at(const struct light_record *r, const int *first, int delay)
{
	double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
	const double n = r->frames;

	for (int k = 0; k < r->frames; k++) {
		const double x = control_at(r, first, k, delay), y = r->level[k];

		sx += x;
		sy += y;
		sxx += x * x;
		syy += y * y;
		sxy += x * y;
	}
	sxx -= sx * sx / n;
	syy -= sy * sy / n;
	sxy -= sx * sy / n;
	return sxx > 0 && syy > 1e-12 ? sxy / sqrt(sxx * syy) : 0;
}

/* Returns the time from a change until the level has passed half of its step, ms; NaN: it never
 * does. */
static double crossing_time(const struct light_record *r, const int *first, int change, int delay)
{
	const int from = change ? first[change - 1] + delay : 0;
	const int to = change + 1 < r->changes ? first[change + 1] : r->frames;
	const int turn = first[change] + delay;
	double before = 0, after = 0;
	int n = 0, m = 0;

	for (int k = from < first[change] ? from : first[change]; k < turn && k < r->frames; k++) {
		before += r->level[k];
		n++;
	}
	for (int k = turn + 1; k < to; k++) {
		after += r->level[k];
		m++;
	}
	if (!n || !m)
		return NAN;
	before /= n;
	after /= m;
	for (int k = first[change]; k < to; k++)
		if ((r->level[k] - before) * (after - before) >=
		    0.5 * (after - before) * (after - before))
			return r->time_ms[k] - r->change_ms[change];
	return NAN;
}

static void find_times(struct light_delay *found, const struct light_record *r, const int *first)
{
	double sum = 0, squares = 0;

	found->shortest_ms = INFINITY;
	found->longest_ms = -INFINITY;
	for (int k = 0; k < r->changes; k++) {
		const double t = crossing_time(r, first, k, found->frames);

		if (isnan(t))
			continue;
		sum += t;
		squares += t * t;
		found->shortest_ms = fmin(found->shortest_ms, t);
		found->longest_ms = fmax(found->longest_ms, t);
		found->seen++;
	}
	if (!found->seen) {
		found->shortest_ms = found->longest_ms = 0;
		return;
	}
	found->time_ms = sum / found->seen;
	found->deviation_ms = found->seen > 1 ? sqrt(fmax(squares - sum * sum / found->seen, 0) /
						     (found->seen - 1))
					      : 0;
}

static void doubt_delay(struct light_delay *found, const struct light_record *r)
{
	const double period = (r->time_ms[r->frames - 1] - r->time_ms[0]) / (r->frames - 1);

	if (fabs(found->correlation) < 0.7)
		verdict_doubt(&found->verdict,
			      "see whether the camera has that control and does not set it itself, "
			      "and take exposures that differ more",
			      "no change is seen within %d frames", LIGHT_DELAY_FRAMES_MAX);
	if (found->seen < 3)
		verdict_doubt(&found->verdict,
			      "record more changes, and at least ten frames after each",
			      "fewer than three changes are seen");
	if (found->longest_ms - found->shortest_ms > 2.5 * period)
		verdict_doubt(&found->verdict,
			      "wait longer between changes, and let nothing else use the camera",
			      "the delay is not steady: %.0f to %.0f ms", found->shortest_ms,
			      found->longest_ms);
}

int light_delay_find(struct light_delay *found, const struct light_record *r, struct fault *fault)
{
	int *first;

	*found = (struct light_delay){.frames = 0};
	verdict_begin(&found->verdict);
	if (r->changes < 2 || r->frames < 8)
		return fault_say(fault, -EINVAL,
				 "there are %d changes and %d frames, expected 2 changes and 8 "
				 "frames or more",
				 r->changes, r->frames);
	first = calloc((size_t)r->changes, sizeof(*first));
	if (!first)
		return fault_say(fault, -ENOMEM, "not enough memory for %d changes", r->changes);
	for (int k = 0; k < r->changes; k++)
		first[k] = frame_after(r, r->change_ms[k]);
	for (int delay = 0; delay <= LIGHT_DELAY_FRAMES_MAX; delay++) {
		const double now = correlation_at(r, first, delay);

		if (fabs(now) <= fabs(found->correlation) + 1e-9)
			continue;
		found->correlation = now;
		found->frames = delay;
	}
	find_times(found, r, first);
	free(first);
	doubt_delay(found, r);
	return 0;
}
