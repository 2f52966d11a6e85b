/* SPDX-License-Identifier: MIT */
/*
 * Judges hal/people in the simulated studio, whose truth is known, beside OpenCV's MOG2 and KNN on
 * the same frames. README.md says what the columns are.
 *     judge BASIS.inlay [FRAMES [CASE [FOLDER [LATER_S]]]]
 * With FOLDER, pictures of bad frames are left there. LATER_S seconds later lamps and walkers are
 * elsewhere.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/image/image.h"
#include "hal/people/people.h"
#include "tests/people/filmed.h"
#include "tests/people/subtractors.h"

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};
static const double eye_ground[2] = {0, -2.4};
/* The box of people.scene on the ground: half its side, and how it is turned. */
static const double foot_half = 0.175, foot_turn = 20 * M_PI / 180;
/* A depth camera has 5 mm at 1 m and 2 cm at 2 m. */
enum { DEPTH_NOISE_MM = 5 };
enum { LEARNING = 900, RATE_HZ = 15, METHODS = 1 + SUBTRACTORS };

static void die(const char *what)
{
	fprintf(stderr, "judge: %s\n", what);
	exit(1);
}

/* ---- the cases ---- */

struct judged_case {
	const char *name, *what;
	int people; /* enter by walkers_at(); -1: one stands, placed by style, place */
	enum walker_style style;
	double place[2];
	double rate_hz;
	bool restless; /* lamps are switched and the exposure jumps and drifts */
	int wall_x, wall_y;
	double walk_m_s;       /* of the one */
	double depth_noise_mm; /* at 1 m; 0: there is no depth camera */
	bool beside;	       /* it stands elsewhere, calibrated */
};

static const struct judged_case cases[] = {
	{.name = "main",
	 .what = "four walkers, lamps moving and switched, exposure steps",
	 .people = 4,
	 .rate_hz = RATE_HZ,
	 .restless = true},
	{.name = "calm", .what = "four walkers, lamps moving", .people = 4, .rate_hz = RATE_HZ},
	{.name = "feet",
	 .what = "walks behind, feet hidden by a low wall",
	 .people = -1,
	 .style = WALKER_JUMPER,
	 .place = {0, 0.6},
	 .rate_hz = RATE_HZ,
	 .wall_x = 60,
	 .wall_y = 108,
	 .walk_m_s = 0.4},
	{.name = "rug",
	 .what = "walks before the object in the floor's colour",
	 .people = -1,
	 .style = WALKER_RUG,
	 .place = {0, -0.5},
	 .rate_hz = RATE_HZ,
	 .walk_m_s = 0.4},
	{.name = "bag",
	 .what = "a bag is left beside the object",
	 .people = -1,
	 .style = WALKER_BAG,
	 .rate_hz = RATE_HZ},
	{.name = "still",
	 .what = "stands before the object for ten minutes, 1 frame a second",
	 .people = -1,
	 .style = WALKER_JUMPER,
	 .place = {0.1, -0.5},
	 .rate_hz = 1},
	{.name = "wall",
	 .what = "walks before the object, feet hidden by a low wall",
	 .people = -1,
	 .style = WALKER_JUMPER,
	 .place = {0, -0.5},
	 .rate_hz = RATE_HZ,
	 .wall_x = 60,
	 .wall_y = 130,
	 .walk_m_s = 0.4},
	{.name = "main-depth",
	 .what = "main, with a depth camera",
	 .people = 4,
	 .rate_hz = RATE_HZ,
	 .restless = true,
	 .depth_noise_mm = DEPTH_NOISE_MM},
	{.name = "main-beside",
	 .what = "main, with a depth camera 0.9 m beside and 0.6 m above",
	 .people = 4,
	 .rate_hz = RATE_HZ,
	 .restless = true,
	 .depth_noise_mm = DEPTH_NOISE_MM,
	 .beside = true},
	{.name = "feet-depth",
	 .what = "feet, with a depth camera",
	 .people = -1,
	 .style = WALKER_JUMPER,
	 .place = {0, 0.6},
	 .rate_hz = RATE_HZ,
	 .wall_x = 60,
	 .wall_y = 108,
	 .walk_m_s = 0.4,
	 .depth_noise_mm = DEPTH_NOISE_MM},
	{.name = "wall-depth",
	 .what = "wall, with a depth camera",
	 .people = -1,
	 .style = WALKER_JUMPER,
	 .place = {0, -0.5},
	 .rate_hz = RATE_HZ,
	 .wall_x = 60,
	 .wall_y = 130,
	 .walk_m_s = 0.4,
	 .depth_noise_mm = DEPTH_NOISE_MM},
};

