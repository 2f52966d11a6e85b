/* SPDX-License-Identifier: MIT */
/*
 * Measures what `inlay` made of the film against boxes that somebody else drew around all people.
 *     measure BASIS.inlay FILM.y4m SHOWN.y4m EMPTY.y4m BOXES.xml SHEET.png
 * SHOWN is the film with the object, EMPTY one frame of it for which nobody was looked for. The
 * sheet shows every crossing. README.md says what the figures mean.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sim/sim.h"
#include "hal/basis/basis.h"
#include "hal/frame/frame.h"
#include "hal/image/image.h"
#include "hal/optics/tsai.h"

enum {
	MOST_FRAMES = 4096,
	MOST_BOXES = 32,   /* of a frame */
	MOST_PEOPLE = 256, /* their numbers */
	MOST_CROSSINGS = 128,
	RATE_HZ = 10,
	GAP = 5,       /* frames for which a crossing may be interrupted */
	CONTRAST = 60, /* sum over R, G, B, that tells film, object and people apart */
	NEAR_PX = 12,  /* boxes are that exact, and shadows are not in them */
	ACROSS = 8,
	CROP = 160
};
#define OVERLAP_LEAST 0.01 /* of the object, that an order is judged by */
#define HIDDEN_MOST 0.003  /* of the object, that nobody may hide */
#define UNCLEAR_M 0.3	   /* feet are known that well */

struct box {
	int person;
	double x, y, width, height; /* its middle */
	int side;		    /* of the object: -1 before, 1 behind, 0 unclear */
};

struct crossing {
	int person, first, last, side, judged, wrong;
	int frame; /* which the sheet shows: the first wrong one, or that of the most overlap */
	int overlap;
	uint8_t *crop;
};

struct film {
	struct basis basis;
	struct tsai_camera camera;
	struct y4m film, shown, empty;
	struct canvas seen, out, object;
	struct box (*box)[MOST_BOXES];
	int *boxes, frames;
	int pixels, object_pixels, crop[2];
	int *object_pixel;   /* [object_pixels] */
	uint8_t (*place)[3]; /* [object_pixels]: the film's median, without people */
	double near_m, far_m, eye[3];
	struct crossing crossing[MOST_CROSSINGS];
	int crossings, open[MOST_PEOPLE];
	double hidden, hidden_most;
	int hidden_run, hidden_longest;
};

static void die(const char *what, const char *name)
{
	fprintf(stderr, "measure: %s %s\n", name, what);
	exit(1);
}

static void read_boxes(struct film *f, const char *path)
{
	FILE *file = fopen(path, "r");
	int frame = -1, person = -1;
	char line[512];

	if (!file)
		die("cannot be read", path);
	while (fgets(line, sizeof(line), file)) {
		const char *at = line + strspn(line, " \t");
		struct box box;

		if (sscanf(at, "<frame number=\"%d\"", &frame) == 1 ||
		    sscanf(at, "<object id=\"%d\"", &person) == 1)
			continue;
		if (sscanf(at, "<box h=\"%lf\" w=\"%lf\" xc=\"%lf\" yc=\"%lf\"", &box.height,
			   &box.width, &box.x, &box.y) != 4)
			continue;
		if (frame < 0 || frame >= MOST_FRAMES || person < 0 || person >= MOST_PEOPLE ||
		    f->boxes[frame] >= MOST_BOXES)
			die("holds more than expected", path);
		box.person = person;
		f->box[frame][f->boxes[frame]++] = box;
	}
	fclose(file);
}

/* ---- who stands where ---- */

static bool foot_holds(const struct basis_footprint *foot, double x, double y)
{
	const int i = (int)floor((x - (double)foot->corner[0]) / (double)foot->side);
	const int j = (int)floor((y - (double)foot->corner[1]) / (double)foot->side);

	return i >= 0 && j >= 0 && i < BASIS_FOOT_SQUARES && j < BASIS_FOOT_SQUARES &&
	       foot->row[j] >> i & 1;
}

