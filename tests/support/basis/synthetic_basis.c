/* SPDX-License-Identifier: MIT */
#include "tests/support/basis/synthetic_basis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

/* Groups in the order of kinds: T, V, V of another ground, D, U. */
enum { SYNTHETIC_T, SYNTHETIC_V, SYNTHETIC_V2, SYNTHETIC_D, SYNTHETIC_U, SYNTHETIC_GROUPS };

void synthetic_must(int ret, const struct fault *fault)
{
	if (ret < 0) {
		fprintf(stderr, "synthetic basis: %s (%d)\n", fault->text, ret);
		abort();
	}
}

void synthetic_lights(struct basis_light *lights, int count, struct chance *chance)
{
	for (int i = 0; i < count; i++) {
		const double z = chance_real(chance, 0, 1),
			     phi = 2 * M_PI * chance_real(chance, 0, 1);
		const double r = sqrt(1 - z * z);

		lights[i] = (struct basis_light){
			.direction = {r * cos(phi), r * sin(phi), z},
			.solid_angle_sr = 2 * M_PI / count,
		};
	}
}

/* Coarse lights and weights of each light: one, two or three, in ascending order. */
static void synthetic_gather(struct basis_coarse *gather, int lights, int coarse,
			     struct chance *chance)
{
	for (int i = 0; i < lights; i++) {
		struct basis_coarse *g = &gather[i];
		const int places = chance_int(chance, 1, coarse < 3 ? coarse : 3);
		int left = BASIS_COARSE_ONE, from = 0;

		*g = (struct basis_coarse){{0}, {0}};
		for (int k = 0; k < places; k++) {
			const int more = places - 1 - k; /* coarse lights still to come */
			const int weight = more ? chance_int(chance, 1, left - more) : left;

			from = chance_int(chance, from, coarse - 1 - more);
			g->index[k] = (uint16_t)from++;
			g->weight[k] = (uint16_t)weight;
			left -= weight;
		}
	}
}

static void synthetic_add_pixel(struct synthetic_group *g, int pixel, double factor, bool unlit)
{
	g->factor[g->pixels] = factor;
	g->unlit[g->pixels] = unlit;
	g->pixel[g->pixels++] = (uint16_t)pixel;
}

static void synthetic_choose_pixels(struct synthetic_maker *m, int x0, int y0,
				    struct synthetic_group *groups)
{
	static const enum basis_kind kinds[SYNTHETIC_GROUPS] = {
		BASIS_KIND_T, BASIS_KIND_V, BASIS_KIND_V, BASIS_KIND_D, BASIS_KIND_U};
	const struct synthetic_options *o = m->options;
	const int ground = o->grounds ? chance_int(&m->chance, 0, o->grounds - 1) : 0;

	for (int g = 0; g < SYNTHETIC_GROUPS; g++) {
		groups[g].kind = kinds[g];
		groups[g].pixels = 0;
		groups[g].ground = kinds[g] != BASIS_KIND_V ? 0
				   : g == SYNTHETIC_V
					   ? ground
					   : (ground + 1) % (o->grounds ? o->grounds : 1);
	}
	for (int p = 0; p < SYNTHETIC_PIXELS; p++) {
		const int x = x0 + p % BASIS_TILE, y = y0 + p / BASIS_TILE;
		const double r = chance_real(&m->chance, 0, 1);
		const double factor = chance_real(&m->chance, -o->bounce, 1);
		const bool unlit = chance_real(&m->chance, 0, 1) < o->unlit_share;

		if (x >= o->width || y >= o->height)
			continue;
		if (chance_real(&m->chance, 0, 1) < o->object_share) {
			const double a = chance_real(&m->chance, 0, 1);

			m->coverage[y * o->width + x] = (uint16_t)(a < 0.3   ? 65535
								   : a < 0.4 ? 0
									     : a * 65535);
			synthetic_add_pixel(&groups[SYNTHETIC_T], p, 1, false);
		}
		if (r < o->ground_share) {
			const int g = chance_int(&m->chance, SYNTHETIC_V, SYNTHETIC_V2);

			synthetic_add_pixel(&groups[o->grounds > 1 ? g : SYNTHETIC_V], p, factor,
					    false);
		} else if (r < o->ground_share + o->stand_in_share) {
			synthetic_add_pixel(&groups[SYNTHETIC_D], p, factor, unlit);
			synthetic_add_pixel(&groups[SYNTHETIC_U], p, 1, unlit);
		}
	}
}

