/* SPDX-License-Identifier: MIT */
/* What the object mirrors of the sky: against double precision, from a picture of the sky and from
 * the lights, at every light and gain; and proof that threads do not change a byte. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/mirror/mirror_map.h"
#include "hal/optics/dome.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define SIDE 40
#define LIGHTS 26 /* of frequency 2 */

static struct compositor_settings settings_of(double gain)
{
	return (struct compositor_settings){
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = gain,
		.object = true,
	};
}

/* Writes a file whose object covers all, and does nothing but mirror. */
static void open_mirrors(struct synthetic *s, struct chance *chance)
{
	struct basis_info_chunk info = {.width = SIDE, .height = SIDE, .poses = 1};
	static struct basis_mirror mirror[SIDE * SIDE * BASIS_MIRROR_MOST];
	static struct basis_light light[LIGHTS];
	static const float peak[LIGHTS + 1][3];
	static uint16_t coverage[SIDE * SIDE];
	struct basis_writer *writer;
	struct fault fault = {""};
	struct dome dome;
	size_t count = 0;

	assert_int_equal(dome_create(&dome, 2, &fault), 0);
	assert_int_equal(dome.count, LIGHTS);
	for (int i = 0; i < LIGHTS; i++) {
		memcpy(light[i].direction, dome.direction[i], 3 * sizeof(double));
		light[i].solid_angle_sr = dome.solid_angle_sr[i];
	}
	dome_free(&dome);
	info.lights = info.coarse = LIGHTS;
	info.dome_frequency = 2;
	for (int tile = 0; tile < 9; tile++)
		for (int at = 0; at < BASIS_TILE * BASIS_TILE; at++) {
			const int x = tile % 3 * BASIS_TILE + at % BASIS_TILE;
			const int y = tile / 3 * BASIS_TILE + at / BASIS_TILE;

			for (int k = chance_int(chance, 0, 3); k > 0 && x < SIDE && y < SIDE; k--) {
				struct basis_mirror *m = &mirror[count++];

				*m = (struct basis_mirror){
					.x = (uint16_t)x,
					.y = (uint16_t)y,
					.u = (uint16_t)chance_int(chance, 0, 65535),
					.v = (uint16_t)chance_int(chance, 0, 65535),
					.level = (uint16_t)chance_int(chance, 0, 2304),
				};
				for (int c = 0; c < 3; c++)
					m->throughput[c] = (uint16_t)chance_int(chance, 0, 65535);
			}
		}
	memset(s, 0, sizeof(*s));
	memset(coverage, 255, sizeof(coverage));
	strcpy(s->folder, "/tmp/inlay-basis-XXXXXX");
	assert_non_null(mkdtemp(s->folder));
	snprintf(s->path, sizeof(s->path), "%s/b.inlay", s->folder);
	assert_int_equal(basis_writer_open(&writer, s->path, &info, light, NULL, NULL, "", &fault),
			 0);
	assert_int_equal(basis_writer_pose_end(writer, coverage, peak, &fault), 0);
	assert_int_equal(basis_writer_mirror(writer, mirror, count, &fault), 0);
	assert_int_equal(basis_writer_finish(writer, &info, "", &fault), 0);
	assert_int_equal(basis_open(&s->basis, s->path, BASIS_SHOWN, &fault), 0);
	assert_int_equal(s->basis.poses[0].mirror_count, count);
}

/* Fills a map with a random sky up to this light. */
static void fill_map(struct mirror_map *map, const struct basis *basis, double most,
		     struct chance *chance)
{
	struct fault fault = {""};

	assert_int_equal(mirror_map_create(map, basis, &fault), 0);
	for (int at = 0; at < BASIS_MIRROR_SIDE * MIRROR_STRIDE; at++)
		for (int c = 0; c < 3; c++)
			map->texel[at][c] = (float)chance_real(chance, 0, most);
	mirror_map_finish(map);
}

static double farthest(struct random_frame *f, const struct basis *basis,
		       const struct compositor_settings *settings)
{
	static double exact[SIDE * SIDE * 3];
	double most = 0;

	compositor_set(f->compositor, settings);
	random_frame_run(f, 0);
	assert_int_equal(compositor_reference(basis, 0, settings, &f->lights, &f->picture, exact),
			 0);
	for (int at = 0; at < SIDE * SIDE * 3; at++)
		most = fmax(most, fabs(f->out[(size_t)(at / 3 / SIDE) * f->stride +
					      (size_t)(at / 3 % SIDE * 4 + 2 - at % 3)] -
				       exact[at]));
	return most;
}

TEST("agrees with double precision")
{
	/* the sky's light, gain, and the exposure that is followed */
	static const double trial[][3] = {
		{1, 1, 1}, {0.01, 64, 1}, {0, 1, 1}, {3000, 0.001, 0.2}, {200000, 64, 3}};
	struct chance chance = chance_begin("mirrors");
	struct random_frame f;
	struct synthetic s;
	double most = 0;

	open_mirrors(&s, &chance);
	random_frame_begin(&f, &s.basis, NULL, &chance);
	for (size_t k = 0; k < sizeof(trial) / sizeof(*trial); k++) {
		const struct compositor_settings settings = settings_of(trial[k][1]);
		struct mirror_map map;

		fill_map(&map, &s.basis, trial[k][0], &chance);
		f.lights.mirror = &map;
		f.lights.mirror_gain[1] = trial[k][2];
		most = fmax(most, farthest(&f, &s.basis, &settings));
		mirror_map_free(&map);
	}
	f.lights.mirror = NULL;
	{
		const struct compositor_settings settings = settings_of(1);

		most = fmax(most, farthest(&f, &s.basis, &settings));
	}
	print_message("# farthest from double precision: %.3f levels\n", most);
	assert_true(most < 1);
	random_frame_end(&f);
	synthetic_close(&s);
}

TEST("threads change nothing")
{
	const struct compositor_settings settings = settings_of(1);
	struct chance chance = {8};
	struct random_frame one, f;
	struct synthetic s;
	struct pool *pool;

	open_mirrors(&s, &chance);
	assert_int_equal(pool_create(&pool, 3), 0);
	chance.state = 9;
	random_frame_begin(&one, &s.basis, NULL, &chance);
	chance.state = 9;
	random_frame_begin(&f, &s.basis, pool, &chance);
	compositor_set(one.compositor, &settings);
	compositor_set(f.compositor, &settings);
	random_frame_run(&one, 0);
	random_frame_run(&f, 0);
	expect_same_picture(f.out, one.out, f.stride, f.bytes, "threads");
	random_frame_end(&f);
	random_frame_end(&one);
	pool_destroy(pool);
	synthetic_close(&s);
}
