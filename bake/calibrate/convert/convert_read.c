/* SPDX-License-Identifier: MIT */
/* What the words of OpenCV, ROS and Kalibr mean: a lens, or a sentence why it is none of ours. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/calibrate/convert/convert.h"
#include "bake/calibrate/convert/convert_words.h"
#include "hal/base/log.h"
#include "hal/base/text_file.h"

/* ---- what kind of lens ---- */

static bool is_one_of(const char *text, const char *const *names)
{
	while (*names && strcmp(text, *names) != 0)
		names++;
	return *names;
}

static int take_model(struct lens *lens, const struct lens_words *w)
{
	static const char *const fisheyes[] = {"equidistant", "fisheye", NULL};
	static const char *const pinholes[] = {
		"plumb_bob", "rational_polynomial", "radtan", "none", "pinhole", "", NULL};
	/* ROS's older files name the distortion by camera_model; Kalibr names the projection by
	 * it */
	const struct words_text *model = w->distortion_model.line ? &w->distortion_model
								  : &w->camera_model;
	const char *const key = model == &w->camera_model ? "camera_model" : "distortion_model";

	if (w->fisheye >= 0)
		lens->fisheye = w->fisheye == 1;
	if (!model->line)
		return 0;
	lens->fisheye = is_one_of(model->text, fisheyes);
	if (lens->fisheye || is_one_of(model->text, pinholes))
		return 0;
	return fault_say(
		w->fault, -EINVAL,
		"%s:%d: %s: %s, expected plumb_bob, radtan, rational_polynomial, equidistant or fisheye",
		w->path, model->line, key, model->text);
}

static int take_part(const struct lens_words *w)
{
	if (!w->part.line)
		return 0;
	return fault_say(
		w->fault, -EINVAL,
		"%s:%d: the picture is binned or cut out (%s), but K is of the whole one: expected a message of the whole picture",
		w->path, w->part.line, w->part.text);
}

/* One of several cameras has to be named. */
static int take_choice(const struct lens_words *w)
{
	if (w->camera && !w->chosen)
		return fault_say(w->fault, -EINVAL, "%s: has no camera %s", w->path, w->camera);
	if (!w->camera && w->second.line)
		return fault_say(
			w->fault, -EINVAL,
			"%s:%d: holds several cameras, %s and %s: expected one of them by --camera",
			w->path, w->second.line, w->first.text, w->second.text);
	return 0;
}

/* ---- its numbers ---- */

static int take_matrix(struct lens *lens, const struct lens_words *w)
{
	const struct words_matrix *m = &w->matrix;
	const double *k = m->data;

	if (m->rows != 3 || m->columns != 3 || !(k[0] > 0) || !(k[4] > 0) || k[3] != 0 ||
	    k[6] != 0 || k[7] != 0 || k[8] != 1)
		return fault_say(
			w->fault, -EINVAL,
			"%s:%d: %s: expected fx 0 cx, 0 fy cy, 0 0 1 with fx and fy above 0",
			w->path, m->line, m->key);
	if (k[1] != 0)
		return fault_say(
			w->fault, -EINVAL,
			"%s:%d: %s: a skew of %g, expected 0: rows and columns of pixels are at right angles here",
			w->path, m->line, m->key, k[1]);
	lens->focal_px[0] = k[0];
	lens->focal_px[1] = k[4];
	lens->centre_px[0] = k[2] + 0.5;
	lens->centre_px[1] = k[5] + 0.5;
	if (w->xi.line && (w->xi.count != 1 || !(w->xi.data[0] >= 0)))
		return fault_say(w->fault, -EINVAL, "%s:%d: xi: expected one number from 0",
				 w->path, w->xi.line);
	lens->xi = w->xi.data[0];
	lens->omni = lens->xi > 0;
	lens->fisheye &= !lens->omni;
	return 0;
}

/* Kalibr's [fu, fv, pu, pv], which omni begins with xi. */
static int take_intrinsics(struct lens *lens, const struct lens_words *w)
{
	const struct words_matrix *m = &w->intrinsics;
	const bool omni = !strcmp(w->camera_model.text, "omni");
	const double *k = m->data + omni;

	if (!omni && strcmp(w->camera_model.text, "pinhole") != 0)
		return fault_say(w->fault, -EINVAL,
				 "%s:%d: camera_model: %s, expected pinhole or omni", w->path,
				 w->camera_model.line ? w->camera_model.line : m->line,
				 w->camera_model.line ? w->camera_model.text : "none");
	if (m->count != 4 + omni || !(k[0] > 0) || !(k[1] > 0) || !(!omni || m->data[0] >= 0))
		return fault_say(w->fault, -EINVAL,
				 "%s:%d: %s: expected [%sfu, fv, pu, pv] with fu and fv above 0",
				 w->path, m->line, m->key, omni ? "xi, " : "");
	for (int i = 0; i < 2; i++) {
		lens->focal_px[i] = k[i];
		lens->centre_px[i] = k[2 + i] + 0.5;
	}
	lens->omni = omni;
	lens->xi = omni ? m->data[0] : 0;
	if (!omni || !lens->fisheye)
		return 0;
	return fault_say(w->fault, -EINVAL,
			 "%s:%d: distortion_model: %s of an omni camera, expected radtan or none",
			 w->path, w->distortion_model.line, w->distortion_model.text);
}

