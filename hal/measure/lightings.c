/* SPDX-License-Identifier: MIT */
#include "hal/measure/measure.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/image.h"
#include "hal/lights/lights_file.h"
#include "hal/optics/panorama.h"

#define SUBSAMPLES 3 /* samples along each side of a panorama's texel */
#define PANORAMA_WHITE 0.6

void lightings_free(struct lightings *l)
{
	for (int k = 0; k < l->count; k++)
		free(l->item[k].radiance);
	free(l->item);
	*l = (struct lightings){.item = NULL};
}

const float (*lighting_member(const struct lighting *lighting, const struct basis *basis,
			      int member))[3]
{
	return (const float(*)[3])(lighting->radiance + (size_t)member * basis->info.lights);
}

/* Adds a lighting to the list. NULL: no memory. */
static struct lighting *lightings_add(struct lightings *l, const struct basis *basis,
				      const char *name, int members)
{
	struct lighting *item = realloc(l->item, ((size_t)l->count + 1) * sizeof(*item));

	if (!item)
		return NULL;
	l->item = item;
	item += l->count;
	*item = (struct lighting){.members = members};
	snprintf(item->name, sizeof(item->name), "%s", name);
	item->radiance = calloc((size_t)members * basis->info.lights, sizeof(*item->radiance));
	if (!item->radiance)
		return NULL;
	l->count++;
	return item;
}

/* ---- exposure ---- */

/* Returns the radiance of white ground in its brightest channel. */
static double white_of(const struct basis *basis, const float (*radiance)[3])
{
	double sum[3] = {0, 0, 0};

	for (uint32_t i = 0; i < basis->info.lights; i++) {
		const struct basis_light *light = &basis->lights[i];
		const double cosine = fmax(light->direction[2], 0);

		for (int c = 0; c < 3; c++)
			sum[c] += light->solid_angle_sr * cosine * (double)radiance[i][c] / M_PI;
	}
	return fmax(sum[0], fmax(sum[1], sum[2]));
}

static void lighting_expose(const struct basis *basis, float (*radiance)[3], double white)
{
	const double is = white_of(basis, (const float(*)[3])radiance);

	for (uint32_t i = 0; is > 0 && i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)((double)radiance[i][c] * white / is);
}

/* ---- built-in ---- */

/* Returns a random number in 0..1, the same on every machine. */
static double random_unit(uint64_t *state)
{
	uint64_t z = *state += UINT64_C(0x9E3779B97F4A7C15);

	z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
	z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
	return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static void lighting_fill_overcast(const struct basis *basis, float (*radiance)[3])
{
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)((1 + 2 * basis->lights[i].direction[2]) / 3);
	lighting_expose(basis, radiance, 1);
}

/* Returns the light nearest to a sun 35 degrees high in the south-west. */
static uint32_t sun_cell(const struct basis *basis)
{
	const double height = 35 * M_PI / 180, azimuth = -2.2;
	const double d[3] = {cos(height) * cos(azimuth), cos(height) * sin(azimuth), sin(height)};
	double best = -2;
	uint32_t nearest = 0;

	for (uint32_t i = 0; i < basis->info.lights; i++) {
		const double *l = basis->lights[i].direction;
		const double cosine = d[0] * l[0] + d[1] * l[1] + d[2] * l[2];

		if (cosine > best) {
			best = cosine;
			nearest = i;
		}
	}
	return nearest;
}

/* A blue sky, and a sun of ten times its light in one cell. */
static void lighting_fill_sun(const struct basis *basis, float (*radiance)[3])
{
	static const float sky[3] = {0.55F, 0.75F, 1}, sun[3] = {1, 0.92F, 0.78F};
	const uint32_t at = sun_cell(basis);
	const double ratio = 10 * 2 * M_PI / basis->lights[at].solid_angle_sr;

	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = i == at ? (float)ratio * sun[c] : sky[c];
	lighting_expose(basis, radiance, 1);
}

static void lighting_fill_random(const struct basis *basis, float (*radiance)[3])
{
	uint64_t state = 20;

	for (uint32_t i = 0; i < basis->info.lights; i++) {
		const double bright = exp(6 * random_unit(&state));

		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)(bright * (0.4 + 0.6 * random_unit(&state)));
	}
	lighting_expose(basis, radiance, 1);
}

/* One cell alone, exposed so that white ground or the brightest spot of the object is 1. */
static void lighting_fill_cell(const struct basis *basis, float (*radiance)[3], uint32_t cell)
{
	const float(*peak)[3] = basis->poses[0].peak;
	double brightest;

	for (int c = 0; c < 3; c++)
		radiance[cell][c] = 1;
	brightest = white_of(basis, (const float(*)[3])radiance);
	for (int c = 0; c < 3; c++)
		brightest = fmax(brightest, (double)peak[cell][c]);
	for (int c = 0; c < 3 && brightest > 0; c++)
		radiance[cell][c] = (float)(1 / brightest);
}

