/* SPDX-License-Identifier: MIT */
/* Bakes a scene: renders and encodes all tiles on all processors, into a basis file. */
#ifndef INLAY_BAKE_TILES_RENDER_H
#define INLAY_BAKE_TILES_RENDER_H

#include "bake/encode/encode.h"
#include "bake/scene/scene.h"
#include "bake/tiles/assembly.h"
#include "bake/tiles/shard.h"

/* Default of the largest error of a pixel, as a multiple of the RMS error. */
#define RENDER_MAX_OF_RMS 2

struct render_settings {
	int frequency;
	const struct fine_list *fine; /* finer parts of the sky; NULL: none */
	int samples;
	double noise_levels; /* above 0: target for the noise, which replaces samples */
	int bounces, seed;
	struct encode_target target; /* max 0: RENDER_MAX_OF_RMS times rms */
	double column_cut;	     /* as in struct basis_info_chunk; below 0: chosen by plan.c */
	int coarse;		     /* frequency of the coarse dome; 0: chosen by plan.c */
	bool exact;		     /* store the exact layer too */
	bool cache;		     /* bounced light comes from a cache (bake/trace/cache.h) */
	bool live;		     /* what shines mirrors the fisheye's picture (bake/mirror) */
	struct shard_place shard;    /* count 0: the whole bake */
	const char *pose;	     /* name or number of the only pose to bake; NULL: all */
	bool preview;		     /* the provenance says so (basis_is_preview()) */
	int threads;		     /* 0: one for each processor */
	bool quiet;		     /* no progress */
};

struct render_report {
	uint64_t rays;
	double seconds;
	struct basis_info_chunk info;	   /* has the declared errors, unless this is a shard */
	uint64_t shown_bytes, exact_bytes; /* sizes of all blocks */
	bool object_seen;		   /* some pixel shows the object */
	struct assembly_miss miss;	   /* not set for a shard */
};

/* Returns the settings of the scene file. */
struct render_settings render_settings_of(const struct scene *scene);

/*
 * Returns settings of a preview of the same picture: a few hundredths of the work. It has the size,
 * poses and seed of the bake, but not more than 46 lights, 4 samples a pixel and one bounce, errors
 * of at least 8 levels, and no exact layer. It holds no error that is asked for, but declares its
 * own, measured like any bake's.
 */
struct render_settings render_preview_of(const struct render_settings *settings);

/* Bakes to a basis file, or to a shard. Writes no file on failure. The file depends on scene and
 * settings alone, not on threads. Leaves the scene in the pose that was baked last. */
int render_run(struct scene *scene, const struct render_settings *settings, const char *path,
	       struct render_report *report, struct fault *fault);

#endif
