#include "hal/lights/sampler.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/sampler_table.h"

const char *const light_estimator_names[] = {"cell", "node", NULL};

/* Linear 1.0 of a decoded code value. Times the sum of weights, 2^31, a sum is at most 2^61. */
#define VALUE_BITS 30

struct light_sampler {
	struct sampler_table table;
	int width, height;
	double gain;
	uint32_t decode[256];
	double *sky_share; /* [lights]: solid angle over 2 pi */
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

static void fill_decode(uint32_t decode[256], enum transfer transfer, int black)
{
	for (int c = 0; c < 256; c++) {
		const double code = (double)(c - black) / (255 - black);

		decode[c] = (uint32_t)lrint(ldexp(transfer_decode(transfer, code), VALUE_BITS));
	}
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
	fill_decode(s->decode, settings->transfer, settings->black_level);
	s->sky_share = calloc((size_t)dome->count, sizeof(*s->sky_share));
	ret = s->sky_share ? sampler_table_create(&s->table, dome, lens, width, height,
						  settings->estimator)
			   : -ENOMEM;
	if (ret < 0) {
		light_sampler_destroy(s);
		return fault_say(fault, ret, "fisheye: cannot make the light sampler: %s",
				 strerror(-ret));
	}
	for (int i = 0; i < dome->count; i++)
		s->sky_share[i] = dome->solid_angle_sr[i] / (2 * M_PI);
	*out = s;
	return 0;
}

struct sum {
	uint64_t r, g, b, clipped;
};

/* A 255 among the three low bytes: adding 1 to each byte's low seven bits carries into its top bit
 * when all of them are set; the byte is 255 when its top bit was set besides. */
static uint32_t clips(uint32_t bgrx)
{
	return ((bgrx & 0x7f7f7f) + 0x010101) & bgrx & 0x808080;
}

static void add_span(struct sum *sum, const uint32_t decode[256], const uint8_t *pixel,
		     ptrdiff_t step, const uint32_t *weight, int count)
{
	struct sum s = *sum;

	for (int k = 0; k < count; k++, pixel += step) {
		const uint64_t w = weight[k];
		uint32_t bgrx; /* one load for the pixel; hosts are little-endian */

		memcpy(&bgrx, pixel, sizeof(bgrx));
		s.b += w * decode[bgrx & 255];
		s.g += w * decode[bgrx >> 8 & 255];
		s.r += w * decode[bgrx >> 16 & 255];
		s.clipped += clips(bgrx) ? w : 0;
	}
	*sum = s;
}

int light_sampler_read(struct light_sampler *s, const struct picture *picture, float (*radiance)[3],
		       double *clipped)
{
	const struct sampler_table *t = &s->table;
	const uint32_t *weight = t->weight;
	const double unit = ldexp(s->gain, -VALUE_BITS - SAMPLER_WEIGHT_BITS);
	double share = 0;

	if (picture->width != s->width || picture->height != s->height)
		return -EINVAL;
	for (int i = 0; i < t->lights; i++) {
		struct sum sum = {0, 0, 0, 0};

		for (int k = t->first[i]; k < t->first[i + 1]; k++) {
			const struct sampler_span *span = &t->span[k];

			add_span(&sum, s->decode,
				 picture->origin + span->y * picture->y_step +
					 span->x * picture->x_step,
				 picture->x_step, weight, span->count);
			weight += span->count;
		}
		radiance[i][0] = (float)((double)sum.r * unit);
		radiance[i][1] = (float)((double)sum.g * unit);
		radiance[i][2] = (float)((double)sum.b * unit);
		share += ldexp((double)sum.clipped, -SAMPLER_WEIGHT_BITS) * s->sky_share[i];
	}
	if (clipped)
		*clipped = share;
	return 0;
}

int light_sampler_read_linear(struct light_sampler *s, const struct image *picture,
			      float (*radiance)[3])
{
	const struct sampler_table *t = &s->table;
	const uint32_t *weight = t->weight;
	const double unit = ldexp(s->gain, -SAMPLER_WEIGHT_BITS);

	if (picture->width != s->width || picture->height != s->height || !picture->f32)
		return -EINVAL;
	for (int i = 0; i < t->lights; i++) {
		double sum[3] = {0, 0, 0};

		for (int k = t->first[i]; k < t->first[i + 1]; k++) {
			const struct sampler_span *span = &t->span[k];
			const float *pixel = picture->f32 +
					     3 * ((size_t)span->y * s->width + span->x);

			for (int n = 0; n < span->count; n++, pixel += 3, weight++)
				for (int c = 0; c < 3; c++)
					sum[c] += (double)*weight * pixel[c];
		}
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)(sum[c] * unit);
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
	free(s->sky_share);
	free(s);
}