enum { CASES = sizeof(cases) / sizeof(*cases) };

/* Whether a place on the ground is before the object: the line of sight to it does not pass the
 * footprint; beside the footprint, whether it is nearer than its middle. */
static bool place_is_before(const double place[2])
{
	const double cosine = cos(foot_turn), sine = sin(foot_turn);
	double enter = 0, leave = 1;

	for (int i = 0; i < 2; i++) {
		const double u = i ? -sine : cosine, v = i ? cosine : sine;
		const double from = u * eye_ground[0] + v * eye_ground[1];
		const double way = u * place[0] + v * place[1] - from;
		const double a = (-foot_half - from) / way, b = (foot_half - from) / way;

		enter = fmax(enter, fmin(a, b));
		leave = fmin(leave, fmax(a, b));
	}
	if (enter < leave)
		return leave >= 1; /* it ends inside */
	return hypot(place[0] - eye_ground[0], place[1] - eye_ground[1]) <
	       hypot(eye_ground[0], eye_ground[1]);
}

/* Whether the feet, in the widest step, are all on one side. */
static bool order_is_plain(const struct walker *walker)
{
	const double step = walker->absent ? 0.2 : 0.5 * walker_height(walker->style);
	const bool before = place_is_before(walker->place);

	for (int k = -2; k <= 2; k++) {
		const double foot[2] = {walker->place[0] + k * step / 2 * cos(walker->heading_rad),
					walker->place[1] + k * step / 2 * sin(walker->heading_rad)};

		if (place_is_before(foot) != before)
			return false;
	}
	return true;
}

static void place_one(const struct judged_case *of, int frame, struct filmed_moment *moment)
{
	struct walker *walker = &moment->walker[0];
	const double since = (frame - LEARNING) / of->rate_hz;
	const double lane = 2.4;

	*walker = (struct walker){.style = of->style, .time_s = moment->time_s};
	memcpy(walker->place, of->place, sizeof(of->place));
	if (of->style == WALKER_BAG) {
		walker->absent = walker->bag_left = true;
		walker->bag_place[0] = walker->place[0] = 0.2;
		walker->bag_place[1] = walker->place[1] = -0.35;
	} else if (of->walk_m_s > 0) {
		walker->place[0] = fmod(of->walk_m_s * since, 2 * lane) - lane;
		walker->walked = walker->place[0] / WALKER_STRIDE_M;
		walker->pace = 1;
	}
	moment->walkers = 1;
}

static void make_moment(const struct judged_case *of, int frame, double later_s,
			struct filmed_moment *moment)
{
	const double t = later_s + frame / of->rate_hz;

	memset(moment, 0, sizeof(*moment));
	moment->number = frame;
	moment->time_s = t;
	moment->wall_x = of->wall_x;
	moment->wall_y = of->wall_y;
	moment->depth_noise_mm = of->depth_noise_mm;
	for (int c = 0; c < 3; c++)
		moment->exposure[c] = 0.8;
	if (of->restless) {
		/* Steps of a sixth each 9 s, and a drift of the colours. */
		const double step = (int)(t / 9) % 2 ? 1.16 : 1;

		moment->switch_s = 13;
		moment->exposure[0] *= step * (1 + 0.03 * sin(t / 7));
		moment->exposure[1] *= step;
		moment->exposure[2] *= step * (1 - 0.03 * sin(t / 7));
	}
	if (frame < LEARNING)
		return;
	if (of->people > 0)
		moment->walkers = walkers_at(t, of->people, moment->walker);
	else
		place_one(of, frame, moment);
	for (int i = 0; i < moment->walkers; i++)
		moment->before[i] = place_is_before(moment->walker[i].place);
}

