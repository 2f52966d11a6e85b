/* SPDX-License-Identifier: MIT */
/* pen.h for builds without cairo: nothing is drawn. */
#include "app/view/pen.h"

struct pen *pen_take(const struct canvas *canvas, double letter_px)
{
	(void)canvas;
	(void)letter_px;
	return NULL;
}

void pen_drop(struct pen *pen)
{
	(void)pen;
}

void pen_line(struct pen *pen, const double (*points)[2], int count, const double rgb[3],
	      double width)
{
	(void)pen;
	(void)points;
	(void)count;
	(void)rgb;
	(void)width;
}

void pen_ring(struct pen *pen, const double centre[2], double radius, const double rgb[3])
{
	(void)pen;
	(void)centre;
	(void)radius;
	(void)rgb;
}

void pen_text(struct pen *pen, const double at[2], const char *text, const double rgb[3])
{
	(void)pen;
	(void)at;
	(void)text;
	(void)rgb;
}
