/* SPDX-License-Identifier: MIT */
/*
 * inlay beside other ways to make the same frame, on one thread, in turns: pictures of the object
 * and of the ground under each light, which the exact layer gives one light at a time, and a frame
 * is their sum times the light, mixed with the background and encoded.
 *
 *     peers BASIS PANORAMA        Markdown; the basis has an exact layer
 */
#include <cblas.h>
#include <errno.h>
#include <lapacke.h>
#include <libyuv.h>
#include <math.h>
#include <pixman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "hal/measure/measure.h"
#include "hal/measure/thesis.h"
#include "tests/bench/peers_sums.h"

enum { REPEAT = 25, CODES = 65536, TILE = BASIS_TILE, TILE_PIXELS = TILE * TILE };

/* Code of the background under which the ground's pictures are taken: half of it leaves room for
 * what the object reflects. */
#define HALF 128

/* Singular values are kept until what is left is a quarter of a code value of white, RMS, in the
 * light of the panorama: rounding is 0.29. */
#define RANK_ERROR (0.25 / 255)

enum kind { OBJECT, GROUND, KINDS };

/* A tile's pictures as U V: rows are kinds, channels, pixels. */
struct tile_terms {
	int x, y, rank;
	float *u, *v; /* [KINDS * 3 * TILE_PIXELS][rank], [rank][lights] */
};

struct peers {
	struct basis basis;
	struct scope scope;
	struct pool *pool;
	struct compositor *compositor;
	struct light_selection lights;
	struct thesis *thesis;
	const float (*radiance)[3];
	float *light[3]; /* [lights]: of each channel */
	int width, height, count, pixels;
	struct canvas background, out;
	/* What a light of radiance 1 gives each pixel: O, and (1 - coverage) ratio u. */
	float *picture[KINDS][3]; /* [lights][pixels] */
	float *matrix[KINDS][3];  /* [pixels][lights] */
	float *sum[KINDS][3];	  /* [pixels] */
	double u[3];		  /* sum of u L */
	struct tile_terms *terms; /* [tiles] */
	int tiles;
	double *truth; /* [height][width][3] */
	float decode[256];
	uint8_t *encode; /* [CODES]: of linear light times CODES - 1 */
	uint8_t *ready;	 /* [height][width]: BGRA, premultiplied: a picture that is laid over */
};

static void *need(size_t count, size_t size)
{
	void *memory = calloc(count, size);

	if (!memory) {
		fprintf(stderr, "peers: out of memory\n");
		exit(1);
	}
	return memory;
}

static void must(int err, const struct fault *fault, const char *what)
{
	if (!err)
		return;
	fprintf(stderr, "peers: %s\n", fault && *fault->text ? fault->text : what);
	exit(1);
}

/* ---- pictures of each light ---- */

/* Takes the linear picture of one light on a background of one code, 0 to 1. */
static void take_picture(struct peers *p, int light, int code, double *out)
{
	struct compositor_settings settings = background_settings(COMPOSITOR_EXACT);
	struct light_selection one;
	float(*radiance)[3] = need((size_t)p->count, sizeof(*radiance));
	struct view whole = {.width = p->width, .height = p->height, .squash = 1};
	struct picture background;

	settings.background.named = settings.output.named = TRANSFER_LINEAR;
	for (int c = 0; c < 3; c++)
		radiance[light][c] = 1;
	memset(p->out.pixels, code, p->out.stride * (size_t)p->height);
	background = view_picture(&whole, p->out.pixels, p->out.stride);
	must(light_selection_create(&one, &p->basis), NULL, "out of memory");
	light_selection_choose(&one, &p->basis, 0, (const float(*)[3])radiance, 0, THRESHOLD_DROP,
			       1);
	must(compositor_reference(&p->basis, 0, &settings, &one, &background, out), NULL,
	     "no reference");
	light_selection_free(&one);
	free(radiance);
}

