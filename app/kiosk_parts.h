/* Private to app/kiosk*.c: what the kiosk is made of. */
#ifndef INLAY_APP_KIOSK_PARTS_H
#define INLAY_APP_KIOSK_PARTS_H

#include "app/eye.h"
#include "app/kiosk.h"
#include "app/loop.h"
#include "app/pipeline.h"
#include "app/show.h"
#include "app/source.h"
#include "app/stats.h"
#include "hal/buttons.h"
#include "hal/display.h"

/* Slots of the loop: cameras come first. */
enum { SLOT_DISPLAY = CONFIG_CAMERAS_MAX, SLOT_BUTTONS };

struct kiosk {
	const struct kiosk_settings *settings;
	const struct config *config;
	struct loop loop;
	struct basis basis;
	struct pipeline pipeline;
	struct source sources[CONFIG_CAMERAS_MAX];
	int source_count;
	struct eyes eyes;
	struct display display;
	struct buttons buttons; /* state NULL: none, or gone */
	struct show show;
	struct stats stats;
	/* what buttons change */
	struct pipeline_choice choice;
	enum config_show what;
	bool frozen;
	bool redraw; /* a button changed the picture */
	bool stop;
	uint64_t submitted;
};

/* From settings and config to streaming. Where it fails, kiosk_close() cleans up. */
int kiosk_open(struct kiosk *k, struct fault *fault);

/* Idempotent. Finishes what the screen has promised, a file perhaps: that can fail. */
int kiosk_close(struct kiosk *k, struct fault *fault);

#endif
