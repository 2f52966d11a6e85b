/* SPDX-License-Identifier: MIT */
/*
 * Judges hal/people on the frames of rooms (rooms.h) that render has written, beside what OpenCV's
 * subtractors made of them. README.md says what the columns are.
 *     judge FOLDER [ROOM|loop|nudge [PICTURES]]
 * FOLDER holds N.room and N.inlay; of one room bad frames are left in the folder PICTURES.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "hal/image/image.h"
#include "tests/people/judged.h"
#include "tests/people/rooms.h"
#include "tests/people/subtractors.h"

/* Rooms for events: lamps and exposure stay; lamps are switched, exposure stays; lamps stay. */
enum { STEADY_ROOM = 4, SWITCHED_ROOM = 0, NUDGED_ROOM = 7 };
enum { METHODS = 1 + SUBTRACTORS, CROSSING_GAP = RATE_HZ / 3 };
#define OVERLAP_LEAST 0.01 /* of the object's pixels, that an order is judged by */
#define HIDDEN_MOST 0.003  /* of the object's pixels, that nobody may hide */
#define RIGHT_MOST 0.001   /* of the pixels looked at, that may be wrong where nobody is */

static int tile_of(const struct judged *j, int k)
{
	return k / j->camera.width / BASIS_TILE * j->basis.tiles_across +
	       k % j->camera.width / BASIS_TILE;
}

static bool veil_at(const struct judged *j, bool front, int k)
{
	const struct veil *veil = people_veil(j->people);

	return veil && veil->tile[tile_of(j, k)] &&
	       (front ? veil->front[k] : veil->anybody[k]) > 127;
}

/* ---- what is counted ---- */

struct crossing_tally {
	bool open, wrong;
	int gap; /* frames since it was seen over the object */
};

struct tally {
	int frames;
	double wrong[METHODS], missed[METHODS];
	int switches, after_frames; /* frames of the second after a lamp was switched */
	double after[METHODS];
	int64_t switched_ns;
	double edge2; /* (share seen - true share)^2 */
	long edges;
	int crossings, wrong_crossings, wrong_frames, order_frames;
	struct crossing_tally crossing[WALKER_STYLES];
	double hidden; /* sum of shares of the object hidden by nobody */
	int64_t hidden_since_ns, hidden_ns;
	int64_t empty_ns;		 /* when all had left; 0: not yet */
	int64_t wrong_until_ns[METHODS]; /* there, after it */
	int64_t end_ns;
	double moved_px; /* at most, as reported */
};

static void mark_near(struct judged *j)
{
	const int across = j->basis.tiles_across, down = j->basis.tiles_down;

	memset(j->tile_near, 0, (size_t)j->recording.head.tiles);
	for (int i = 0; i < j->recording.head.looked; i++) {
		const int tile = tile_of(j, j->recording.looked[i]);

		if (j->recording.alpha[i] == 0)
			continue;
		for (int n = 0; n < 9; n++) {
			const int x = tile % across + n % 3 - 1, y = tile / across + n / 3 - 1;

			if (x >= 0 && x < across && y >= 0 && y < down)
				j->tile_near[y * across + x] = 1;
		}
	}
}

static void count_wrong(const struct judged *j, int wrong[METHODS], int missed[METHODS])
{
	const struct recording *r = &j->recording;

	memset(wrong, 0, METHODS * sizeof(int));
	memset(missed, 0, METHODS * sizeof(int));
	for (int i = 0; i < r->head.looked; i++) {
		const bool truth = r->alpha[i] > 127;

		for (int m = 0; m < METHODS; m++) {
			const bool seen = m ? r->others[i] >> (m - 1) & 1
					    : veil_at(j, false, r->looked[i]);

			wrong[m] += seen != truth;
			missed[m] += truth && !seen;
		}
	}
}