/* ---- what is judged ---- */

struct judged {
	struct basis basis;
	struct dome dome;
	struct tsai_camera camera, beside;
	struct compositor *compositor;
	struct light_selection lights;
	struct people *people;
	struct subtractors *others;
	struct filmed filmed;
	int pixels;
	uint8_t *touched;
	bool *looked; /* [pixels] */
	uint8_t *ours, *today, *black, *grey, *grey_back;
	uint8_t *mask[SUBTRACTORS];
	double decode[256];
	double later_s;
};

struct tally {
	int frames;
	double wrong[METHODS], missed[METHODS];
	long place;			 /* pixels looked at, over all frames */
	int placed, order_wrong, unseen; /* walkers that overlap the object */
	double inside[2], outside[2], edge[2];
	long inside_count, outside_count, edge_count;
	double look_s;
};

static void *room(size_t bytes)
{
	void *p = calloc(bytes, 1);

	if (!p)
		die("not enough memory");
	return p;
}

static void judged_close(struct judged *j)
{
	people_destroy(j->people);
	subtractors_destroy(j->others);
	filmed_close(&j->filmed);
	light_selection_free(&j->lights);
	compositor_destroy(j->compositor);
	basis_close(&j->basis);
	dome_free(&j->dome);
	free(j->touched);
	free(j->looked);
	free(j->ours);
	free(j->today);
	free(j->black);
	free(j->grey);
	free(j->grey_back);
	for (int m = 0; m < SUBTRACTORS; m++)
		free(j->mask[m]);
}

static struct picture as_picture(const struct judged *j, const uint8_t *bgrx)
{
	return (struct picture){.origin = bgrx,
				.x_step = 4,
				.y_step = (ptrdiff_t)j->camera.width * 4,
				.width = j->camera.width,
				.height = j->camera.height};
}

static void composite(struct judged *j, const uint8_t *background, const struct veil *veil,
		      uint8_t *out)
{
	const struct compositor_settings settings = {
		.background = srgb, .output = srgb, .gain = 0.8, .object = true, .veil = veil};
	const struct picture picture = as_picture(j, background);
	const struct backdrop backdrop = backdrop_of(&picture);

	compositor_set(j->compositor, &settings);
	if (compositor_run(j->compositor, 0, &j->lights, &backdrop, out,
			   (size_t)j->camera.width * 4))
		die("cannot composite");
}

/* Marks the tiles in which object and shadow change a pixel under an even sky by a level. */
static void mark_looked(struct judged *j)
{
	const int across = j->basis.tiles_across;
	float(*even)[3] = room((size_t)j->dome.count * sizeof(*even));

	for (int i = 0; i < j->dome.count; i++)
		even[i][0] = even[i][1] = even[i][2] = (float)M_1_PI;
	light_selection_choose(&j->lights, &j->basis, 0, (const float(*)[3])even, 0, THRESHOLD_DROP,
			       1);
	composite(j, j->grey_back, NULL, j->grey);
	free(even);
	for (int k = 0; k < j->pixels; k++)
		for (int c = 0; c < 3; c++)
			if (j->grey[4 * k + c] != j->grey_back[4 * k + c])
				j->touched[k / j->filmed.width / BASIS_TILE * across +
					   k % j->filmed.width / BASIS_TILE] = 1;
	for (int k = 0; k < j->pixels; k++)
		j->looked[k] = j->touched[k / j->filmed.width / BASIS_TILE * across +
					  k % j->filmed.width / BASIS_TILE];
}

static void place_beside(struct judged *j)
{
	const double eye[3] = {0.9, -2.2, 1.95}, target[3] = {0, 0.25, 0.4};
	struct fault fault = {{0}};

	if (tsai_look_at(&j->beside, j->camera.width, j->camera.height, eye, target, 75, &fault))
		die(fault.text);
}

