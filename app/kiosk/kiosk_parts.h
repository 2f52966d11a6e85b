/* SPDX-License-Identifier: MIT */
/* Private to app/kiosk*.c: what the kiosk is made of, and what its parts do for each other. */
#ifndef INLAY_APP_KIOSK_KIOSK_PARTS_H
#define INLAY_APP_KIOSK_KIOSK_PARTS_H

#include "app/camera/exposing.h"
#include "app/camera/eye.h"
#include "app/camera/source.h"
#include "app/kiosk/control.h"
#include "app/kiosk/kiosk.h"
#include "app/kiosk/loop.h"
#include "app/kiosk/service.h"
#include "app/kiosk/state.h"
#include "app/kiosk/stats.h"
#include "app/kiosk/timeline.h"
#include "app/pipeline/pipeline.h"
#include "app/view/overlay.h"
#include "app/view/show.h"
#include "hal/device/buttons.h"
#include "hal/device/display.h"

/* Slots of the loop: cameras come first, drivers of buttons last. */
enum { SLOT_DISPLAY = CONFIG_CAMERAS_MAX, SLOT_CONTROL, SLOT_BUTTONS };

_Static_assert(SLOT_BUTTONS + CONFIG_DRIVERS_MAX <= LOOP_SLOTS,
	       "a slot for each driver of buttons");

/* One driver of buttons. */
struct keypad {
	struct buttons buttons; /* state NULL: not there at present */
	int driver;
	struct fault said; /* the trouble that was logged last; empty: none */
};

struct kiosk {
	const struct kiosk_settings *settings;
	struct config *config; /* what is in force */
	struct loop loop;
	struct basis basis;
	struct pipeline pipeline;
	struct source sources[CONFIG_CAMERAS_MAX];
	int source_count;
	struct eyes eyes;
	struct exposing exposing; /* the fisheye's camera */
	struct fault unfit[3];	  /* of fisheye, background, scene: why the picture is of no use */
	struct fault light_said;
	bool pose_said[BASIS_POSES_MAX]; /* that it could not be shown */
	struct display display;		 /* state NULL: there is no screen at present */
	struct fault display_said;
	struct show_fit fit;   /* what display_fit() was asked for */
	bool fitted;	       /* and does */
	uint64_t shown_before; /* pictures, on screens that were lost since */
	struct keypad keypads[CONFIG_DRIVERS_MAX];
	int keypad_count;
	struct control *control; /* NULL: none, or not to be had at present */
	struct fault control_said;
	struct state *state; /* NULL: nothing is kept */
	struct service service;
	struct show show;
	struct overlay overlay;
	struct stats stats;
	/* what buttons change */
	struct pipeline_choice choice;
	struct timeline timeline;
	bool timed;	  /* there has been a frame that it goes by */
	int64_t stamp_ns; /* of the newest such frame */
	enum config_show what;
	double split;
	bool information;
	bool frozen;
	/* where we are */
	bool settled;  /* the cameras have been tried, and the screen */
	unsigned owed; /* effects of a reload that there was no memory or thread for */
	bool redraw;   /* something other than a frame changed the picture */
	bool stop;
	int64_t start_ns; /* of the loop */
	int64_t heard_ns; /* when the loop last came round */
	int64_t made_ns;  /* when a picture was last made */
	bool begun;	  /* a picture has been made: the configuration and the first cameras fit */
	uint64_t submitted; /* pictures that are on a screen or on their way to one */
	char status[STATS_TEXT_MAX + 512]; /* what the control socket is told */
};

/* ---- kiosk_complain.c ---- */

/* Logs a trouble unless it is the one that was logged last; NULL: it has passed. what: "buttons
 * gpio". */
void kiosk_complain(struct fault *said, const char *what, const struct fault *trouble);

/* ---- kiosk_open.c ---- */

/* From settings and config to cameras that are being opened. Where it fails, kiosk_close() cleans
 * up. */
int kiosk_open(struct kiosk *k, struct fault *fault);

/* Idempotent. Finishes what the screen has promised, a file perhaps: that can fail. */
int kiosk_close(struct kiosk *k, struct fault *fault);

/* How a camera's linear radiance is encoded: radiance that two views share, as the background
 * expects it. */
struct transfer_curve kiosk_curve_for(const struct config *config, const char *camera);

/* ---- kiosk_picture.c ---- */

bool kiosk_frames_are_due(struct kiosk *k);

/* A picture for the screen, if there is one and it has a buffer to draw in. frames: of what the
 * cameras hold; otherwise of what they gave before, so that cameras which go in step stay so. */
int kiosk_make_picture(struct kiosk *k, bool frames, struct fault *fault);

/* ---- kiosk_screen.c ---- */

/* Opens the screen. A failure that waiting may mend is said and is none, except that at the very
 * start (first) a screen that another program holds is one. */
int kiosk_screen_open(struct kiosk *k, bool first, struct fault *fault);

/* After an error of the open screen, which fault tells. 0: it is waited for; else the end. */
int kiosk_screen_lost(struct kiosk *k, int err, struct fault *fault);

/* What the screen has to tell. */
int kiosk_screen_events(struct kiosk *k, struct fault *fault);

/* Asks the screen to scale what is shown, where it can. */
void kiosk_screen_fit(struct kiosk *k);

uint64_t kiosk_shown(const struct kiosk *k);

/* Whether it is right that nothing reaches a screen. */
bool kiosk_screen_is_excused(const struct kiosk *k);

/* ---- kiosk_actions.c ---- */

/* 0, or -EINVAL: the basis has no such pose. */
int kiosk_act(struct kiosk *k, const struct button_press *press, struct fault *fault);
void kiosk_take_pose(struct kiosk *k, int pose); /* and the timeline goes on from it */
void kiosk_keep_state(struct kiosk *k);		 /* what is chosen at present */

/* Opens what [buttons] names and is not open. At the very start (first) a mistake of the
 * configuration is an error; everything else is said and waited for. */
int kiosk_buttons_open(struct kiosk *k, bool first, struct fault *fault);
void kiosk_buttons_read(struct kiosk *k, struct keypad *keypad);
void kiosk_buttons_close(struct kiosk *k);

/* ---- kiosk_control.c ---- */

/* The same of [control]; a socket in use is an error at the start. */
int kiosk_control_open(struct kiosk *k, bool first, struct fault *fault);
void kiosk_control_read(struct kiosk *k);
void kiosk_control_close(struct kiosk *k);

/* ---- kiosk_text.c ---- */

/* Once a second: what is wrong, and the figures. */
void kiosk_text(struct kiosk *k);

/* What is said of a chosen pose that cannot be shown. Returns the length; 0: it is. */
int kiosk_pose_trouble(const struct kiosk *k, char text[OVERLAY_TEXT_MAX]);

/* ---- kiosk_reload.c ---- */

void kiosk_reload(struct kiosk *k);

#endif
