/* SPDX-License-Identifier: MIT */
/* What a file of OpenCV, ROS or Kalibr says, before it is known what it means. */
#ifndef INLAY_BAKE_CALIBRATE_CONVERT_CONVERT_WORDS_H
#define INLAY_BAKE_CALIBRATE_CONVERT_CONVERT_WORDS_H

#include <stdbool.h>

#include "bake/calibrate/convert/convert.h"
#include "hal/base/fault.h"

#define WORDS_DATA_MAX 16 /* numbers of the largest matrix */
#define WORDS_NAME_MAX 64

/* A matrix, or a list as a matrix of one row. */
struct words_matrix {
	char key[WORDS_NAME_MAX]; /* as the file writes it */
	int line;		  /* line of its key; 0: not there */
	int rows, columns, count;
	double data[WORDS_DATA_MAX];
};

struct words_text {
	char text[WORDS_NAME_MAX];
	int line; /* 0: not there */
};

struct lens_words {
	const char *path;
	struct fault *fault;
	const char *camera; /* name of the camera to read, of several in one file; NULL: any */
	struct words_matrix matrix, distortion;
	struct words_matrix intrinsics, resolution; /* Kalibr */
	struct words_matrix xi;			    /* OpenCV's omnidirectional camera */
	int width, height, fisheye;		    /* -1: not given */
	struct words_text distortion_model, camera_model;
	struct words_text part; /* a key that says that the picture is a part, or smaller */
	struct words_text first, second; /* names of the first two of several cameras */
	bool chosen;			 /* there was a camera of the wanted name */
};

/* What a key means to the readers. */
enum words_kind { WORDS_UNKNOWN, WORDS_MATRIX, WORDS_INT, WORDS_TEXT };

struct words_place {
	enum words_kind kind;
	struct words_matrix *matrix;
	struct words_text *text;
	int *number, least, most;
};

/* The place of a key, whose spelling may be that of any of these programs: camera_matrix,
 * cameraMatrix, K ... */
struct words_place words_place(struct lens_words *words, const char *key);

/* -EINVAL, with "path:line: key: expected ..." as the fault. */
int words_fault(const struct lens_words *words, int line, const char *key, const char *expected);

/* Reads a whole number into the place of a key. -EINVAL. */
int words_int(const struct lens_words *words, int line, const char *key, const char *text,
	      int least, int most, int *value);

/* Appends numbers separated by blanks and commas up to the text's end, to end (0: none) or to a
 * comment; *at then stands there. -EINVAL. */
int words_numbers(const struct lens_words *words, int line, const char **at, char end,
		  struct words_matrix *m);

/* Begins a matrix at its key, which must not have been there before. -EINVAL. */
int words_begin(const struct lens_words *words, int line, const char *key, struct words_matrix *m);

/* Gives a list its rows and columns, or checks those that were said of a matrix. -EINVAL. */
int words_end(const struct lens_words *words, struct words_matrix *m, bool list);

/* Read the files, each into words that are empty but for path, fault and camera. */
int words_read_yaml(struct lens_words *words);
int words_read_xml(struct lens_words *words);

#endif
