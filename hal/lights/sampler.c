#include "hal/lights/sampler.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/sampler_table.h"

const char *const light_estimator_names[] = {"cell", "node", NULL};

/* Linear 1.0 of a decoded code value, which is kept less half of the range. */
#define VALUE_MAX 65535
#define VALUE_BIAS 32768

struct sums {
	int64_t plane[SAMPLER_PLANES];
};

/* What one thread decodes a strip into. */
struct scratch {
	int16_t *planes;
	uint32_t *row;
};

struct light_sampler {
	struct sampler_table table;
	const struct sampler_kernels *kernels;
	int width, height;
	double gain;
	struct sampler_decode decode;
	double *sky_share;     /* [lights]: solid angle over 2 pi */
	struct sums *of_parts; /* [parts] */
	struct sums *of_all;   /* [sums] */
	double (*linear)[3];   /* [sums] */
	struct scratch *scratch;
	int scratches;
};

static int check_settings(const struct light_sampler_settings *s, int width, int height,
			  struct fault *fault)
{
	if (width < 1 || height < 1 || width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX)
		return fault_say(fault, -EINVAL,
				 "fisheye: the picture is %d x %d, expected sides of 1 to %d",
				 width, height, IMAGE_SIDE_MAX);
	if (s->estimator < 0 || s->estimator >= ESTIMATOR_COUNT)
		return fault_say(fault, -EINVAL,
				 "fisheye: estimator %d is unknown, expected cell or node",
				 (int)s->estimator);
	if (s->transfer < 0 || s->transfer >= TRANSFER_COUNT)
		return fault_say(fault, -EINVAL,
				 "fisheye: transfer %d is unknown, expected srgb, bt709 or linear",
				 (int)s->transfer);
	if (s->black_level < 0 || s->black_level > 254)
		return fault_say(fault, -EINVAL, "fisheye: black level is %d, expected 0 to 254",
				 s->black_level);
	if (!(s->gain >= 0) || !isfinite(s->gain))
		return fault_say(fault, -EINVAL,
				 "fisheye: gain is %g, expected a finite number of at least 0",
				 s->gain);
	return 0;
}

static void fill_decode(struct sampler_decode *decode, enum transfer transfer, int black)
{
	for (int c = 0; c < 256; c++) {
		const double code = (double)(c - black) / (255 - black);
		const long value = lrint(VALUE_MAX * transfer_decode(transfer, code));

		decode->value[c] = (int16_t)(value - VALUE_BIAS);
		decode->wide[c] = decode->value[c];
		decode->low[c] = (uint8_t)(decode->value[c] & 255);
		decode->high[c] = (uint8_t)(decode->value[c] >> 8 & 255);
	}
}

static size_t plane_values(const struct light_sampler *s)
{
	return (size_t)s->table.row_stride * SAMPLER_STRIP_ROWS;
}

/* For so many threads. What there is stays: nothing is allocated for a second frame. */
static int grow_scratch(struct light_sampler *s, int threads)
{
	struct scratch *more;

	if (threads <= s->scratches)
		return 0;
	more = realloc(s->scratch, (size_t)threads * sizeof(*more));
	if (!more)
		return -ENOMEM;
	s->scratch = more;
	for (; s->scratches < threads; s->scratches++) {
		const size_t bytes = plane_values(s) * SAMPLER_PLANES * sizeof(*more->planes);
		const size_t row = ((size_t)s->width * sizeof(*more->row) + 63) / 64 * 64;

		more = &s->scratch[s->scratches];
		more->planes = aligned_alloc(64, bytes);
		more->row = aligned_alloc(64, row);
		if (!more->planes || !more->row) {
			free(more->planes);
			free(more->row);
			return -ENOMEM;
		}
		memset(more->planes, 0, bytes); /* values without weight are read too */
	}
	return 0;
}

static int make_table(struct light_sampler *s, const struct dome *dome, const struct fisheye *lens,
		      enum light_estimator estimator)
{
	struct sampler_shares shares;
	int ret;

	ret = sampler_shares_create(&shares, dome, lens, s->width, s->height, estimator);
	if (ret < 0)
		return ret;
	ret = sampler_table_create(&s->table, &shares, dome->count, s->width, s->height);
	sampler_shares_free(&shares);
	return ret;
}