static void tally_edges(const struct judged *j, struct tally *tally)
{
	const struct veil *veil = people_veil(j->people);
	const struct recording *r = &j->recording;

	for (int i = 0; i < r->head.looked; i++) {
		const int k = r->looked[i];
		const int seen = veil && veil->tile[tile_of(j, k)] ? veil->anybody[k] : 0;

		if (r->alpha[i] == 0 || r->alpha[i] == 255)
			continue;
		tally->edge2 += pow((seen - r->alpha[i]) / 255.0, 2);
		tally->edges++;
	}
}

static void tally_pixels(const struct judged *j, struct tally *tally)
{
	const struct recording *r = &j->recording;
	const int64_t now_ns = r->moment.captured_ns;
	int wrong[METHODS], missed[METHODS];
	bool after;

	count_wrong(j, wrong, missed);
	if (r->moment.switched) {
		tally->switches++;
		tally->switched_ns = now_ns;
	}
	after = tally->switches && now_ns - tally->switched_ns < INT64_C(1000000000);
	tally->frames++;
	tally->after_frames += after;
	for (int m = 0; m < METHODS; m++) {
		tally->wrong[m] += wrong[m];
		tally->missed[m] += missed[m];
		tally->after[m] += after ? wrong[m] : 0;
	}
	tally_edges(j, tally);
}

/* Whoever is over the object: is he on his side of it? Returns how many are not. */
static int tally_orders(const struct judged *j, struct tally *tally)
{
	const struct recording *r = &j->recording;
	int overlap[16] = {0}, before[16] = {0}, front[16] = {0}, all_wrong = 0;

	for (int i = 0; i < r->head.looked; i++) {
		const int k = r->looked[i], who = r->who[i] & TRUTH_WALKER;

		if (r->alpha[i] < 128 || j->basis.poses[0].coverage[k] < 32768)
			continue;
		overlap[who]++;
		before[who] += r->who[i] >= TRUTH_BEFORE;
		front[who] += veil_at(j, true, k);
	}
	for (int w = 0; w < WALKER_STYLES; w++) {
		struct crossing_tally *crossing = &tally->crossing[w];
		const int over = overlap[w + 1];
		const bool is_before = 2 * before[w + 1] > over;
		const bool wrong = is_before != (2 * front[w + 1] > over);

		if (over < OVERLAP_LEAST * j->object) {
			if (crossing->open && ++crossing->gap > CROSSING_GAP)
				*crossing = (struct crossing_tally){.open = false};
			continue;
		}
		tally->crossings += !crossing->open;
		tally->wrong_crossings += wrong && !crossing->wrong;
		tally->order_frames++;
		tally->wrong_frames += wrong;
		crossing->open = true;
		crossing->wrong = crossing->wrong || wrong;
		crossing->gap = 0;
		all_wrong += wrong;
	}
	return all_wrong;
}

static void tally_hidden(struct judged *j, struct tally *tally)
{
	const struct recording *r = &j->recording;
	const int64_t now_ns = r->moment.captured_ns;
	int hidden = 0;

	mark_near(j);
	for (int i = 0; i < r->head.looked; i++) {
		const int k = r->looked[i];

		hidden += j->basis.poses[0].coverage[k] >= 32768 && veil_at(j, true, k) &&
			  !j->tile_near[tile_of(j, k)];
	}
	tally->hidden += (double)hidden / j->object;
	if (hidden <= HIDDEN_MOST * j->object)
		tally->hidden_since_ns = now_ns;
	else if (now_ns - tally->hidden_since_ns > tally->hidden_ns)
		tally->hidden_ns = now_ns - tally->hidden_since_ns;
}

static void tally_empty(const struct judged *j, struct tally *tally)
{
	const int64_t now_ns = j->recording.moment.captured_ns;
	int wrong[METHODS], missed[METHODS];

	tally->end_ns = now_ns;
	if (j->recording.moment.walkers > 0)
		return;
	if (!tally->empty_ns) {
		tally->empty_ns = now_ns;
		for (int m = 0; m < METHODS; m++)
			tally->wrong_until_ns[m] = now_ns;
	}
	count_wrong(j, wrong, missed);
	for (int m = 0; m < METHODS; m++)
		if (wrong[m] > RIGHT_MOST * j->recording.head.looked)
			tally->wrong_until_ns[m] = now_ns;
}