static void synthetic_raise_peaks(const struct synthetic_maker *m, const double *value, int pixels)
{
	const size_t n = (size_t)m->options->lights;

	for (int k = 0; k < pixels * 3; k++) {
		const double *t = value + (size_t)k * n;
		const int c = k % 3;
		double sum = 0;

		for (size_t i = 0; i < n; i++) {
			const double one = t[i] * m->light[i].solid_angle_sr * (1 + 1e-6);

			m->peak[i][c] = fmaxf(m->peak[i][c], (float)one);
			sum += one;
		}
		m->peak[n][c] = fmaxf(m->peak[n][c], (float)sum);
	}
}

/* Writes a group's blocks to both layers and frees them. */
static void synthetic_write_group(struct synthetic_maker *m, uint32_t tile,
				  const struct synthetic_group *group,
				  struct synthetic_block *blocks, int count)
{
	const struct synthetic_options *o = m->options;
	const bool values = o->exact || group->kind == BASIS_KIND_T;
	double *value = synthetic_zeros(values ? (size_t)group->pixels * 3 * (size_t)o->lights : 1,
					sizeof(*value));
	struct fault fault = {""};

	for (int n = 0; n < count; n++) {
		const struct basis_block_payload payload = {blocks[n].entry, blocks[n].payload};
		const struct basis_block view = synthetic_view(&blocks[n]);

		if (values)
			synthetic_add_values(&view, o->lights, m->gather, value);
		synthetic_must(basis_writer_blocks(m->writer, &payload, 1, &fault), &fault);
		free(blocks[n].payload);
	}
	if (group->kind == BASIS_KIND_T)
		synthetic_raise_peaks(m, value, group->pixels);
	if (o->exact) {
		double unused = 0;
		double *error = group->kind == BASIS_KIND_T   ? &m->info.object_error
				: group->kind == BASIS_KIND_V ? &m->info.ratio_error
							      : &unused;
		struct synthetic_block b = synthetic_exact(m, tile, group, value, error);
		const struct basis_block_payload payload = {b.entry, b.payload};

		synthetic_must(basis_writer_exact_blocks(m->writer, &payload, 1, &fault), &fault);
		free(b.payload);
	}
	free(value);
}

static void synthetic_write_tile(struct synthetic_maker *m, uint32_t tile, int x0, int y0)
{
	struct synthetic_group *groups = synthetic_zeros(SYNTHETIC_GROUPS, sizeof(*groups));
	struct synthetic_block blocks[SYNTHETIC_LAYERS_MAX], lit = {.payload = NULL};
	double factor[SYNTHETIC_PIXELS];

	synthetic_choose_pixels(m, x0, y0, groups);
	for (int g = SYNTHETIC_T; g <= SYNTHETIC_V2; g++)
		if (groups[g].pixels)
			synthetic_write_group(m, tile, &groups[g], blocks,
					      synthetic_layers(m, tile, &groups[g], NULL, blocks));
	if (groups[SYNTHETIC_U].pixels) { /* D is a change of U, so U is made first */
		lit = synthetic_make(m, tile, &groups[SYNTHETIC_U], 1 / (2 * M_PI));
		synthetic_write_group(
			m, tile, &groups[SYNTHETIC_D], blocks,
			synthetic_layers(m, tile, &groups[SYNTHETIC_D], &lit, blocks));
		for (int p = 0; p < groups[SYNTHETIC_U].pixels; p++)
			factor[p] = groups[SYNTHETIC_U].unlit[p] ? 0 : 1;
		synthetic_scale_pixels(&lit, factor);
		synthetic_write_group(m, tile, &groups[SYNTHETIC_U], &lit, 1);
	}
	free(groups);
}

