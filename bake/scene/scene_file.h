/* SPDX-License-Identifier: MIT */
/* Reads a scene file: checks that values are in range and that names exist, but opens no other
 * file. bake/README.md describes the format. */
#ifndef INLAY_BAKE_SCENE_SCENE_FILE_H
#define INLAY_BAKE_SCENE_SCENE_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/ini/ini.h"
#include "hal/optics/tsai.h"

#define SCENE_MESHES_MAX 256 /* objects and stand-ins together */
#define SCENE_MATERIALS_MAX 256
#define SCENE_NAME_MAX 64
#define SCENE_MESH_FAR 1e8 /* world units: a file may be in coordinates of a whole country */
#define SCENE_POSES_MAX 4096
#define SCENE_KEYFRAMES_MAX 1024

struct scene_camera_values {
	char file[INI_PATH_MAX];
	double position[3], look_at[3], field_deg;
	int width, height; /* pixels; 0: not given */
	double edge_spread_px;
};

struct scene_dome_values {
	int frequency;
	char fine[INI_TEXT_MAX]; /* parts of the sky that are finer (fine_list.h); may be empty */
};

/* What mirrors show of the sky: the fisheye's picture, where that gains, or cells. */
enum scene_reflect { SCENE_REFLECT_LIVE, SCENE_REFLECT_CELLS };

struct scene_render_values {
	int samples;	     /* camera rays a pixel */
	double noise_levels; /* above 0: target for the noise, which replaces samples */
	int bounces, seed;
	/* The encoding's errors, in 8-bit levels; error_max 0: twice error_rms. */
	double error_rms, error_max, error_cell;
	double column_cut; /* as in struct basis_info_chunk; below 0: the program chooses */
	int coarse;	   /* frequency of the coarse dome; 0: the program chooses */
	bool exact;
	bool cache;  /* bounced light comes from a cache */
	int reflect; /* enum scene_reflect */
};

struct scene_ground_values {
	bool given;
	char material[INI_TEXT_MAX];
	double extent;
};

struct scene_mesh_values {
	char name[SCENE_NAME_MAX];
	bool standin;
	char file[INI_PATH_MAX];
	char material[INI_TEXT_MAX];
	double scale, rotate_deg[3], position[3], crease_deg;
	bool stand;
	int up; /* 0: y, 1: z */
};

struct scene_poses_values {
	int count; /* >= 1 */
};

/* Values of a mesh at one pose (keyframes.h). A number that was not given is NAN. */
struct scene_keyframe_values {
	char name[SCENE_NAME_MAX];
	char object[INI_TEXT_MAX];
	char file[INI_PATH_MAX]; /* empty: not given */
	double pose;
	double scale, rotate_deg[3], position[3];
	int mesh, order; /* index of the mesh; place of the section in the file */
};

struct scene_material_values {
	char name[SCENE_NAME_MAX];
	int kind; /* enum material_kind */
	double colour[3], specular[3], roughness, ior;
	bool thin;
	char texture[INI_PATH_MAX];
};

struct scene_file {
	bool tsai_given;
	struct tsai_camera tsai;
	struct scene_camera_values camera;
	struct scene_dome_values dome;
	struct scene_render_values render;
	struct scene_ground_values ground;
	struct scene_mesh_values mesh[SCENE_MESHES_MAX];
	int mesh_count;
	struct scene_poses_values poses;
	struct scene_keyframe_values keyframe[SCENE_KEYFRAMES_MAX]; /* sorted by pose */
	int keyframe_count;
	struct scene_material_values material[SCENE_MATERIALS_MAX];
	int material_count;
};

/* Reads a scene file. -ENOENT ..., -EINVAL. Faults name the file and, if the parser found them,
 * line, section and key. struct scene_file is large: put it on the heap. */
int scene_file_read(struct scene_file *file, const char *path, struct fault *fault);
/* Reads a scene file from memory, for tests; `name` stands for the path in faults. */
int scene_file_read_memory(struct scene_file *file, const char *text, size_t bytes,
			   const char *name, struct fault *fault);

/* Finds the material of this name, or NULL. */
const struct scene_material_values *scene_file_material(const struct scene_file *file,
							const char *name);

/* Sets the defaults of the section [render]. */
void scene_render_defaults(struct scene_render_values *values);

/* Writes a sample file that has every key with its default, range and meaning. */
void scene_file_write_sample(FILE *stream);

#endif
