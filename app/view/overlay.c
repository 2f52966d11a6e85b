/* SPDX-License-Identifier: MIT */
#include "app/view/show.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "app/view/layout.h"
#include "app/view/panel.h"
#include "hal/base/log.h"
#include "hal/base/utf8.h"

/* Letters of this share of the height can be read from two metres, if they are not tiny. */
#define HEIGHT_PER_SIZE 30
#define SIZE_LEAST_PX 14

_Static_assert(OVERLAY_TEXT_MAX == PANEL_TEXT_MAX && OVERLAY_TROUBLES_MAX <= PANEL_TEXTS_MAX,
	       "a panel takes all of it");

struct overlay_drawn {
	int width, height;		      /* of the screen */
	struct panel *information, *troubles; /* NULL: built without cairo */
};

/* ---- what is said ---- */

/* Returns whether the text has changed. */
static bool replace_text(char (*place)[OVERLAY_TEXT_MAX], const char *text)
{
	char clean[OVERLAY_TEXT_MAX];

	utf8_copy(clean, sizeof(clean), text);
	if (!strcmp(*place, clean))
		return false;
	memcpy(*place, clean, sizeof(clean));
	return true;
}

void overlay_information(struct overlay *overlay, const char *text)
{
	if (!replace_text(&overlay->information, text ? text : ""))
		return;
	overlay->information_drawn = false;
}

void overlay_troubles(struct overlay *overlay, const char (*texts)[OVERLAY_TEXT_MAX], int count)
{
	bool changed;

	if (count > OVERLAY_TROUBLES_MAX)
		count = OVERLAY_TROUBLES_MAX;
	changed = count != overlay->trouble_count;
	for (int i = 0; i < count; i++)
		changed |= replace_text(&overlay->trouble[i], texts[i]);
	if (!changed)
		return;
	overlay->trouble_count = count;
	overlay->troubles_drawn = false;
}

/* ---- drawing ---- */

static void free_drawn(struct overlay_drawn *drawn)
{
	if (!drawn)
		return;
	panel_destroy(drawn->information);
	panel_destroy(drawn->troubles);
	free(drawn);
}

static int create_drawn(struct overlay *overlay)
{
	struct overlay_drawn *drawn = calloc(1, sizeof(*drawn));
	int err = drawn ? 0 : -ENOMEM;

	if (!err)
		err = panel_create(&drawn->information, PANEL_STRIP);
	if (!err)
		err = panel_create(&drawn->troubles, PANEL_WARNING);
	if (err && err != -ENOTSUP) {
		free_drawn(drawn);
		return err;
	}
	if (err)
		log_warning("built without cairo: no text is shown on the screen");
	overlay->drawn = drawn;
	return 0;
}

static int draw_panels(struct overlay *overlay, int width, int height)
{
	struct overlay_drawn *drawn = overlay->drawn;
	struct panel_room room = {width, height / 3, height / HEIGHT_PER_SIZE};
	int err = 0;

	if (room.size_px < SIZE_LEAST_PX)
		room.size_px = SIZE_LEAST_PX;
	if (!overlay->information_drawn)
		err = panel_draw(drawn->information,
				 (const char(*)[PANEL_TEXT_MAX]) & overlay->information,
				 *overlay->information ? 1 : 0, &room);
	if (err)
		return err;
	overlay->information_drawn = true;
	if (!overlay->troubles_drawn)
		err = panel_draw(drawn->troubles, (const char(*)[PANEL_TEXT_MAX])overlay->trouble,
				 overlay->trouble_count, &room);
	if (err)
		return err;
	overlay->troubles_drawn = true;
	return 0;
}

static void copy_panel(const struct panel *panel, const struct display_buffer *screen, bool below)
{
	struct picture picture = panel_picture(panel);
	int x = (screen->width - picture.width) / 2;
	int y = below ? screen->height - picture.height : 0;

	if (picture.width)
		picture_copy(&picture, screen->pixels + (size_t)y * screen->stride + (size_t)x * 4,
			     screen->stride);
}

int overlay_draw(struct overlay *overlay, const struct display_buffer *screen)
{
	struct overlay_drawn *drawn;
	int err;

	if (!overlay->drawn) {
		if (!*overlay->information && !overlay->trouble_count)
			return 0;
		err = create_drawn(overlay);
		if (err)
			return err;
	}
	drawn = overlay->drawn;
	if (!drawn->troubles)
		return 0;
	if (drawn->width != screen->width || drawn->height != screen->height)
		overlay->information_drawn = overlay->troubles_drawn = false;
	drawn->width = screen->width;
	drawn->height = screen->height;
	if (!overlay->information_drawn || !overlay->troubles_drawn) {
		err = draw_panels(overlay, screen->width, screen->height);
		if (err)
			return err;
	}
	copy_panel(drawn->troubles, screen, false);
	copy_panel(drawn->information, screen, true);
	return 0;
}

void overlay_free(struct overlay *overlay)
{
	free_drawn(overlay->drawn);
	overlay->drawn = NULL;
	overlay->information_drawn = overlay->troubles_drawn = false;
}