/* Camera, truth, ours, and the method's mask that is given, side by side. */
static void keep_picture(const struct judged *j, const char *folder, int frame, int method,
			 bool order)
{
	const struct recording *r = &j->recording;
	const int w = j->camera.width, h = j->camera.height;
	struct image image = {.width = 4 * w, .height = h, .u8 = judged_make((size_t)w * h * 12)};
	char path[512];

	for (int k = 0; k < j->pixels; k++)
		for (int c = 0; c < 3; c++)
			image.u8[3 * (k / w * 4 * w + k % w) + c] = r->bgr[3 * k + 2 - c];
	for (int i = 0; i < r->head.looked; i++) {
		const int k = r->looked[i];
		uint8_t *to = image.u8 + 3 * (k / w * 4 * w + k % w + w);
		const int object = j->basis.poses[0].coverage[k] >= 32768 ? 90 : 40;
		const bool others = r->others[i] >> (method - 1) & 1;

		for (int c = 0; c < 3; c++) {
			to[c] = r->alpha[i] > 127 ? (r->who[i] & TRUTH_BEFORE && c ? 60 : 255)
						  : object;
			to[3 * w + c] = veil_at(j, false, k) ? (veil_at(j, true, k) && c ? 60 : 255)
							     : object;
			to[6 * w + c] = others ? 255 : object;
		}
	}
	snprintf(path, sizeof(path), "%s/%d-%04d%s.png", folder, r->head.room, frame,
		 order ? "-order" : "");
	image_write(path, &image, NULL);
	free(image.u8);
}

static int best_of_others(const struct tally *tally)
{
	int best = 1;

	for (int m = 2; m < METHODS; m++)
		if (tally->wrong[m] < tally->wrong[best])
			best = m;
	return best;
}

static double moved_px(const struct judged *j)
{
	const struct people_report report = people_report(j->people);

	return hypot(report.moved_px[0], report.moved_px[1]);
}

static void judge_room(struct judged *j, const char *pictures, struct tally *tally)
{
	memset(tally, 0, sizeof(*tally));
	for (int frame = 0; frame < ROOM_FRAMES; frame++) {
		int order;

		judged_read(j, frame, 0);
		judged_look(j, j->recording.moment.captured_ns);
		tally->moved_px = fmax(tally->moved_px, moved_px(j));
		if (frame < LEARNING)
			continue;
		if (frame == LEARNING)
			tally->hidden_since_ns = j->recording.moment.captured_ns;
		if (frame < LEAVING)
			tally_pixels(j, tally);
		else
			tally_empty(j, tally);
		tally_hidden(j, tally);
		order = tally_orders(j, tally);
		if (pictures && (order || frame % 30 == 0))
			keep_picture(j, pictures, frame, best_of_others(tally), order > 0);
	}
}

/* ---- the table ---- */

static double right_s(const struct tally *tally, int m)
{
	return 1e-9 * (double)(tally->wrong_until_ns[m] - tally->empty_ns);
}

static void print_row(const struct judged *j, const struct tally *t)
{
	const int best = best_of_others(t);
	const int stuck = t->wrong_until_ns[0] == t->end_ns;

	printf("%4d %6d %7.0f %7.0f %7.0f %7.0f %-10s %5.2f", j->recording.head.room,
	       j->recording.head.looked, t->wrong[0] / t->frames, t->missed[0] / t->frames,
	       (t->wrong[0] - t->missed[0]) / t->frames, t->wrong[best] / t->frames,
	       subtractor_names[best - 1], t->wrong[0] / t->wrong[best]);
	if (t->after_frames)
		printf(" %6.0f", t->after[0] / t->after_frames);
	else
		printf("      -");
	printf(" %5.2f %3d/%-3d %4d/%-4d %6.2f %6.1f %s%5.1f %5.1f %5.1f %6.2f\n",
	       t->edges ? sqrt(t->edge2 / (double)t->edges) : 0, t->wrong_crossings, t->crossings,
	       t->wrong_frames, t->order_frames, 100 * t->hidden / (ROOM_FRAMES - LEARNING),
	       1e-9 * (double)t->hidden_ns, stuck ? ">" : " ", right_s(t, 0), right_s(t, best),
	       t->moved_px, 1e3 * j->look_s / j->looks);
	fflush(stdout);
}