static void take_pictures(struct peers *p)
{
	const size_t n = (size_t)p->pixels;
	double *dark = need(3 * n, sizeof(double)), *lit = need(3 * n, sizeof(double));

	for (int k = 0; k < KINDS * 3; k++) {
		p->picture[k / 3][k % 3] = need(n * (size_t)p->count, sizeof(float));
		p->matrix[k / 3][k % 3] = need(n * (size_t)p->count, sizeof(float));
		p->sum[k / 3][k % 3] = need(n, sizeof(float));
	}
	for (int i = 0; i < p->count; i++) {
		take_picture(p, i, 0, dark);
		take_picture(p, i, HALF, lit);
		for (int c = 0; c < 3; c++) {
			const double u = basis_ground(&p->basis, 0, c)[i];

			for (size_t k = 0; k < n; k++) {
				const double object = dark[3 * k + (size_t)c] / 255;
				const double ground =
					u * (lit[3 * k + (size_t)c] - dark[3 * k + (size_t)c]) /
					HALF;

				p->picture[OBJECT][c][(size_t)i * n + k] = (float)object;
				p->picture[GROUND][c][(size_t)i * n + k] = (float)ground;
				p->matrix[OBJECT][c][k * (size_t)p->count + (size_t)i] =
					(float)object;
				p->matrix[GROUND][c][k * (size_t)p->count + (size_t)i] =
					(float)ground;
			}
		}
	}
	free(dark);
	free(lit);
}

/* ---- tile by tile ---- */

static int rank_of(const struct peers *p, const float *s, int most)
{
	double light = 0;
	int rank = 0;

	for (int i = 0; i < p->count; i++)
		for (int c = 0; c < 3; c++)
			light += (double)p->light[c][i] * (double)p->light[c][i] / 3;
	while (rank < most && (double)s[rank] * sqrt(light / (3.0 * TILE_PIXELS)) > RANK_ERROR)
		rank++;
	return rank;
}

static void take_terms(struct peers *p, struct tile_terms *t)
{
	const int rows = KINDS * 3 * TILE_PIXELS, n = p->count;
	float *a = need((size_t)rows * (size_t)n, sizeof(float)), *s = need((size_t)n, sizeof(*s));
	float *u = need((size_t)rows * (size_t)n, sizeof(*u)),
	      *v = need((size_t)n * (size_t)n, sizeof(*v));

	for (int r = 0; r < rows; r++) {
		const int x = t->x + r % TILE, y = t->y + r % TILE_PIXELS / TILE;
		const int k = r / TILE_PIXELS;

		if (x < p->width && y < p->height)
			memcpy(a + (size_t)r * (size_t)n,
			       p->matrix[k / 3][k % 3] + (size_t)(y * p->width + x) * (size_t)n,
			       sizeof(*a) * (size_t)n);
	}
	must(LAPACKE_sgesdd(LAPACK_ROW_MAJOR, 'S', rows, n, a, n, s, u, n, v, n), NULL, "no SVD");
	t->rank = rank_of(p, s, n);
	t->u = need((size_t)rows * (size_t)t->rank + 1, sizeof(*t->u));
	t->v = need((size_t)n * (size_t)t->rank + 1, sizeof(*t->v));
	for (int r = 0; r < rows; r++)
		for (int k = 0; k < t->rank; k++)
			t->u[r * t->rank + k] = u[r * n + k] * s[k];
	memcpy(t->v, v, sizeof(*v) * (size_t)(t->rank * n));
	free(a);
	free(s);
	free(u);
	free(v);
}

static void take_tiles(struct peers *p)
{
	p->tiles = p->basis.tiles_across * p->basis.tiles_down;
	p->terms = need((size_t)p->tiles, sizeof(*p->terms));
	for (int t = 0; t < p->tiles; t++) {
		p->terms[t].x = t % p->basis.tiles_across * TILE;
		p->terms[t].y = t / p->basis.tiles_across * TILE;
		take_terms(p, &p->terms[t]);
	}
}

/* ---- ways ---- */

static const uint8_t *background_at(const struct peers *p, int y)
{
	return p->background.pixels + (size_t)y * p->background.stride;
}

/* Mixes the sums with the background, and encodes them. */
static void mix(struct peers *p)
{
	for (int y = 0; y < p->height; y++) {
		const uint8_t *from = background_at(p, y);
		uint8_t *to = p->out.pixels + (size_t)y * p->out.stride;

		for (int x = 0, k = y * p->width; x < p->width; x++, k++)
			for (int c = 0; c < 3; c++) {
				const float ground = fmaxf(p->sum[GROUND][c][k], 0) /
						     (float)p->u[c];
				const float light = p->sum[OBJECT][c][k] +
						    ground * p->decode[from[4 * x + 2 - c]];

				to[4 * x + 2 - c] = p->encode[(
					int)(fminf(fmaxf(light, 0), 1) * (CODES - 1) + 0.5F)];
			}
	}
}

