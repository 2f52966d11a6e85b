/* SPDX-License-Identifier: MIT */
#include "bake/truth/sky.h"

#include <errno.h>
#include <stdlib.h>

#define SUBSAMPLES 4	/* per side of a texel, for the ground's irradiance */
#define FINE_WIDTH 4096 /* from this many texels across, one sample each does */

static double texel_brightness(const struct image *image, int x, int y)
{
	const int w = image->width, h = image->height;
	const float *p;

	x = (x + w) % w;
	y = y < 0 ? 0 : y >= h ? h - 1 : y;
	p = image->f32 + 3 * ((size_t)y * (size_t)w + (size_t)x);
	return (double)p[0] + (double)p[1] + (double)p[2];
}

/* Weight of a texel in sampling. Radiance is bilinear between texels, so a bright texel shines from
 * its neighbours as well: the density must not be smaller there than the light is. */
static double texel_weight(const struct image *image, int x, int y)
{
	static const double tent[3] = {0.25, 0.5, 0.25};
	double sum = 0;

	for (int j = -1; j <= 1; j++)
		for (int i = -1; i <= 1; i++)
			sum += tent[j + 1] * tent[i + 1] * texel_brightness(image, x + i, y + j);
	return sum;
}

static void fill_sums(struct sky *sky)
{
	const struct image *image = sky->panorama.image;

	for (int y = 0; y < sky->rows; y++) {
		double *row = sky->sum + (size_t)y * (size_t)sky->width;
		const double sr = panorama_row_sr(&sky->panorama, y);
		double sum = 0;

		for (int x = 0; x < sky->width; x++) {
			sum += texel_weight(image, x, y) * sr;
			row[x] = sum;
		}
		sky->total += row[sky->width - 1];
		sky->row_sum[y] = sky->total;
	}
}

static void integrate_ground(struct sky *sky)
{
	const int parts = sky->width < FINE_WIDTH ? SUBSAMPLES : 1;
	double sum[3] = {0, 0, 0};

	for (int y = 0; y < sky->rows * parts; y++) {
		double row[3] = {0, 0, 0}, d[3] = {0, 0, 0};
		const double at = (y + 0.5) / parts, height = sky->panorama.image->height;
		const double band = cos(M_PI * y / (parts * height)) -
				    cos(M_PI * (y + 1) / (parts * height));

		for (int x = 0; x < sky->width * parts; x++) {
			double rgb[3];

			panorama_direction(&sky->panorama, (x + 0.5) / parts, at, d);
			panorama_radiance(&sky->panorama, d, rgb);
			for (int c = 0; c < 3; c++)
				row[c] += rgb[c];
		}
		if (d[2] <= 0)
			continue;
		for (int c = 0; c < 3; c++)
			sum[c] += row[c] * d[2] * band * 2 * M_PI / (sky->width * parts);
	}
	for (int c = 0; c < 3; c++)
		sky->ground.c[c] = (float)(sum[c] / M_PI);
}

int sky_create(struct sky *sky, const struct panorama *panorama, const char *name,
	       struct fault *fault)
{
	*sky = (struct sky){.panorama = *panorama, .width = panorama->image->width};
	sky->rows = (panorama->image->height + 1) / 2;
	sky->row_sum = malloc((size_t)sky->rows * sizeof(*sky->row_sum));
	sky->sum = malloc((size_t)sky->rows * (size_t)sky->width * sizeof(*sky->sum));
	if (!sky->row_sum || !sky->sum) {
		sky_free(sky);
		return fault_say(fault, -ENOMEM, "%s: out of memory", name);
	}
	fill_sums(sky);
	if (!(sky->total > 0)) {
		sky_free(sky);
		return fault_say(fault, -EDOM, "%s: the upper half is black, expected some light",
				 name);
	}
	integrate_ground(sky);
	return 0;
}

void sky_of_light(struct sky *sky, const struct dome *dome, int light)
{
	*sky = (struct sky){.dome = dome, .light = light};
	for (int c = 0; c < 3; c++)
		sky->ground.c[c] = (float)(dome->projected_sr[light] / M_PI);
}

void sky_free(struct sky *sky)
{
	free(sky->row_sum);
	free(sky->sum);
	sky->row_sum = NULL;
	sky->sum = NULL;
}

static bool sky_is_lit(const struct sky *sky)
{
	return sky->dome || sky->panorama.image;
}

struct rgb sky_radiance(const struct sky *sky, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};
	double rgb[3];

	if (direction.z < 0 || !sky_is_lit(sky))
		return rgb_make(0, 0, 0);
	if (sky->dome) {
		const float lit = dome_cell_of(sky->dome, d) == sky->light;

		return rgb_make(lit, lit, lit);
	}
	panorama_radiance(&sky->panorama, d, rgb);
	return rgb_make((float)rgb[0], (float)rgb[1], (float)rgb[2]);
}

struct rgb sky_lamps(const struct sky *sky, struct v3 origin, struct v3 direction, float far)
{
	struct rgb sum = {{0, 0, 0}};

	for (int k = 0; k < sky->lamp_count; k++)
		if (lamp_distance(&sky->lamps[k], origin, direction) < far)
			sum = rgb_add(sum, sky->lamps[k].radiance);
	return sum;
}