static void judged_open(struct judged *j, const struct judged_case *of, const char *path)
{
	struct fault fault = {{0}};
	struct people_settings settings;
	struct people_object object;

	memset(j, 0, sizeof(*j));
	if (basis_open(&j->basis, path, BASIS_SHOWN, &fault) ||
	    tsai_read_text(j->basis.camera, &j->camera, &fault) ||
	    dome_create(&j->dome, (int)j->basis.info.dome_frequency, &fault) ||
	    compositor_create(&j->compositor, &j->basis, &(struct compositor_options){0}, &fault) ||
	    compositor_take_pose(j->compositor, 0, &fault))
		die(fault.text);
	place_beside(j);
	settings = (struct people_settings){.width = j->camera.width,
					    .height = j->camera.height,
					    .curve = srgb,
					    .dome = &j->dome,
					    .depth_camera = of->beside ? &j->beside : NULL};
	if (light_selection_create(&j->lights, &j->basis) ||
	    people_create(&j->people, &settings, &fault) ||
	    filmed_open(&j->filmed, &j->camera, &j->dome) ||
	    (of->beside && filmed_see_from(&j->filmed, &j->beside)))
		die("not enough memory");
	j->others = subtractors_create(j->camera.width, j->camera.height);
	j->pixels = j->camera.width * j->camera.height;
	j->touched = room((size_t)(j->basis.tiles_across * j->basis.tiles_down));
	j->looked = room((size_t)j->pixels * sizeof(bool));
	j->ours = room((size_t)j->pixels * 4);
	j->today = room((size_t)j->pixels * 4);
	j->black = room((size_t)j->pixels * 4);
	j->grey = room((size_t)j->pixels * 4);
	j->grey_back = room((size_t)j->pixels * 4);
	memset(j->grey_back, 188, (size_t)j->pixels * 4);
	for (int m = 0; m < SUBTRACTORS; m++)
		j->mask[m] = room((size_t)j->pixels);
	for (int i = 0; i < 256; i++)
		j->decode[i] = transfer_decode(TRANSFER_SRGB, i / 255.0);
	mark_looked(j);
	object = (struct people_object){.coverage = j->basis.poses[0].coverage,
					.touched = j->touched,
					.camera = &j->camera,
					.foot = j->basis.feet};
	people_place(j->people, &object);
}

/* The true composite of a channel, as a code value 0..255, not rounded: people before the object,
 * over the object, over people behind it, over the ground with the object's shadow. */
static double true_code(const struct judged *j, int k, int c)
{
	const struct studio_layer *behind = &j->filmed.behind[k], *before = &j->filmed.before[k];
	const double object = j->decode[j->black[4 * k + 2 - c]];
	const double kept = (j->decode[j->grey[4 * k + 2 - c]] - object) / j->decode[188];
	const double coverage = j->basis.poses[0].coverage[k] / 65535.0;
	const double inner = object + (1 - coverage) * behind->rgb[c] +
			     (1 - behind->alpha) * kept * j->filmed.ground[3 * k + c];
	const double all = before->rgb[c] + (1 - before->alpha) * inner;

	return 255 * transfer_encode(TRANSFER_SRGB, fmin(all, 1));
}

static double truth_alpha(const struct judged *j, int k)
{
	return 1 - (1 - j->filmed.behind[k].alpha) * (1 - j->filmed.before[k].alpha);
}

static bool veil_at(const struct judged *j, const struct veil *veil, const uint8_t *plane, int k)
{
	const int tile = k / j->camera.width / BASIS_TILE * j->basis.tiles_across +
			 k % j->camera.width / BASIS_TILE;

	return veil && veil->tile[tile] && plane[k] > 127;
}

static int tally_masks(const struct judged *j, const struct veil *veil, struct tally *tally)
{
	int ours = 0;

	for (int k = 0; k < j->pixels; k++) {
		const bool truth = truth_alpha(j, k) > 0.5;

		if (!j->looked[k])
			continue;
		tally->place++;
		for (int m = 0; m < METHODS; m++) {
			const bool seen = m ? j->mask[m - 1][k] == 255
					    : veil_at(j, veil, veil ? veil->anybody : NULL, k);

			tally->wrong[m] += seen != truth;
			tally->missed[m] += truth && !seen;
			ours += !m && seen != truth;
		}
	}
	return ours;
}