static void run_inlay(struct peers *p, enum compositor_mode mode)
{
	const struct compositor_settings settings = background_settings(mode);
	const struct view whole = {.width = p->width, .height = p->height, .squash = 1};
	const struct picture background = view_picture(&whole, p->background.pixels,
						       p->background.stride);
	const struct backdrop backdrop = backdrop_of(&background);

	compositor_set(p->compositor, &settings);
	light_selection_choose(&p->lights, &p->basis, 0, p->radiance, 0, THRESHOLD_DROP, 1);
	must(compositor_run(p->compositor, 0, &p->lights, &backdrop, p->out.pixels, p->out.stride),
	     NULL, "the compositor fails");
}

static void run_fast(struct peers *p)
{
	run_inlay(p, COMPOSITOR_FAST);
}

static void run_exact(struct peers *p)
{
	run_inlay(p, COMPOSITOR_EXACT);
}

static void run_thesis(struct peers *p)
{
	thesis_run(p->thesis, &p->background, &p->out, p->pool);
}

static void run_matrix(struct peers *p)
{
	for (int k = 0; k < KINDS * 3; k++)
		cblas_sgemv(CblasRowMajor, CblasNoTrans, p->pixels, p->count, 1,
			    p->matrix[k / 3][k % 3], p->count, p->light[k % 3], 1, 0,
			    p->sum[k / 3][k % 3], 1);
	mix(p);
}

static void run_terms(struct peers *p)
{
	float y[3][2048], values[TILE_PIXELS];

	for (int t = 0; t < p->tiles; t++) {
		const struct tile_terms *w = &p->terms[t];
		const int across = p->width - w->x < TILE ? p->width - w->x : TILE;

		for (int c = 0; c < 3 && w->rank; c++)
			cblas_sgemv(CblasRowMajor, CblasNoTrans, w->rank, p->count, 1, w->v,
				    p->count, p->light[c], 1, 0, y[c], 1);
		for (int k = 0; k < KINDS * 3; k++) {
			memset(values, 0, sizeof(values));
			if (w->rank)
				cblas_sgemv(CblasRowMajor, CblasNoTrans, TILE_PIXELS, w->rank, 1,
					    w->u + (size_t)(k * TILE_PIXELS * w->rank), w->rank,
					    y[k % 3], 1, 0, values, 1);
			for (int n = 0; n < TILE && w->y + n < p->height; n++)
				memcpy(p->sum[k / 3][k % 3] + (w->y + n) * p->width + w->x,
				       values + n * TILE, sizeof(*values) * (size_t)across);
		}
	}
	mix(p);
}

static void run_scale_add(struct peers *p)
{
	for (int k = 0; k < KINDS * 3; k++) {
		memset(p->sum[k / 3][k % 3], 0, sizeof(float) * (size_t)p->pixels);
		for (int i = 0; i < p->count; i++)
			peers_scale_add(p->picture[k / 3][k % 3] + (size_t)i * (size_t)p->pixels,
					(double)p->light[k % 3][i], p->sum[k / 3][k % 3],
					p->pixels);
	}
	mix(p);
}

static pixman_image_t *image_of(pixman_format_code_t format, int width, int height, void *pixels,
				size_t stride)
{
	return pixman_image_create_bits_no_clear(format, width, height, pixels, (int)stride);
}

static void run_pixman(struct peers *p)
{
	pixman_image_t *over = image_of(PIXMAN_a8r8g8b8, p->width, p->height, p->ready,
					4 * (size_t)p->width);
	pixman_image_t *under = image_of(PIXMAN_x8r8g8b8, p->width, p->height, p->background.pixels,
					 p->background.stride);
	pixman_image_t *to = image_of(PIXMAN_x8r8g8b8, p->width, p->height, p->out.pixels,
				      p->out.stride);

	pixman_image_composite32(PIXMAN_OP_SRC, under, NULL, to, 0, 0, 0, 0, 0, 0, p->width,
				 p->height);
	pixman_image_composite32(PIXMAN_OP_OVER, over, NULL, to, 0, 0, 0, 0, 0, 0, p->width,
				 p->height);
	pixman_image_unref(over);
	pixman_image_unref(under);
	pixman_image_unref(to);
}

