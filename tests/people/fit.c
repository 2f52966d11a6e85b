/* SPDX-License-Identifier: MIT */
/*
 * Weighs the clues that tell a person from a shadow (hal/people/verdict.c): a logistic regression
 * of the truth on the clues of cells that differ from the place, over rooms. The clues depend on
 * what was found before, so repeat it until the weights stay.
 *     fit FOLDER ROOM...
 * Prints the weights, in the order of verdict_clues(), and how well they tell.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/people/people_parts.h"
#include "tests/people/judged.h"
#include "tests/people/rooms.h"

enum { CLUES = VERDICT_CLUES, EACH = 21, STEPS = 20 };
#define DIFFERS 12.0f /* of verdict.c */
#define RIDGE 1e-5    /* keeps weights of clues that say the same finite */

struct sample {
	float clue[CLUES];
	bool person;
};

struct samples {
	struct sample *of;
	size_t count, room;
};

/* A cell's share of people, of 0 to 1; NAN: not all of its pixels are looked at. */
static void read_truth(const struct judged *j, float *share)
{
	const struct cells *cells = &j->people->cells;
	const int side = cells->side, width = j->camera.width;

	memset(share, 0, (size_t)cells->count * sizeof(*share));
	for (int i = 0; i < j->recording.head.looked; i++) {
		const int k = j->recording.looked[i];

		share[k / width / side * cells->across + k % width / side] +=
			1 + (float)j->recording.alpha[i] / 255;
	}
	for (int at = 0; at < cells->count; at++)
		share[at] = share[at] < (float)(side * side) ? NAN
							     : share[at] / (float)(side * side) - 1;
}

static void add_sample(struct samples *samples, const struct people *people, int at, bool person)
{
	struct sample *to;

	if (samples->count == samples->room) {
		samples->room = 2 * samples->room + 1024;
		samples->of = realloc(samples->of, samples->room * sizeof(*samples->of));
		if (!samples->of)
			judged_die("not enough memory");
	}
	to = &samples->of[samples->count++];
	verdict_clues(people, at % people->cells.across, at / people->cells.across, to->clue);
	to->person = person;
}

/* One of EACH cells that differ and are a person's, or nobody's, by four fifths at least. */
static void take_frame(struct samples *samples, const struct judged *j, const float *share)
{
	static unsigned turn;
	const struct people *p = j->people;

	for (int at = 0; at < p->cells.count; at++)
		if (p->cells.watch[at] && p->place.known[at] && p->verdict.chi[at] > DIFFERS &&
		    fabsf(share[at] - 0.5f) > 0.3f && turn++ % EACH == 0)
			add_sample(samples, p, at, share[at] > 0.5f);
}

static void take_room(struct samples *samples, const char *folder, int room)
{
	struct judged j;
	float *share;

	judged_open(&j, folder, room);
	share = judged_make((size_t)j.people->cells.count * sizeof(*share));
	for (int frame = 0; frame < LEAVING; frame++) {
		judged_read(&j, frame, 0);
		judged_look(&j, j.recording.moment.captured_ns);
		if (frame < LEARNING)
			continue;
		read_truth(&j, share);
		take_frame(samples, &j, share);
	}
	free(share);
	judged_close(&j);
}

static double logit_of(const struct sample *sample, const double weight[CLUES])
{
	double sum = 0;

	for (int n = 0; n < CLUES; n++)
		sum += weight[n] * (double)sample->clue[n];
	return sum;
}

/* Solves the symmetric equations in place: the solution is in the last column. */
static void solve(double m[CLUES][CLUES + 1])
{
	for (int n = 0; n < CLUES; n++)
		for (int k = 0; k < CLUES; k++) {
			const double share = k == n ? 0 : m[k][n] / m[n][n];

			for (int c = n; share != 0 && c <= CLUES; c++)
				m[k][c] -= share * m[n][c];
		}
	for (int n = 0; n < CLUES; n++)
		m[n][CLUES] /= m[n][n];
}

/* One step of Newton's method on the log-likelihood. */
static void improve(const struct samples *samples, double weight[CLUES])
{
	double m[CLUES][CLUES + 1] = {{0}};

	for (size_t i = 0; i < samples->count; i++) {
		const struct sample *s = &samples->of[i];
		const double likely = 1 / (1 + exp(-logit_of(s, weight)));

		for (int n = 0; n < CLUES; n++) {
			const double clue = (double)s->clue[n];

			m[n][CLUES] += (s->person - likely) * clue;
			for (int k = 0; k < CLUES; k++)
				m[n][k] += (likely * (1 - likely) + RIDGE) * clue *
					   (double)s->clue[k];
		}
	}
	for (int n = 0; n < CLUES; n++) {
		m[n][n] += RIDGE * (double)samples->count;
		m[n][CLUES] -= n ? RIDGE * (double)samples->count * weight[n] : 0;
	}
	solve(m);
	for (int n = 0; n < CLUES; n++)
		weight[n] += m[n][CLUES];
}

int main(int argc, char **argv)
{
	struct samples samples = {NULL, 0, 0};
	double weight[CLUES] = {0};
	size_t people = 0, wrong = 0;

	if (argc < 3)
		judged_die("usage: fit FOLDER ROOM...");
	for (int n = 2; n < argc; n++)
		take_room(&samples, argv[1], atoi(argv[n]));
	for (int step = 0; step < STEPS; step++)
		improve(&samples, weight);
	for (size_t i = 0; i < samples.count; i++) {
		people += samples.of[i].person;
		wrong += samples.of[i].person != (logit_of(&samples.of[i], weight) > 0);
	}
	printf("%zu cells, %zu of people: %.2f %% wrong\n", samples.count, people,
	       100.0 * (double)wrong / (double)samples.count);
	for (int n = 0; n < CLUES; n++)
		printf("%#.4gf%s", weight[n], n + 1 < CLUES ? ", " : "\n");
	free(samples.of);
	return 0;
}