struct half {
	int rooms, crossings, wrong_crossings, order_frames, wrong_frames;
	double ratio, worst_ratio, wrong, others, hidden, run_s, right_s, ms;
};

static void half_add(struct half *half, const struct judged *j, const struct tally *t)
{
	const int best = best_of_others(t);
	const double ratio = t->wrong[0] / t->wrong[best];

	half->rooms++;
	half->crossings += t->crossings;
	half->wrong_crossings += t->wrong_crossings;
	half->order_frames += t->order_frames;
	half->wrong_frames += t->wrong_frames;
	half->ratio += ratio;
	half->worst_ratio = fmax(half->worst_ratio, ratio);
	half->wrong += t->wrong[0] / t->frames;
	half->others += t->wrong[best] / t->frames;
	half->hidden += 100 * t->hidden / (ROOM_FRAMES - LEARNING);
	half->run_s = fmax(half->run_s, 1e-9 * (double)t->hidden_ns);
	half->right_s = fmax(half->right_s, right_s(t, 0));
	half->ms += 1e3 * j->look_s / j->looks;
}

static void print_half(const char *name, const struct half *h)
{
	if (h->rooms)
		printf("%s: wrong %.0f, theirs %.0f; ratio mean %.2f, worst %.2f; order wrong %.1f %% of %d, %.2f %% of frames; hidden by nobody %.3f %%, worst run %.1f s; empty place right after %.1f s; %.2f ms\n",
		       name, h->wrong / h->rooms, h->others / h->rooms, h->ratio / h->rooms,
		       h->worst_ratio, 100.0 * h->wrong_crossings / fmax(h->crossings, 1),
		       h->crossings, 100.0 * h->wrong_frames / fmax(h->order_frames, 1),
		       h->hidden / h->rooms, h->run_s, h->right_s, h->ms / h->rooms);
}

static bool is_rendered(const char *folder, int room)
{
	char path[512];

	snprintf(path, sizeof(path), "%s/%d.room", folder, room);
	return access(path, R_OK) == 0;
}

static void judge_rooms(const char *folder, const char *only, const char *pictures)
{
	struct half half[2] = {{0}};

	puts("room looked   wrong  missed   false  theirs which      ratio switch  edge  order    frames  hidden%  run_s empty_s theirs moved    ms");
	for (int room = 0; room < ROOMS; room++) {
		struct judged judged;
		struct tally tally;

		if (only && atoi(only) != room)
			continue;
		if (!is_rendered(folder, room)) {
			printf("%4d is not rendered\n", room);
			continue;
		}
		judged_open(&judged, folder, room);
		judge_room(&judged, pictures, &tally);
		print_row(&judged, &tally);
		half_add(&half[room / HALF], &judged, &tally);
		judged_close(&judged);
	}
	print_half("half=choose", &half[0]);
	print_half("half=judge", &half[1]);
}

/* ---- events ---- */

/* The judged frames of a room that keeps its exposure, again and again, one a second, for an hour:
 * what was learned must not drift. */