static void run_libyuv(struct peers *p)
{
	ARGBBlend(p->ready, 4 * p->width, p->background.pixels, (int)p->background.stride,
		  p->out.pixels, (int)p->out.stride, p->width, p->height);
}

/* ---- the table ---- */

enum shows { FRAME, LINEAR_FRAME, NO_FRAME };

static double layer_mb(const struct peers *p, const struct basis_layer *layer)
{
	double bytes = 0;

	for (int t = 0; t < p->tiles; t++)
		bytes += (double)layer->tiles[t].bytes;
	return bytes / 1e6;
}

static double fast_mb(const struct peers *p)
{
	return layer_mb(p, &p->basis.poses[0].shown);
}

static double exact_mb(const struct peers *p)
{
	return layer_mb(p, &p->basis.poses[0].exact);
}

static double thesis_mb(const struct peers *p)
{
	return (double)thesis_bytes(p->thesis, p->count) / 1e6;
}

static double pictures_mb(const struct peers *p)
{
	return (double)KINDS * 3 * p->pixels * p->count * (double)sizeof(float) / 1e6;
}

static double terms_mb(const struct peers *p)
{
	double values = 0;

	for (int t = 0; t < p->tiles; t++)
		values += (double)p->terms[t].rank * (KINDS * 3 * TILE_PIXELS + p->count);
	return values * (double)sizeof(float) / 1e6;
}

static double ready_mb(const struct peers *p)
{
	return 4.0 * p->pixels / 1e6;
}

static const struct way {
	const char *name;
	void (*run)(struct peers *peers);
	double (*mb)(const struct peers *peers);
	enum shows shows;
} ways[] = {
	{"**inlay, fast**", run_fast, fast_mb, FRAME},
	{"inlay, exact", run_exact, exact_mb, FRAME},
	{"the thesis's algorithm, double precision", run_thesis, thesis_mb, LINEAR_FRAME},
	{"OpenBLAS, float32, matrix times light (as numpy does it)", run_matrix, pictures_mb,
	 FRAME},
	{"OpenBLAS, float32, SVD of each 16x16 tile", run_terms, terms_mb, FRAME},
	{"OpenCV `scaleAdd`, float32, a picture for each light", run_scale_add, pictures_mb, FRAME},
	{"a ready picture laid over, pixman `OVER`", run_pixman, ready_mb, NO_FRAME},
	{"a ready picture laid over, libyuv `ARGBBlend`", run_libyuv, ready_mb, NO_FRAME},
};
enum { WAYS = sizeof(ways) / sizeof(*ways) };

static int prepare_way(void *context, int way, int turn)
{
	(void)context;
	(void)way;
	(void)turn;
	return 0;
}

static int run_way(void *context, int way)
{
	ways[way].run(context);
	return 0;
}

static void take_truth(struct peers *p, enum transfer transfer)
{
	struct compositor_settings settings = background_settings(COMPOSITOR_EXACT);
	const struct view whole = {.width = p->width, .height = p->height, .squash = 1};
	const struct picture background = view_picture(&whole, p->background.pixels,
						       p->background.stride);

	settings.background.named = settings.output.named = transfer;
	must(compositor_reference(&p->basis, 0, &settings, &p->lights, &background, p->truth), NULL,
	     "no reference");
}

static struct composite_error judge(struct peers *p, const struct way *way)
{
	const enum transfer transfer = way->shows == FRAME ? TRANSFER_SRGB : TRANSFER_LINEAR;
	const struct view whole = {.width = p->width, .height = p->height, .squash = 1};
	const struct picture background = view_picture(&whole, p->background.pixels,
						       p->background.stride);

	take_truth(p, transfer);
	way->run(p);
	return error_measure(&p->scope, p->truth, &p->out, &background, transfer);
}

static void print_table(struct peers *p)
{
	double *ms = need((size_t)WAYS * REPEAT, sizeof(*ms)), first = 0;
	struct turns turns = {.context = p,
			      .ways = WAYS,
			      .repeat = REPEAT,
			      .prepare = prepare_way,
			      .run = run_way};

	must(turns_time(&turns, ms), NULL, "no times");
	printf("| way | ms a frame | x inlay | MB | PSNR dB | max levels |\n|---|---|---|---|---|---|\n");
	for (int w = 0; w < WAYS; w++) {
		const struct turns_spread spread = turns_spread(ms + w * REPEAT, REPEAT);
		const struct way *way = &ways[w];

		first = w ? first : spread.median;
		printf("| %s | %.2f | %.3g | %.1f | ", way->name, spread.median,
		       spread.median / first, way->mb(p));
		if (way->shows == NO_FRAME) {
			printf("| |\n");
		} else {
			const struct composite_error error = judge(p, way);

			printf("%.1f%s | %.1f |\n", error.psnr_db,
			       way->shows == FRAME ? "" : " (linear)", error.max);
		}
	}
	free(ms);
}

