/* SPDX-License-Identifier: MIT */
/* panel.h for builds without cairo: there are no panels, and pens draw nothing. */
#include <errno.h>

#include "app/view/panel.h"

int panel_create(struct panel **panel, enum panel_kind kind)
{
	(void)kind;
	*panel = NULL;
	return -ENOTSUP;
}

int panel_draw(struct panel *panel, const char (*texts)[PANEL_TEXT_MAX], int count,
	       const struct panel_room *room)
{
	(void)panel;
	(void)texts;
	(void)count;
	(void)room;
	return -ENOTSUP;
}

struct picture panel_picture(const struct panel *panel)
{
	(void)panel;
	return (struct picture){.width = 0};
}

void panel_destroy(struct panel *panel)
{
	(void)panel;
}

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