/* Judges each layer's order where it is plain. Returns errors. */
static int tally_order(const struct judged *j, const struct filmed_moment *moment,
		       const struct veil *veil, struct tally *tally)
{
	int wrong = 0;

	for (int side = 0; side < 2; side++) {
		const struct studio_layer *layer = side ? j->filmed.before : j->filmed.behind;
		const struct studio_layer *other = side ? j->filmed.behind : j->filmed.before;
		int overlap = 0, front = 0, any = 0;

		for (int i = 0; i < moment->walkers; i++)
			if (!order_is_plain(&moment->walker[i]))
				return 0;
		for (int k = 0; k < j->pixels; k++) {
			if (layer[k].alpha < 0.5 || other[k].alpha > 0 ||
			    j->basis.poses[0].coverage[k] < 32768)
				continue;
			overlap++;
			front += veil_at(j, veil, veil ? veil->front : NULL, k);
			any += veil_at(j, veil, veil ? veil->anybody : NULL, k);
		}
		if (overlap < 20)
			continue;
		tally->placed++;
		if (any < overlap / 2)
			tally->unseen++;
		else if (side ? front < any / 2 : front > any / 2)
			wrong++;
	}
	tally->order_wrong += wrong;
	return wrong;
}

static void tally_composites(const struct judged *j, struct tally *tally)
{
	for (int k = 0; k < j->pixels; k++) {
		const double alpha = truth_alpha(j, k);

		if (!j->looked[k])
			continue;
		for (int c = 0; c < 3; c++) {
			const double truth = true_code(j, k, c);
			const double off[2] = {j->ours[4 * k + 2 - c] - truth,
					       j->today[4 * k + 2 - c] - truth};

			for (int m = 0; m < 2; m++) {
				if (alpha == 0)
					tally->outside[m] += off[m] * off[m];
				else
					tally->inside[m] += off[m] * off[m];
				if (alpha > 0 && alpha < 1)
					tally->edge[m] += off[m] * off[m];
			}
		}
		tally->outside_count += 3 * (alpha == 0);
		tally->inside_count += 3 * (alpha > 0);
		tally->edge_count += 3 * (alpha > 0 && alpha < 1);
	}
}

