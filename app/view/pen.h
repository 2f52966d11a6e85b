/* SPDX-License-Identifier: MIT */
/* Lines and short texts in a picture, drawn with cairo. What is drawn has a dark edge, to be seen
 * on every picture. */
#ifndef INLAY_APP_VIEW_PEN_H
#define INLAY_APP_VIEW_PEN_H

#include "hal/frame/frame.h"

struct pen;

/* A pen for a canvas, which it borrows until pen_drop(). letter_px: height of letters; lines are an
 * eighth as wide. NULL: no memory, or a build without cairo; a pen that is NULL draws nothing. */
struct pen *pen_take(const struct canvas *canvas, double letter_px);
void pen_drop(struct pen *pen);

/* A line through points, in pixels (x right, y down, corner of the picture at 0); a point that is
 * not finite interrupts it. width: 1 is the usual one. */
void pen_line(struct pen *pen, const double (*points)[2], int count, const double rgb[3],
	      double width);

void pen_ring(struct pen *pen, const double centre[2], double radius, const double rgb[3]);

/* A text, UTF-8, whose middle stands at a point; it is moved to lie in the picture. */
void pen_text(struct pen *pen, const double at[2], const char *text, const double rgb[3]);

#endif