/* Distances on the ground from the camera to the nearest and the farthest of the footprint. */
static void measure_foot(struct film *f)
{
	const struct basis_footprint *foot = f->basis.feet;

	f->near_m = INFINITY;
	for (int k = 0; k < BASIS_FOOT_SQUARES * BASIS_FOOT_SQUARES; k++) {
		const int i = k % BASIS_FOOT_SQUARES, j = k / BASIS_FOOT_SQUARES;
		const double x = (double)foot->corner[0] + (i + 0.5) * (double)foot->side;
		const double y = (double)foot->corner[1] + (j + 0.5) * (double)foot->side;
		const double d = hypot(x - f->eye[0], y - f->eye[1]);

		if (!(foot->row[j] >> i & 1))
			continue;
		f->near_m = fmin(f->near_m, d);
		f->far_m = fmax(f->far_m, d);
	}
}

/* Before or behind the footprint along the line of sight, or, beside it, all of it. */
static int side_of(const struct film *f, const struct box *box)
{
	const double px[2] = {box->x, box->y + box->height / 2};
	double eye[3], dir[3], flat, own, near = INFINITY, far = 0;

	if (tsai_ray(&f->camera, px, eye, dir) || dir[2] >= 0)
		return 0;
	flat = hypot(dir[0], dir[1]);
	own = eye[2] / -dir[2] * flat;
	for (double d = f->near_m - 1; d < f->far_m + 1; d += 0.01)
		if (foot_holds(f->basis.feet, eye[0] + dir[0] / flat * d,
			       eye[1] + dir[1] / flat * d)) {
			near = fmin(near, d);
			far = fmax(far, d);
		}
	if (far == 0) {
		near = f->near_m;
		far = f->far_m;
	}
	return own < near - UNCLEAR_M ? -1 : own > far + UNCLEAR_M ? 1 : 0;
}

static bool box_holds(const struct box *box, double x, double y, double more)
{
	return fabs(x + 0.5 - box->x) <= box->width / 2 + more &&
	       fabs(y + 0.5 - box->y) <= box->height / 2 + more;
}

/* ---- a frame ---- */

static const uint8_t *at(const struct canvas *canvas, int x, int y)
{
	return canvas->pixels + (size_t)y * canvas->stride + 4 * (size_t)x;
}

static int apart(const uint8_t *a, const uint8_t *b)
{
	return abs(a[0] - b[0]) + abs(a[1] - b[1]) + abs(a[2] - b[2]);
}

/* Whether the film is seen in a pixel of the object, and the two differ. */
static bool is_hidden(const struct film *f, int x, int y)
{
	const uint8_t *seen = at(&f->seen, x, y), *object = at(&f->object, x, y);
	const uint8_t *out = at(&f->out, x, y);

	return apart(seen, object) >= CONTRAST && apart(out, seen) < apart(out, object);
}

/* Whether a person is seen in the film in one of the object's pixels, where he differs from object
 * and place. */
static bool is_person(const struct film *f, int i, int x, int y)
{
	const uint8_t *seen = at(&f->seen, x, y);

	return apart(seen, f->place[i]) >= CONTRAST &&
	       apart(seen, at(&f->object, x, y)) >= CONTRAST;
}

static void keep_crop(const struct film *f, struct crossing *crossing, int frame, int overlap)
{
	crossing->frame = frame;
	crossing->overlap = overlap;
	if (!crossing->crop)
		crossing->crop = malloc((size_t)CROP * CROP * 3);
	for (int k = 0; crossing->crop && k < CROP * CROP; k++)
		for (int c = 0; c < 3; c++)
			crossing->crop[3 * k + c] = at(&f->out, f->crop[0] + k % CROP,
						       f->crop[1] + k / CROP)[2 - c];
}

static void judge_box(struct film *f, int frame, const struct box *box)
{
	const int side = side_of(f, box);
	int overlap = 0, hidden = 0;
	struct crossing *crossing;
	bool wrong;

	for (int i = 0; i < f->object_pixels; i++) {
		const int x = f->object_pixel[i] % f->camera.width;
		const int y = f->object_pixel[i] / f->camera.width;
		bool alone = box_holds(box, x, y, 0) && is_person(f, i, x, y);

		for (int n = 0; alone && n < f->boxes[frame]; n++)
			alone = &f->box[frame][n] == box || !box_holds(&f->box[frame][n], x, y, 0);
		overlap += alone;
		hidden += alone && is_hidden(f, x, y);
	}
	if (side == 0 || overlap < OVERLAP_LEAST * f->object_pixels)
		return;
	wrong = (side < 0) != (2 * hidden > overlap);
	crossing = f->open[box->person] ? &f->crossing[f->open[box->person] - 1] : NULL;
	if (!crossing || frame - crossing->last > GAP || crossing->side != side) {
		if (f->crossings == MOST_CROSSINGS)
			die("holds more crossings than expected", "the film");
		crossing = &f->crossing[f->crossings++];
		f->open[box->person] = f->crossings;
		*crossing = (struct crossing){.person = box->person, .first = frame, .side = side};
	}
	crossing->last = frame;
	crossing->judged++;
	if (wrong ? !crossing->wrong : !crossing->wrong && overlap > crossing->overlap)
		keep_crop(f, crossing, frame, overlap);
	crossing->wrong += wrong;
}