/* Four coefficients without a word of their model: K and D are what Python programs save of either
 * camera, while OpenCV's calibration program, with its longer names, says so of a fisheye. */
static int take_four(const struct lens *lens, const struct lens_words *w)
{
	const struct words_matrix *m = &w->distortion;
	static const char what[] =
		"4 of them are k1 k2 p1 p2 of a pinhole camera or k1 to k4 of a fisheye, and nothing says which";

	if (m->count != 4 || lens->fisheye || lens->omni || w->fisheye >= 0 ||
	    w->distortion_model.line || w->camera_model.line)
		return 0;
	if (strlen(m->key) == 1)
		return fault_say(
			w->fault, -EINVAL,
			"%s:%d: %s: %s: expected --fisheye, or a line distortion_model: plumb_bob",
			w->path, m->line, m->key, what);
	log_warning("%s:%d: %s: %s: a pinhole camera is taken, --fisheye takes the other", w->path,
		    m->line, m->key, what);
	return 0;
}

static int take_distortion(struct lens *lens, const struct lens_words *w)
{
	const struct words_matrix *m = &w->distortion;
	const int most = lens->fisheye ? FISHEYE_TERMS : LENS_TERMS;
	int err;

	if (!m->line) {
		if (!strcmp(w->distortion_model.text, "none"))
			return 0;
		return fault_say(w->fault, -EINVAL, "%s: has no distortion_coefficients", w->path);
	}
	if ((m->count && m->rows != 1 && m->columns != 1) ||
	    (lens->fisheye && m->count && m->count != FISHEYE_TERMS))
		return fault_say(w->fault, -EINVAL,
				 "%s:%d: %s: %d x %d of them, expected one row%s", w->path, m->line,
				 m->key, m->rows, m->columns, lens->fisheye ? " of 4" : "");
	err = take_four(lens, w);
	if (err)
		return err;
	for (int k = 0; k < m->count; k++) {
		if (k < most)
			lens->term[k] = m->data[k];
		else if (m->data[k] != 0)
			return fault_say(
				w->fault, -EINVAL,
				"%s:%d: %s: number %d is %g, expected 0: neither thin prisms nor tilted sensors are known here",
				w->path, m->line, m->key, k + 1, m->data[k]);
	}
	return 0;
}

/* Without them it is a file of another program. */
static int take_kind(const struct lens_words *w)
{
	if (w->matrix.line || w->intrinsics.line)
		return 0;
	return fault_say(w->fault, -EINVAL,
			 "%s: has no camera_matrix of OpenCV, K of ROS or intrinsics of Kalibr",
			 w->path);
}

static int take_size(struct lens *lens, const struct lens_words *w)
{
	const struct words_matrix *m = &w->resolution;
	const bool whole = m->count == 2 && m->data[0] >= 1 && m->data[1] >= 1 &&
			   m->data[0] <= TSAI_SIDE_MAX && m->data[1] <= TSAI_SIDE_MAX;

	if (whole) {
		lens->width = (int)m->data[0];
		lens->height = (int)m->data[1];
	}
	lens->width = w->width > 0 ? w->width : lens->width;
	lens->height = w->height > 0 ? w->height : lens->height;
	if (lens->width > 0 && lens->height > 0)
		return 0;
	return fault_say(w->fault, -EINVAL,
			 "%s: has no image_width and image_height, expected them here or by --size",
			 w->path);
}

/* ---- the file ---- */

/* Whether the first character that is no blank is that of XML. */
static int is_xml(const char *path, bool *xml, struct fault *fault)
{
	struct text_file file;
	int err = text_file_open(&file, path, fault);

	*xml = false;
	if (err)
		return err;
	while ((err = text_file_next(&file, fault)) > 0) {
		const char *text = file.line + strspn(file.line, " \t\r");

		if (!*text)
			continue;
		*xml = *text == '<';
		err = 0;
		break;
	}
	text_file_close(&file);
	return err;
}

int lens_read_foreign(struct lens *lens, const char *path, const char *camera, struct fault *fault)
{
	struct lens_words w = {.path = path,
			       .fault = fault,
			       .camera = camera,
			       .width = -1,
			       .height = -1,
			       .fisheye = -1};
	bool xml;
	int err = is_xml(path, &xml, fault);

	if (!err)
		err = xml ? words_read_xml(&w) : words_read_yaml(&w);
	if (!err)
		err = take_choice(&w);
	if (!err)
		err = take_part(&w);
	if (!err)
		err = take_kind(&w);
	if (!err)
		err = take_size(lens, &w);
	if (!err)
		err = take_model(lens, &w);
	if (!err)
		err = w.intrinsics.line ? take_intrinsics(lens, &w) : take_matrix(lens, &w);
	if (!err)
		err = take_distortion(lens, &w);
	return err;
}
