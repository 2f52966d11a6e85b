/* SPDX-License-Identifier: MIT */
/*
 * What a mesh file says and the bake leaves out. A reader counts it while it reads, and says it in
 * one line at the end:
 *     robot.glb: left out: normal maps of 2 materials, emission of 1, lines of 3 meshes
 */
#ifndef INLAY_BAKE_MESH_LEFT_OUT_H
#define INLAY_BAKE_MESH_LEFT_OUT_H

#include <stddef.h>

#define LEFT_OUT_MAX 32
#define LEFT_OUT_WORD 64

struct left_out {
	int count;
	struct left_out_item {
		char what[LEFT_OUT_WORD], of[LEFT_OUT_WORD];
		int times;
	} item[LEFT_OUT_MAX];
};

/* Counts one more `of` (one, such as "material") whose `what` (such as "normal maps") is left out.
 * Longer words are cut, kinds beyond LEFT_OUT_MAX are counted as "other things". */
void left_out_add(struct left_out *out, const char *what, const char *of);

/* Writes the line. Returns text, which is empty where nothing was left out. */
const char *left_out_text(const struct left_out *out, const char *path, char *text, size_t room);

/* Logs the line as a warning, once for each file; nothing where nothing was left out. */
void left_out_say(const struct left_out *out, const char *path);

#endif