static double cpu_s(void)
{
	struct timespec now;

	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Camera, ours, today, and the masks of truth, ours, MOG2, KNN, side by side. */
static void keep_picture(const struct judged *j, const struct veil *veil, const char *folder,
			 const char *name, int frame, int wrong)
{
	const int w = j->camera.width, h = j->camera.height;
	struct image image = {.width = 3 * w, .height = 2 * h, .u8 = room((size_t)w * h * 18)};
	char path[512];

	for (int k = 0; k < j->pixels; k++)
		for (int c = 0; c < 3; c++) {
			uint8_t *to = image.u8 + 3 * (k / w * 3 * w + k % w) + c;
			const ptrdiff_t right = 3 * w, under = (ptrdiff_t)9 * w * h;

			to[0] = j->filmed.bgrx[4 * k + 2 - c];
			to[right] = j->ours[4 * k + 2 - c];
			to[2 * right] = (uint8_t)lrint(true_code(j, k, c));
			to[under] = (uint8_t)lrint((j->looked[k] ? 215 : 120) * truth_alpha(j, k) +
						   40 * j->looked[k]);
			if (veil_at(j, veil, veil ? veil->anybody : NULL, k))
				to[under + right] = veil_at(j, veil, veil->front, k) && c ? 60
											  : 255;
			to[under + 2 * right] = j->mask[c == 2 ? 1 : 0][k];
		}
	snprintf(path, sizeof(path), "%s/%s-%04d-%d.png", folder, name, frame, wrong);
	image_write(path, &image, NULL);
	free(image.u8);
}

static void judge_frame(struct judged *j, const struct judged_case *of, int frame,
			struct tally *tally, const char *folder)
{
	struct filmed_moment moment;
	struct picture picture;
	struct depth_map depth;
	const struct veil *veil;
	double begin;
	int wrong, order;

	make_moment(of, frame, j->later_s, &moment);
	if (filmed_take(&j->filmed, &moment))
		die("not enough memory");
	picture = as_picture(j, j->filmed.bgrx);
	depth = (struct depth_map){
		j->filmed.depth,  2,	(ptrdiff_t)j->filmed.width * 2, j->filmed.width,
		j->filmed.height, 0.001};
	begin = cpu_s();
	people_take_depth(j->people, of->depth_noise_mm > 0 ? &depth : NULL);
	people_look(j->people, &picture, (const float(*)[3])j->filmed.light,
		    (int64_t)(moment.time_s * 1e9));
	begin = cpu_s() - begin;
	subtractors_look(j->others, j->filmed.bgrx, j->mask);
	if (frame < LEARNING)
		return;
	veil = people_veil(j->people);
	light_selection_choose(&j->lights, &j->basis, 0, (const float(*)[3])j->filmed.light, 0,
			       THRESHOLD_DROP, 1);
	composite(j, j->filmed.bgrx, veil, j->ours);
	composite(j, j->filmed.bgrx, NULL, j->today);
	memset(j->black, 0, (size_t)j->pixels * 4);
	memcpy(j->grey, j->grey_back, (size_t)j->pixels * 4);
	{
		uint8_t *zero = room((size_t)j->pixels * 4);

		composite(j, zero, NULL, j->black);
		free(zero);
	}
	composite(j, j->grey_back, NULL, j->grey);
	tally->frames++;
	tally->look_s += begin;
	wrong = tally_masks(j, veil, tally);
	order = tally_order(j, &moment, veil, tally);
	tally_composites(j, tally);
	if (folder && (order || wrong > 300 || frame % 50 == 0))
		keep_picture(j, veil, folder, order ? "order" : of->name, frame, wrong);
}

static double rms(double sum, long count)
{
	return count ? sqrt(sum / (double)count) : 0;
}

static void print_case(const struct judged_case *of, const struct tally *t)
{
	printf("%s: %s; %d frames\n  wrong pixels a frame (of %ld looked at), of them missed:",
	       of->name, of->what, t->frames, t->place / t->frames);
	for (int m = 0; m < METHODS; m++)
		printf(" %s %.1f (%.1f)", m ? subtractor_names[m - 1] : "ours",
		       t->wrong[m] / t->frames, t->missed[m] / t->frames);
	printf("\n  order: %d wrong of %d before or behind the object, %d more unseen\n",
	       t->order_wrong, t->placed, t->unseen);
	printf("  RMS in levels, with and without the veil: outside %.2f %.2f, inside %.2f %.2f, edge %.2f %.2f\n",
	       rms(t->outside[0], t->outside_count), rms(t->outside[1], t->outside_count),
	       rms(t->inside[0], t->inside_count), rms(t->inside[1], t->inside_count),
	       rms(t->edge[0], t->edge_count), rms(t->edge[1], t->edge_count));
	printf("  people_look: %.2f ms of processor\n", 1e3 * t->look_s / t->frames);
	fflush(stdout);
}

int main(int argc, char **argv)
{
	const int frames = argc > 2 ? atoi(argv[2]) : 1000;
	const char *only = argc > 3 ? argv[3] : "";

	if (argc < 2 || frames < 1)
		die("expected BASIS.inlay [FRAMES [CASE [FOLDER [LATER_S]]]]");
	for (int i = 0; i < CASES; i++) {
		const struct judged_case *of = &cases[i];
		const int length = of->restless	      ? frames
				   : frames < 300     ? frames
				   : of->rate_hz == 1 ? 600
						      : 300;
		struct tally tally = {0};
		struct judged judged;

		if (*only && strcmp(only, of->name) != 0)
			continue;
		judged_open(&judged, of, argv[1]);
		judged.later_s = argc > 5 ? atof(argv[5]) : 0;
		for (int frame = 0; frame < LEARNING + length; frame++)
			judge_frame(&judged, of, frame, &tally,
				    argc > 4 && *argv[4] ? argv[4] : NULL);
		print_case(of, &tally);
		judged_close(&judged);
	}
	return 0;
}
