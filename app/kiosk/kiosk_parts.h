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

/* The cameras and what is seen through them. */
struct kiosk_inputs {
	struct source sources[CONFIG_CAMERAS_MAX];
	int source_count;
	struct eyes eyes;
	struct exposing exposing; /* the fisheye's camera */
	struct fault unfit[3];	  /* of fisheye, background, scene: why the picture does not fit */
	struct fault light_said;  /* why the light cannot be measured; empty: it can */
	bool settled;		  /* each camera has been tried, and the screen */
	int64_t heard_ns;	  /* when the loop last came round */
};

/* From light and background to the pictures of a view. */
struct kiosk_picture {
	struct basis basis;
	struct pipeline *pipeline;
	struct show show;
	struct overlay overlay;
	bool pose_said[BASIS_POSES_MAX]; /* it was logged that the pose cannot be shown */
	bool redraw;			 /* something other than a frame has changed the picture */
	int64_t made_ns;		 /* when a picture was last made */
	bool begun; /* one has been made: the configuration and the first cameras fit */
};

/* What people and programs choose, and how they say so. */
struct kiosk_controls {
	struct keypad keypads[CONFIG_DRIVERS_MAX];
	int keypad_count;
	struct control *control; /* the socket; NULL: none, or not there at present */
	struct fault control_said;
	char status[STATS_TEXT_MAX + 512]; /* the socket's answer to "status" */
	struct state *state;		   /* keeps what is chosen; NULL: nothing is kept */
	struct timeline timeline;
	bool timed;	  /* a frame has come that the timeline goes by */
	int64_t stamp_ns; /* of the newest such frame */
	/* What is chosen: */
	struct pipeline_choice choice;
	enum config_show what;
	double split;
	bool information, frozen;
};

/* The screen, which may go and come back. */
struct kiosk_screen {
	struct display display; /* state NULL: there is no screen at present */
	struct fault said;	/* the trouble that was logged last; empty: none */
	struct show_fit fit;	/* what display_fit() was asked for */
	bool fitted;		/* and does */
	uint64_t shown_before;	/* pictures, on screens that were lost since */
	uint64_t submitted;	/* pictures that are on a screen or on their way to one */
};

struct kiosk {
	const struct kiosk_settings *settings;
	struct config *config; /* what is in force */
	struct loop loop;
	struct service service;
	struct stats stats;
	struct kiosk_inputs inputs;
	struct kiosk_picture picture;
	struct kiosk_controls controls;
	struct kiosk_screen screen;
	int64_t start_ns; /* of the loop */
	unsigned owed;	  /* effects of a reload that there was no memory or thread for */
	bool stop;
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

/* ---- kiosk_light.c ---- */

/* Whether there is a new frame to make a picture of: from the camera that sets the pace, and from
 * each camera that makes frames on demand. */
bool kiosk_frames_are_due(const struct kiosk_inputs *inputs);

/* What was taken for a picture. */
struct kiosk_taken {
	int64_t captured_ns; /* of the frame that set the pace; 0: there is no new one */
	bool fisheye;	     /* the fisheye's picture is a new one */
};

/* Makes pictures of the frames that the cameras hold. frames false: only where a camera has no
 * picture without, so that cameras which go in step stay so. frozen: pictures that are there stay,
 * and their cameras' frames are given back. */
struct kiosk_taken kiosk_take_frames(struct kiosk_inputs *inputs, struct pipeline *pipeline,
				     bool frames, bool frozen);

/* Fits each view to its camera's picture. composited: the background has to have the basis's size.
 * An error only before the first picture; later a view that does not fit is logged and has no
 * picture. */
int kiosk_fit_eyes(struct kiosk_inputs *inputs, const struct kiosk_picture *picture,
		   bool composited, struct fault *fault);

/* Measures the light in the fisheye's new picture. Light stays as it was where the picture cannot be
 * measured, or its exposure is not known. An error only before the first picture. */
int kiosk_measure_light(struct kiosk_inputs *inputs, const struct kiosk_picture *picture,
			struct fault *fault);

/* ---- kiosk_picture.c ---- */

/* Makes a picture for the screen, if it has a buffer to draw in. frames: of what the cameras hold;
 * else of what they gave before. */
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

uint64_t kiosk_shown(const struct kiosk_screen *screen);

/* Whether it is right that nothing reaches a screen. */
bool kiosk_screen_is_excused(const struct kiosk_screen *screen);

/* ---- kiosk_actions.c ---- */

/* 0, or -EINVAL: the basis has no such pose. */
int kiosk_act(struct kiosk *k, const struct button_press *press, struct fault *fault);
void kiosk_take_pose(struct kiosk *k, int pose); /* and the timeline goes on from it */
struct state_values kiosk_chosen(const struct kiosk_controls *controls);
void kiosk_keep_state(const struct kiosk_controls *controls); /* what is chosen at present */

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
int kiosk_pose_trouble(const struct kiosk_picture *picture, char text[OVERLAY_TEXT_MAX]);

/* ---- kiosk_reload.c ---- */

void kiosk_reload(struct kiosk *k);

#endif