/* Glass with no, small and the largest possible displacement; some transmissions are 0 or 1. */
static void synthetic_write_glass(struct synthetic_maker *m)
{
	const struct synthetic_options *o = m->options;
	struct chance chance = {o->seed ^ 0x61a55};
	struct basis_glass *glass = synthetic_zeros((size_t)o->width * (size_t)o->height,
						    sizeof(*glass));
	struct fault fault = {""};
	size_t count = 0;

	for (int y0 = 0; y0 < o->height; y0 += BASIS_TILE)
		for (int x0 = 0; x0 < o->width; x0 += BASIS_TILE)
			for (int p = 0; p < SYNTHETIC_PIXELS; p++) {
				const int x = x0 + p % BASIS_TILE, y = y0 + p / BASIS_TILE;
				const int reach = (int[]){0, 40, 400,
							  32768}[chance_int(&chance, 0, 3)];
				struct basis_glass *g = &glass[count];

				if (x >= o->width || y >= o->height ||
				    chance_real(&chance, 0, 1) >= o->glass_share)
					continue;
				*g = (struct basis_glass){.x = (uint16_t)x, .y = (uint16_t)y};
				for (int c = 0; c < 3; c++)
					g->transmission[c] = (uint16_t)fmin(
						fmax(chance_real(&chance, -0.2, 1.2), 0) * 65535,
						65535);
				for (int k = 0; k < 2; k++)
					g->spread[k] =
						(uint8_t)(chance_int(&chance, 0, 3)
								  ? 0
								  : chance_int(&chance, 0, 255));
				g->dx = (int16_t)chance_int(&chance, -reach, reach ? reach - 1 : 0);
				g->dy = (int16_t)chance_int(&chance, -reach, reach ? reach - 1 : 0);
				count++;
			}
	if (count)
		synthetic_must(basis_writer_glass(m->writer, glass, count, &fault), &fault);
	free(glass);
}

static void synthetic_write_mirrors(struct synthetic_maker *m)
{
	const struct synthetic_options *o = m->options;
	struct chance chance = {o->seed ^ 0x3122};
	struct basis_mirror *mirror = synthetic_zeros(2 * (size_t)o->width * (size_t)o->height,
						      sizeof(*mirror));
	struct fault fault = {""};
	size_t count = 0;

	for (int y0 = 0; y0 < o->height; y0 += BASIS_TILE)
		for (int x0 = 0; x0 < o->width; x0 += BASIS_TILE)
			for (int p = 0; p < 2 * SYNTHETIC_PIXELS; p++) {
				const int x = x0 + p / 2 % BASIS_TILE, y = y0 + p / 2 / BASIS_TILE;

				if (x >= o->width || y >= o->height ||
				    chance_real(&chance, 0, 1) >= o->mirror_share)
					continue;
				mirror[count++] = (struct basis_mirror){
					.x = (uint16_t)x,
					.y = (uint16_t)y,
					.u = (uint16_t)chance_int(&chance, 0, 65535),
					.v = (uint16_t)chance_int(&chance, 0, 65535),
					.throughput = {(uint16_t)chance_int(&chance, 0, 65535)},
					.level = (uint16_t)chance_int(&chance, 0, 2048),
				};
			}
	if (count)
		synthetic_must(basis_writer_mirror(m->writer, mirror, count, &fault), &fault);
	free(mirror);
}