static int fill_sampler(struct light_sampler *s, const struct dome *dome,
			const struct fisheye *lens, enum light_estimator estimator)
{
	const int ret = make_table(s, dome, lens, estimator);

	if (ret < 0)
		return ret;
	s->sky_share = calloc((size_t)dome->count, sizeof(*s->sky_share));
	s->of_parts = calloc((size_t)s->table.parts + 1, sizeof(*s->of_parts));
	s->of_all = calloc((size_t)s->table.sums + 1, sizeof(*s->of_all));
	s->linear = calloc((size_t)s->table.sums + 1, sizeof(*s->linear));
	if (!s->sky_share || !s->of_parts || !s->of_all || !s->linear)
		return -ENOMEM;
	for (int i = 0; i < dome->count; i++)
		s->sky_share[i] = dome->solid_angle_sr[i] / (2 * M_PI);
	return grow_scratch(s, 1);
}

int light_sampler_create(struct light_sampler **out, const struct dome *dome,
			 const struct fisheye *lens, int width, int height,
			 const struct light_sampler_settings *settings, struct fault *fault)
{
	struct light_sampler *s;
	int ret;

	*out = NULL;
	ret = check_settings(settings, width, height, fault);
	if (ret < 0)
		return ret;
	s = calloc(1, sizeof(*s));
	if (!s)
		return fault_say(fault, -ENOMEM, "fisheye: out of memory");
	s->width = width;
	s->height = height;
	s->gain = settings->gain;
	s->kernels = sampler_kernels_choose();
	fill_decode(&s->decode, settings->transfer, settings->black_level);
	ret = fill_sampler(s, dome, lens, settings->estimator);
	if (ret < 0) {
		light_sampler_destroy(s);
		return fault_say(fault, ret, "fisheye: cannot make the light sampler: %s",
				 strerror(-ret));
	}
	*out = s;
	return 0;
}

/* ---- a frame ---- */

struct pass {
	struct light_sampler *sampler;
	const struct frame_reader *reader;
};

/* Whether anything of it is clipped. */
static bool decode_strip(const struct pass *pass, int strip, const struct scratch *scratch)
{
	const struct light_sampler *s = pass->sampler;
	const struct sampler_table *t = &s->table;
	const struct sampler_strip *which = &t->strip[strip];
	bool clipped = false;

	for (int k = 0; k < which->segments; k++) {
		const struct sampler_segment *g = &t->segment[which->first_segment + k];

		if (k + 1 < which->segments)
			frame_reader_prefetch(pass->reader, g[1].x,
					      strip * SAMPLER_STRIP_ROWS + g[1].row, g[1].count);
		const uint32_t *pixels = frame_reader_row(pass->reader, g->x,
							  strip * SAMPLER_STRIP_ROWS + g->row,
							  g->count, scratch->row);

		clipped |= s->kernels->decode(&s->decode, pixels, g->count,
					      scratch->planes +
						      (size_t)g->row * (size_t)t->row_stride + g->x,
					      plane_values(s));
	}
	return clipped;
}

static void read_strip(void *context, int strip, int worker)
{
	const struct pass *pass = context;
	struct light_sampler *s = pass->sampler;
	const struct sampler_table *t = &s->table;
	const struct sampler_strip *which = &t->strip[strip];
	const struct scratch *scratch = &s->scratch[worker];
	const int planes = decode_strip(pass, strip, scratch) ? 4 : 3;

	for (int k = which->first_part; k < which->first_part + which->parts; k++) {
		const struct sampler_part *part = &t->part[k];

		s->kernels->add(scratch->planes, planes, plane_values(s),
				t->span + part->first_span, part->spans,
				t->weight + part->first_weight, s->of_parts[k].plane);
	}
}

static void add_parts(struct light_sampler *s)
{
	memset(s->of_all, 0, (size_t)s->table.sums * sizeof(*s->of_all));
	for (int k = 0; k < s->table.parts; k++) {
		struct sums *sum = &s->of_all[s->table.part[k].sum];

		for (int c = 0; c < SAMPLER_PLANES; c++)
			sum->plane[c] += s->of_parts[k].plane[c];
	}
}