/* Index of the first of count running sums that is above x. */
static int find_sum(const double *sum, int count, double x)
{
	int low = 0, high = count - 1;

	while (low < high) {
		const int middle = (low + high) / 2;

		if (sum[middle] > x)
			high = middle;
		else
			low = middle + 1;
	}
	return low;
}

static float texel_density(const struct sky *sky, int x, int y)
{
	const double *row = sky->sum + (size_t)y * (size_t)sky->width;
	const double share = (row[x] - (x ? row[x - 1] : 0)) / sky->total;

	return (float)(share * sky->width / panorama_row_sr(&sky->panorama, y));
}

static float light_density(const struct sky *sky, const double d[3])
{
	return dome_cell_of(sky->dome, d) == sky->light
		       ? (float)(1 / sky->dome->solid_angle_sr[sky->light])
		       : 0;
}

static struct v3 sample_light(const struct sky *sky, float u, float v, float *density)
{
	double d[3];

	dome_cell_sample(sky->dome, sky->light, (double)u, (double)v, d);
	*density = light_density(sky, d);
	return v3_make((float)d[0], (float)d[1], (float)d[2]);
}

static struct v3 sample_panorama(const struct sky *sky, float u, float v, float *density)
{
	const double height = sky->panorama.image->height;
	const double want = v * sky->total;
	const int y = find_sum(sky->row_sum, sky->rows, want);
	const double *row = sky->sum + (size_t)y * (size_t)sky->width;
	const double before_row = y ? sky->row_sum[y - 1] : 0;
	const double in_row = fmin((want - before_row) / (sky->row_sum[y] - before_row), 1);
	const double across = u * row[sky->width - 1];
	const int x = find_sum(row, sky->width, across);
	const double before = x ? row[x - 1] : 0;
	const double in_texel = fmin((across - before) / (row[x] - before), 1);
	/* uniform in solid angle within the row: uniform in the cosine of the polar angle */
	const double top = cos(M_PI * y / height), low = cos(M_PI * (y + 1) / height);
	const double angle = acos(fmax(fmin(top + (low - top) * in_row, 1), -1));
	double d[3];

	panorama_direction(&sky->panorama, x + in_texel, angle / M_PI * height, d);
	*density = texel_density(sky, x, y);
	return v3_make((float)d[0], (float)d[1], (float)d[2]);
}

struct v3 sky_sample(const struct sky *sky, float u, float v, float *density)
{
	*density = 0;
	if (!sky_is_lit(sky))
		return v3_make(0, 0, 1);
	return sky->dome ? sample_light(sky, u, v, density) : sample_panorama(sky, u, v, density);
}

static float panorama_density(const struct sky *sky, struct v3 d)
{
	const struct image *image = sky->panorama.image;
	/* azimuth runs from +X towards +Y, columns the other way, the middle one at +X */
	const double azimuth = atan2(d.y, d.x) - sky->panorama.turn_rad;
	double column = 0.5 - azimuth / (2 * M_PI);
	int x, y = (int)(acos(fmax(fmin((double)d.z, 1), -1)) / M_PI * image->height);

	column -= floor(column);
	x = (int)(column * image->width);
	if (x >= image->width)
		x = image->width - 1;
	return y < sky->rows ? texel_density(sky, x, y) : 0;
}

float sky_density(const struct sky *sky, struct v3 direction)
{
	const double d[3] = {direction.x, direction.y, direction.z};

	if (!sky_is_lit(sky))
		return 0;
	return sky->dome ? light_density(sky, d) : panorama_density(sky, direction);
}

/* Share of the directions from origin that meet the lamp: (1 - cos(angle)) / 2, where
 * sin(angle) = radius / distance, without loss of digits for small angles. */
static float lamp_share(const struct truth_lamp *lamp, struct v3 origin)
{
	const struct v3 way = v3_sub(lamp->centre, origin);
	const float sin2 = lamp->radius * lamp->radius / v3_dot(way, way);

	return sin2 < 1 ? sin2 / (1 + sqrtf(1 - sin2)) / 2 : 1;
}

double lamp_angle(const struct truth_lamp *lamp, struct v3 origin)
{
	return 2 * asin(sqrt((double)lamp_share(lamp, origin)));
}

float lamp_density(const struct truth_lamp *lamp, struct v3 origin)
{
	return 1 / (4 * PI_F * lamp_share(lamp, origin));
}

struct v3 lamp_sample(const struct truth_lamp *lamp, struct v3 origin, float u, float v)
{
	const struct v3 axis = v3_unit(v3_sub(lamp->centre, origin));
	const float below = 2 * u * lamp_share(lamp, origin); /* 1 - cos */
	const float sine = sqrtf(below * (2 - below));
	struct v3 s, t;

	v3_frame(axis, &s, &t);
	return v3_from_frame(
		v3_make(sine * cosf(2 * PI_F * v), sine * sinf(2 * PI_F * v), 1 - below), s, t,
		axis);
}

float lamp_distance(const struct truth_lamp *lamp, struct v3 origin, struct v3 direction)
{
	const struct v3 way = v3_sub(lamp->centre, origin);
	const float along = v3_dot(way, direction);
	const struct v3 aside = v3_mad(way, -along, direction);
	const float half = sqrtf(lamp->radius * lamp->radius - v3_dot(aside, aside));
	const float at = along > half ? along - half : along + half;

	/* half and at are NaN where the ray misses the sphere: the comparison is false then */
	return at >= 0 && origin.z + at * direction.z >= 0 ? at : INFINITY;
}