void synthetic_write(struct synthetic *s, const struct synthetic_options *o)
{
	const int coarse = o->coarse ? o->coarse : o->lights;
	const size_t n = (size_t)o->lights, terms = (size_t)o->grounds * 3 * n;
	struct basis_light *light = synthetic_zeros(n, sizeof(*light));
	struct basis_coarse *gather = synthetic_zeros(n, sizeof(*gather));
	double *ground = synthetic_zeros(terms, sizeof(*ground));
	struct synthetic_maker m = {
		.options = o,
		.light = light,
		.gather = coarse < o->lights ? gather : NULL,
		.info = {.width = (uint32_t)o->width,
			 .height = (uint32_t)o->height,
			 .lights = (uint32_t)o->lights,
			 .grounds = (uint32_t)o->grounds,
			 .poses = 1,
			 .coarse = (uint32_t)coarse,
			 .column_cut = o->column_cut},
		.coverage = synthetic_zeros((size_t)o->width * (size_t)o->height, sizeof(uint16_t)),
		.peak = synthetic_zeros(n + 1, sizeof(*m.peak)),
		.chance = {o->seed},
	};
	struct fault fault = {""};
	uint32_t tile = 0;

	synthetic_lights(light, o->lights, &m.chance);
	synthetic_gather(gather, o->lights, coarse, &m.chance);
	for (size_t i = 0; i < terms; i++)
		ground[i] = chance_real(&m.chance, 0, 1) / o->lights;
	synthetic_must(basis_writer_open(&m.writer, s->path, &m.info, light, ground, m.gather,
					 "[camera]\n", &fault),
		       &fault);
	for (int y = 0; y < o->height; y += BASIS_TILE)
		for (int x = 0; x < o->width; x += BASIS_TILE)
			synthetic_write_tile(&m, tile++, x, y);
	synthetic_must(
		basis_writer_pose_end(m.writer, m.coverage, (const float(*)[3])m.peak, &fault),
		&fault);
	synthetic_write_glass(&m);
	synthetic_write_mirrors(&m);
	synthetic_must(basis_writer_finish(m.writer, &m.info, "made = by a test\n", &fault),
		       &fault);
	free(light);
	free(gather);
	free(ground);
	free(m.coverage);
	free(m.peak);
}

void synthetic_reseal(uint8_t *data, size_t bytes)
{
	struct basis_file_header *header = (struct basis_file_header *)data;
	struct basis_chunk_entry *chunk = (struct basis_chunk_entry *)(header + 1);
	XXH3_state_t *hash;

	if (bytes < sizeof(*header) ||
	    header->chunk_count > (bytes - sizeof(*header)) / sizeof(*chunk))
		return;
	for (uint32_t i = 0; i < header->chunk_count; i++) {
		if (chunk[i].offset <= bytes && chunk[i].bytes <= bytes - chunk[i].offset)
			chunk[i].checksum = XXH3_64bits(data + chunk[i].offset, chunk[i].bytes);
	}
	hash = XXH3_createState();
	if (!hash)
		abort();
	header->checksum = 0;
	XXH3_64bits_reset(hash);
	XXH3_64bits_update(hash, header, sizeof(*header));
	XXH3_64bits_update(hash, chunk, header->chunk_count * sizeof(*chunk));
	header->checksum = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
}

void synthetic_open(struct synthetic *s, const struct synthetic_options *options)
{
	struct fault fault = {""};

	memset(s, 0, sizeof(*s));
	snprintf(s->folder, sizeof(s->folder), "/tmp/inlay-basis-XXXXXX");
	if (!mkdtemp(s->folder))
		abort();
	snprintf(s->path, sizeof(s->path), "%s/b.inlay", s->folder);
	synthetic_write(s, options);
	synthetic_must(basis_open(&s->basis, s->path, BASIS_ALL, &fault), &fault);
}

void synthetic_close(struct synthetic *s)
{
	basis_close(&s->basis);
	unlink(s->path);
	rmdir(s->folder);
}