static void judge_loop(const char *folder, int room)
{
	const int hour_s = 3600;
	int64_t now_ns = 0;
	double low = INFINITY, high = 0;
	struct judged j;
	long begin = 0;
	int frame = 0;

	judged_open(&j, folder, room);
	for (int s = 0; s < hour_s; s++, frame++) {
		struct people_report report;

		if (frame == LEARNING)
			begin = ftell(j.recording.file);
		if (frame == LEAVING) {
			frame = LEARNING;
			fseek(j.recording.file, begin, SEEK_SET);
		}
		judged_read(&j, frame, 0);
		now_ns += INT64_C(1000000000);
		judged_look(&j, now_ns);
		report = people_report(j.people);
		for (int c = 0; s >= LEARNING && c < 3; c++) {
			low = fmin(low, report.gain[c]);
			high = fmax(high, report.gain[c]);
		}
	}
	printf("loop: an hour of room %d, one frame a second: gain %.3f to %.3f (asked 0.97 to 1.03)\n",
	       room, low, high);
	fflush(stdout);
	judged_close(&j);
}

/* The camera is pushed when the judged frames begin. */
static void judge_nudge(const char *folder, int room, int px)
{
	double hidden = 0;     /* sum over frames: pixels of the object */
	double wrong[2] = {0}; /* in the first second, in the last five of those judged */
	int count[2] = {0}, last = LEARNING, said = 0;
	struct people_report report = {0};
	struct judged j;

	judged_open(&j, folder, room);
	for (int frame = 0; frame < ROOM_FRAMES; frame++) {
		const struct recording *r = &j.recording;
		int seen = 0;

		judged_read(&j, frame, frame < LEARNING ? 0 : px);
		judged_look(&j, r->moment.captured_ns);
		if (frame < LEARNING)
			continue;
		report = people_report(j.people);
		said = !said && moved_px(&j) > 0.5 ? frame : said;
		mark_near(&j);
		for (int i = 0; i < r->head.looked; i++)
			hidden += !j.tile_near[tile_of(&j, r->looked[i])] &&
				  veil_at(&j, true, r->looked[i]) &&
				  j.basis.poses[0].coverage[r->looked[i]] >= 32768;
		for (int i = 0; i < r->head.looked; i++)
			seen += !j.tile_near[tile_of(&j, r->looked[i])] &&
				veil_at(&j, false, r->looked[i]);
		if (seen > 10 * RIGHT_MOST * r->head.looked)
			last = frame;
		for (int k = 0; k < 2; k++)
			if (k ? frame >= ROOM_FRAMES - 5 * LEAVING_HZ
			      : frame < LEARNING + RATE_HZ) {
				wrong[k] += seen;
				count[k]++;
			}
	}
	printf("nudge: room %d by %d px: said after %.1f s: %.1f px right, %.1f px down%s; the object hidden by nobody for %.2f s; pixels a frame in which nobody is seen: %.0f in the first second, %.0f in the last five; above 1 %% until %s%.1f s\n",
	       room, px, said ? room_time_s(said) - room_time_s(LEARNING) : -1, report.moved_px[0],
	       report.moved_px[1], report.lost ? ", people left alone" : "",
	       hidden / j.object / RATE_HZ, wrong[0] / count[0], wrong[1] / count[1],
	       last == ROOM_FRAMES - 1 ? ">" : "", room_time_s(last) - room_time_s(LEARNING));
	fflush(stdout);
	judged_close(&j);
}

int main(int argc, char **argv)
{
	const char *what = argc > 2 ? argv[2] : "";
	const bool one = *what >= '0' && *what <= '9';

	if (argc < 2)
		judged_die("expected FOLDER [ROOM|loop|nudge [PICTURES]]");
	if (one || !*what)
		judge_rooms(argv[1], one ? what : NULL, argc > 3 ? argv[3] : NULL);
	if (!*what || strcmp(what, "loop") == 0) {
		judge_loop(argv[1], STEADY_ROOM);
		judge_loop(argv[1], SWITCHED_ROOM);
	}
	for (int i = 0; i < 3 && (!*what || strcmp(what, "nudge") == 0); i++)
		judge_nudge(argv[1], NUDGED_ROOM, (const int[]){1, 3, 10}[i]);
	return 0;
}
