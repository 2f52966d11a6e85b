/* SPDX-License-Identifier: MIT */
/* panel.h for builds without cairo: there are no panels. */
#include "app/view/panel.h"

#include <errno.h>

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