static void judge_frame(struct film *f, int frame)
{
	int hidden = 0;
	double share;

	for (int i = 0; i < f->boxes[frame]; i++)
		judge_box(f, frame, &f->box[frame][i]);
	for (int i = 0; i < f->object_pixels; i++) {
		const int x = f->object_pixel[i] % f->camera.width;
		const int y = f->object_pixel[i] / f->camera.width;
		bool nobody = is_hidden(f, x, y);

		for (int n = 0; nobody && n < f->boxes[frame]; n++)
			nobody = !box_holds(&f->box[frame][n], x, y, NEAR_PX);
		hidden += nobody;
	}
	share = (double)hidden / f->object_pixels;
	f->hidden += share;
	f->hidden_most = fmax(f->hidden_most, share);
	f->hidden_run = share > HIDDEN_MOST ? f->hidden_run + 1 : 0;
	if (f->hidden_run > f->hidden_longest)
		f->hidden_longest = f->hidden_run;
}

/* ---- the whole ---- */

static bool next_picture(struct y4m *video, struct canvas *canvas)
{
	struct fault fault = {{0}};
	const int err = y4m_next(video, &fault);

	if (err && *fault.text)
		die(fault.text, "");
	if (!err)
		y4m_decode(video, MATRIX_BT601, video->range, canvas);
	return !err;
}

static void film_open(struct film *f, char **argv)
{
	struct fault fault = {{0}};
	double px[2] = {0}, dir[3];

	if (basis_open(&f->basis, argv[1], BASIS_SHOWN, &fault) ||
	    tsai_read_text(f->basis.camera, &f->camera, &fault) ||
	    y4m_open(&f->film, argv[2], &fault) || y4m_open(&f->shown, argv[3], &fault) ||
	    y4m_open(&f->empty, argv[4], &fault))
		die(fault.text, "");
	if (f->film.width != f->camera.width || f->film.height != f->camera.height ||
	    f->shown.width != f->camera.width || f->shown.height != f->camera.height ||
	    !f->basis.feet)
		die("does not fit the film", argv[1]);
	f->pixels = f->camera.width * f->camera.height;
	f->box = calloc(MOST_FRAMES, sizeof(*f->box));
	f->boxes = calloc(MOST_FRAMES, sizeof(*f->boxes));
	if (!f->box || !f->boxes || canvas_create(&f->seen, f->camera.width, f->camera.height) ||
	    canvas_create(&f->out, f->camera.width, f->camera.height) ||
	    canvas_create(&f->object, f->camera.width, f->camera.height))
		die("not enough memory", "");
	read_boxes(f, argv[5]);
	f->object_pixel = calloc((size_t)f->pixels, sizeof(int));
	f->place = calloc((size_t)f->pixels, sizeof(*f->place));
	if (!f->object_pixel || !f->place)
		die("not enough memory", "");
	for (int k = 0; k < f->pixels; k++)
		if (f->basis.poses[0].coverage[k] > 64000) { /* nothing shines through */
			f->object_pixel[f->object_pixels++] = k;
			px[0] += k % f->camera.width;
			px[1] += k / f->camera.width;
		}
	for (int i = 0; i < 2; i++) {
		const int most = (i ? f->camera.height : f->camera.width) - CROP;

		px[i] /= f->object_pixels;
		f->crop[i] = (int)fmin(fmax(px[i] - CROP / 2, 0), most);
	}
	if (tsai_ray(&f->camera, px, f->eye, dir))
		die("does not see its object", argv[1]);
	measure_foot(f);
	if (!next_picture(&f->empty, &f->object))
		die("is empty", argv[4]);
}