/* ---- setting up ---- */

static void fill_curves(struct peers *p)
{
	const struct transfer_curve curve = {.named = TRANSFER_SRGB};

	p->encode = need(CODES, 1);
	for (int k = 0; k < 256; k++)
		p->decode[k] = (float)transfer_curve_decode(&curve, k / 255.0);
	for (int k = 0; k < CODES; k++)
		p->encode[k] =
			(uint8_t)lrint(255 * transfer_curve_encode(&curve, k / (CODES - 1.0)));
}

/* What inlay shows, opaque where the object is and a quarter opaque where its shadow is. */
static void fill_ready(struct peers *p)
{
	p->ready = need(4 * (size_t)p->pixels, 1);
	run_fast(p);
	for (int k = 0; k < p->pixels; k++) {
		const uint8_t *from = p->out.pixels + (size_t)(k / p->width) * p->out.stride +
				      4 * (size_t)(k % p->width);

		memcpy(p->ready + 4 * k, from, 3);
		p->ready[4 * k + 3] = p->scope.pixel[k] == SCOPE_UNTOUCHED ? 0 : 255;
		if (p->scope.pixel[k] == SCOPE_SHADOW) {
			memset(p->ready + 4 * k, 0, 3);
			p->ready[4 * k + 3] = 64;
		}
	}
}

static void set_up(struct peers *p, const char *basis, const char *panorama,
		   struct lightings *lightings)
{
	struct fault fault = {.text = ""};
	struct compositor_options options = {.pool = NULL};

	must(basis_open(&p->basis, basis, BASIS_ALL, &fault), &fault, basis);
	p->width = (int)p->basis.info.width;
	p->height = (int)p->basis.info.height;
	p->count = (int)p->basis.info.lights;
	p->pixels = p->width * p->height;
	if (!p->basis.poses[0].exact.tiles || p->basis.info.grounds != 1)
		must(-EINVAL, NULL, "expected a basis with an exact layer on flat ground");
	must(lightings_add_panorama(lightings, &p->basis, panorama, &fault), &fault, panorama);
	must(pool_create(&p->pool, 1), NULL, "no thread");
	must(compositor_create(&p->compositor, &p->basis, &options, &fault), &fault, "compositor");
	must(light_selection_create(&p->lights, &p->basis), NULL, "out of memory");
	must(canvas_create(&p->background, p->width, p->height), NULL, "out of memory");
	must(canvas_create(&p->out, p->width, p->height), NULL, "out of memory");
	must(scope_create(&p->scope, &p->basis, &p->basis.poses[0].exact), NULL, "out of memory");
	p->truth = need(3 * (size_t)p->pixels, sizeof(*p->truth));
	background_fill(&p->background);
	p->radiance = lighting_member(&lightings->item[0], &p->basis, 0);
	light_selection_choose(&p->lights, &p->basis, 0, p->radiance, 0, THRESHOLD_DROP, 1);
	for (int c = 0; c < 3; c++) {
		p->light[c] = need((size_t)p->count, sizeof(float));
		for (int i = 0; i < p->count; i++) {
			p->light[c][i] = p->radiance[i][c];
			p->u[c] += basis_ground(&p->basis, 0, c)[i] * (double)p->radiance[i][c];
		}
	}
	must(thesis_create(&p->thesis, &p->basis, &p->basis.poses[0].exact, p->pool, &fault),
	     &fault, "thesis");
	thesis_light(p->thesis, &p->lights);
	fill_curves(p);
	fill_ready(p);
}

int main(int argc, char **argv)
{
	struct lightings lightings = {.count = 0};
	struct peers p = {.width = 0};

	if (argc != 3) {
		fprintf(stderr, "usage: peers BASIS PANORAMA\n");
		return 2;
	}
	openblas_set_num_threads(1);
	peers_one_thread();
	set_up(&p, argv[1], argv[2], &lightings);
	take_pictures(&p);
	take_tiles(&p);
	print_table(&p);
	return 0;
}