int lightings_add_built_in(struct lightings *l, const struct basis *basis, int cells,
			   struct fault *fault)
{
	static const struct {
		const char *name;
		void (*fill)(const struct basis *basis, float (*radiance)[3]);
	} single[] = {{"overcast", lighting_fill_overcast},
		      {"sun", lighting_fill_sun},
		      {"random", lighting_fill_random}};
	const uint32_t lights = basis->info.lights;
	struct lighting *item;

	for (size_t k = 0; k < sizeof(single) / sizeof(*single); k++) {
		item = lightings_add(l, basis, single[k].name, 1);
		if (!item)
			return fault_say(fault, -ENOMEM, "not enough memory for lightings");
		single[k].fill(basis, item->radiance);
	}
	cells = (uint32_t)cells < lights ? cells : (int)lights;
	if (!cells)
		return 0;
	item = lightings_add(l, basis, "single cells", cells);
	if (!item)
		return fault_say(fault, -ENOMEM, "not enough memory for lightings");
	for (int k = 0; k < cells; k++)
		lighting_fill_cell(basis, item->radiance + (size_t)k * lights,
				   (uint32_t)((k + 0.5) * lights / cells));
	return 0;
}

/* ---- files ---- */

void lighting_name(const char *path, char *name, size_t room)
{
	const char *slash = strrchr(path, '/'), *dot;

	path = slash ? slash + 1 : path;
	dot = strrchr(path, '.');
	snprintf(name, room, "%.*s", dot && dot > path ? (int)(dot - path) : (int)strlen(path),
		 path);
}

int lightings_add_file(struct lightings *l, const struct basis *basis, const char *path,
		       struct fault *fault)
{
	struct lighting *item;
	char name[64];

	lighting_name(path, name, sizeof(name));
	item = lightings_add(l, basis, name, 1);
	if (!item)
		return fault_say(fault, -ENOMEM, "%s: not enough memory", path);
	return lights_file_read(path, item->radiance, (int)basis->info.lights, fault);
}

/* ---- panoramas ---- */

int lightings_dome(struct dome *dome, const struct basis *basis, struct fault *fault)
{
	const struct basis_info_chunk *info = &basis->info;
	const int stride = sizeof(*basis->lights) / sizeof(double);
	struct fault what = {.text = ""};
	const int err = dome_create_nodes(dome, basis->lights[0].direction, stride,
					  (int)info->lights, (int)info->dome_frequency, &what);

	if (err == -EINVAL)
		return fault_say(fault, -ENOTSUP,
				 "the basis's %u lights divide no sky, and so no picture: %s",
				 info->lights, what.text);
	return err ? fault_say(fault, err, "%s", what.text) : 0;
}

static void panorama_add_point(const struct panorama *panorama, const struct dome *dome, double x,
			       double y, double sr, double (*sum)[4])
{
	double d[3], rgb[3];
	int light;

	panorama_direction(panorama, x, y, d);
	light = dome_cell_of(dome, d);
	if (light < 0)
		return;
	panorama_radiance(panorama, d, rgb);
	for (int c = 0; c < 3; c++)
		sum[light][c] += sr * rgb[c];
	sum[light][3] += sr;
}

static int panorama_gather(const struct panorama *panorama, const struct dome *dome,
			   float (*radiance)[3])
{
	const struct image *image = panorama->image;
	double(*sum)[4] = calloc((size_t)dome->count, sizeof(*sum));

	if (!sum)
		return -ENOMEM;
	for (int y = 0; y < (image->height + 1) / 2 * SUBSAMPLES; y++) {
		const double sr = panorama_row_sr(panorama, y / SUBSAMPLES);

		for (int x = 0; x < image->width * SUBSAMPLES; x++)
			panorama_add_point(panorama, dome, (x + 0.5) / SUBSAMPLES,
					   (y + 0.5) / SUBSAMPLES, sr, sum);
	}
	for (int i = 0; i < dome->count; i++) {
		double node[3];

		/* a light that contains no sample: use its node */
		panorama_radiance(panorama, dome->direction[i], node);
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)(sum[i][3] > 0 ? sum[i][c] / sum[i][3] : node[c]);
	}
	free(sum);
	return 0;
}

static int panorama_gather_image(const struct image *image, const struct basis *basis,
				 const char *path, float (*radiance)[3], struct fault *fault)
{
	const struct panorama panorama = {.image = image, .scale = 1};
	struct dome dome;
	int err;

	err = lightings_dome(&dome, basis, fault);
	if (err)
		return err;
	if (panorama_gather(&panorama, &dome, radiance))
		err = fault_say(fault, -ENOMEM, "%s: not enough memory", path);
	dome_free(&dome);
	if (!err)
		lighting_expose(basis, radiance, PANORAMA_WHITE);
	return err;
}

int lightings_add_panorama(struct lightings *l, const struct basis *basis, const char *path,
			   struct fault *fault)
{
	struct lighting *item;
	struct image image;
	char name[64];
	int err = panorama_read(&image, path, fault);

	if (err)
		return err;
	lighting_name(path, name, sizeof(name));
	item = lightings_add(l, basis, name, 1);
	if (item)
		err = panorama_gather_image(&image, basis, path, item->radiance, fault);
	else
		err = fault_say(fault, -ENOMEM, "%s: not enough memory", path);
	image_free(&image);
	return err;
}