/* The place without people, as nobody stands long enough to be the median. */
static void learn_place(struct film *f)
{
	uint16_t(*count)[3][256] = calloc((size_t)f->object_pixels, sizeof(*count));
	struct fault fault = {{0}};
	int frames = 0;

	if (!count)
		die("not enough memory", "");
	for (; next_picture(&f->film, &f->seen); frames++)
		for (int i = 0; i < f->object_pixels; i++) {
			const uint8_t *seen = at(&f->seen, f->object_pixel[i] % f->camera.width,
						 f->object_pixel[i] / f->camera.width);

			for (int c = 0; c < 3; c++)
				count[i][c][seen[c]]++;
		}
	for (int i = 0; i < f->object_pixels; i++)
		for (int c = 0; c < 3; c++) {
			int value = 0;

			for (int below = count[i][c][0]; 2 * below < frames; value++)
				below += count[i][c][value + 1];
			f->place[i][c] = (uint8_t)value;
		}
	free(count);
	if (y4m_rewind(&f->film, &fault))
		die(fault.text, "");
}

static void write_sheet(const struct film *f, const char *path)
{
	const int down = (f->crossings + ACROSS - 1) / ACROSS, border = 3;
	struct image image = {.width = ACROSS * CROP, .height = down * CROP};
	struct fault fault = {{0}};

	image.u8 = calloc((size_t)image.width * (size_t)image.height + 1, 3);
	for (int n = 0; image.u8 && n < f->crossings; n++)
		for (int k = 0; f->crossing[n].crop && k < CROP * CROP; k++) {
			const int x = k % CROP, y = k / CROP;
			const bool edge = x < border || y < border || x >= CROP - border ||
					  y >= CROP - border;
			uint8_t *to = image.u8 + 3 * ((n / ACROSS * CROP + y) * image.width +
						      n % ACROSS * CROP + x);

			memcpy(to, f->crossing[n].crop + 3 * k, 3);
			if (edge) { /* red: wrong in any frame, white: before, grey: behind */
				memset(to, f->crossing[n].side < 0 ? 255 : 120, 3);
				if (f->crossing[n].wrong)
					memcpy(to, (uint8_t[]){255, 0, 0}, 3);
			}
		}
	if (!image.u8 || image_write(path, &image, &fault))
		die(fault.text, "");
	image_free(&image);
}

static void print_figures(const struct film *f)
{
	int wrong = 0, wrong_frames = 0, judged = 0, before = 0;

	for (int n = 0; n < f->crossings; n++) {
		const struct crossing *c = &f->crossing[n];

		wrong += c->wrong > 0;
		wrong_frames += c->wrong;
		judged += c->judged;
		before += c->side < 0;
		printf("crossing %2d: person %2d %s, frames %3d to %3d: %d of %d wrong\n", n + 1,
		       c->person, c->side < 0 ? "before" : "behind", c->first, c->last, c->wrong,
		       c->judged);
	}
	printf("%d frames, %d crossings (%d before, %d behind)\n", f->frames, f->crossings, before,
	       f->crossings - before);
	printf("order wrong in any frame: %d crossings (%.1f %%), %d of %d frames\n", wrong,
	       100.0 * wrong / fmax(f->crossings, 1), wrong_frames, judged);
	printf("object hidden by nobody: %.3f %% of it on average, at most %.2f %%, above 0.3 %% for %.1f s at most\n",
	       100 * f->hidden / fmax(f->frames, 1), 100 * f->hidden_most,
	       (double)f->hidden_longest / RATE_HZ);
}

int main(int argc, char **argv)
{
	static struct film film;

	if (argc != 7)
		die("expected BASIS FILM SHOWN EMPTY BOXES SHEET", "");
	film.film.fd = film.shown.fd = film.empty.fd = -1;
	film_open(&film, argv);
	learn_place(&film);
	while (film.frames < MOST_FRAMES && next_picture(&film.film, &film.seen) &&
	       next_picture(&film.shown, &film.out)) {
		/* The upper left corner holds nothing but the film. */
		if (apart(at(&film.seen, 8, 8), at(&film.out, 8, 8)) > 24)
			die("is not the film, frame by frame", argv[3]);
		judge_frame(&film, film.frames++);
	}
	print_figures(&film);
	write_sheet(&film, argv[6]);
	for (int n = 0; n < film.crossings; n++)
		free(film.crossing[n].crop);
	y4m_close(&film.film);
	y4m_close(&film.shown);
	y4m_close(&film.empty);
	canvas_free(&film.seen);
	canvas_free(&film.out);
	canvas_free(&film.object);
	free(film.object_pixel);
	free(film.place);
	free(film.box);
	free(film.boxes);
	basis_close(&film.basis);
	return 0;
}