/* The mean of a plane over a light, whose values are so much less than they stand for. */
static double mean_of(const struct light_sampler *s, const struct sampler_light *light, int c,
		      double bias)
{
	const double fine = ldexp(1, -SAMPLER_FINE_BITS);
	double sum, whole;

	if (light->sum < 0)
		return 0;
	whole = light->whole[0];
	sum = (double)s->of_all[light->sum].plane[c] + bias * whole;
	if (light->fine >= 0) {
		sum += fine * ((double)s->of_all[light->fine].plane[c] + bias * light->whole[1]);
		whole += fine * light->whole[1];
	}
	return sum / whole;
}

int light_sampler_read_frame(struct light_sampler *s, const struct frame_reader *reader,
			     struct pool *pool, float (*radiance)[3], double *clipped)
{
	const double unit = s->gain / VALUE_MAX;
	struct pass pass = {s, reader};
	double share = 0;
	int ret;

	if (reader->view.width != s->width || reader->view.height != s->height)
		return -EINVAL;
	ret = grow_scratch(s, pool ? pool_threads(pool) : 1);
	if (ret < 0)
		return ret;
	if (pool) {
		pool_run(pool, s->table.strips, read_strip, &pass);
	} else {
		for (int strip = 0; strip < s->table.strips; strip++)
			read_strip(&pass, strip, 0);
	}
	add_parts(s);
	for (int i = 0; i < s->table.lights; i++) {
		const struct sampler_light *light = &s->table.light[i];

		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)(unit * mean_of(s, light, c, VALUE_BIAS));
		share += mean_of(s, light, 3, 0) * s->sky_share[i];
	}
	if (clipped)
		*clipped = share;
	return 0;
}

int light_sampler_read(struct light_sampler *s, const struct picture *picture, float (*radiance)[3],
		       double *clipped)
{
	const struct frame_reader reader = frame_reader_of(picture);

	return light_sampler_read_frame(s, &reader, NULL, radiance, clipped);
}

/* ---- linear pictures ---- */

static void add_linear(struct light_sampler *s, const struct image *picture, int strip,
		       const struct sampler_part *part)
{
	const struct sampler_table *t = &s->table;
	const uint16_t *weight = t->weight + part->first_weight;
	double *sum = s->linear[part->sum];

	for (int k = part->first_span; k < part->first_span + part->spans; k++) {
		const int row = (int)t->span[k].offset / t->row_stride;
		const int x = (int)t->span[k].offset % t->row_stride;
		const size_t y = (size_t)(strip * SAMPLER_STRIP_ROWS + row);
		const float *pixel = picture->f32 + 3 * (y * (size_t)s->width + (size_t)x);
		const int values = (int)t->span[k].chunks * SAMPLER_CHUNK;

		for (int i = 0; i < values; i++) {
			for (int c = 0; weight[i] && c < 3; c++)
				sum[c] += (double)weight[i] * (double)pixel[3 * i + c];
		}
		weight += values;
	}
}

int light_sampler_read_linear(struct light_sampler *s, const struct image *picture,
			      float (*radiance)[3])
{
	const struct sampler_table *t = &s->table;
	const double fine = ldexp(1, -SAMPLER_FINE_BITS);

	if (picture->width != s->width || picture->height != s->height || !picture->f32)
		return -EINVAL;
	memset(s->linear, 0, (size_t)t->sums * sizeof(*s->linear));
	for (int strip = 0; strip < t->strips; strip++) {
		for (int k = 0; k < t->strip[strip].parts; k++)
			add_linear(s, picture, strip, &t->part[t->strip[strip].first_part + k]);
	}
	for (int i = 0; i < t->lights; i++) {
		const struct sampler_light *l = &t->light[i];
		const double whole = l->whole[0] + fine * l->whole[1];

		for (int c = 0; c < 3; c++) {
			double sum = l->sum >= 0 ? s->linear[l->sum][c] : 0;

			sum += l->fine >= 0 ? fine * s->linear[l->fine][c] : 0;
			radiance[i][c] = l->sum >= 0 ? (float)(s->gain * sum / whole) : 0;
		}
	}
	return 0;
}

int light_sampler_unseen(const struct light_sampler *s)
{
	return s->table.unseen;
}

void light_sampler_destroy(struct light_sampler *s)
{
	if (!s)
		return;
	sampler_table_free(&s->table);
	for (int i = 0; i < s->scratches; i++) {
		free(s->scratch[i].planes);
		free(s->scratch[i].row);
	}
	free(s->scratch);
	free(s->linear);
	free(s->of_all);
	free(s->of_parts);
	free(s->sky_share);
	free(s);
}
