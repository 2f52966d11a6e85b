/* SPDX-License-Identifier: MIT */
/* Private to app/kiosk/kiosk*.c: the parts of a kiosk, and what the files do for each other. All of
 * it runs on the thread of the event loop. Functions return 0 or -errno with a fault, unless they
 * say otherwise; an error ends the kiosk. */
#ifndef INLAY_APP_KIOSK_KIOSK_PARTS_H
#define INLAY_APP_KIOSK_KIOSK_PARTS_H

#include <sys/stat.h>

#include "app/camera/eye.h"
#include "app/camera/source.h"
#include "app/control/control.h"
#include "app/control/snapshot.h"
#include "app/kiosk/kiosk.h"
#include "app/kiosk/loop.h"
#include "app/kiosk/rest.h"
#include "app/kiosk/service.h"
#include "app/kiosk/timeline.h"
#include "app/pipeline/pipeline.h"
#include "app/records/records.h"
#include "app/view/show.h"
#include "hal/device/buttons.h"
#include "hal/device/display.h"

/* Slots of the loop: cameras have the first ones, drivers of buttons the last ones. */
enum { SLOT_DISPLAY = CONFIG_CAMERAS_MAX, SLOT_CONTROL, SLOT_READING, SLOT_BUTTONS };

_Static_assert(SLOT_BUTTONS + CONFIG_DRIVERS_MAX <= LOOP_SLOTS,
	       "a slot for each driver of buttons");

/* A driver of buttons. */
struct keypad {
	struct buttons buttons; /* state NULL: absent at present */
	int driver;
	struct fault said; /* the trouble that was logged last; empty: none */
};

/* The cameras and the views of their pictures. */
struct kiosk_inputs {
	struct source sources[CONFIG_CAMERAS_MAX];
	int source_count;
	struct eyes eyes;
	struct exposing exposing; /* exposures of the fisheye's camera */
	/* Why each view does not fit its picture, as eyes_list() has them; empty: it does. */
	struct fault unfit[EYES];
	bool depth_used; /* the last look for people had depths */
	enum { DEPTH_UNSAID, DEPTH_SAID_UNUSED, DEPTH_SAID_USED } depth_said; /* in the log */
	/* the fisheye's picture is measured once the pipeline is ready for it */
	bool light_awaited;
	struct fault light_said; /* why the light cannot be measured; empty: it can */
	struct fault moved_said; /* that the background's camera was moved; empty: it was not */
	struct fault doubt_said; /* why the light is not believed; empty: it is */
	int doubted;		 /* for how many seconds it has not been believed */
	bool look_due;		 /* the next picture is looked at */
	char doubt[OVERLAY_TEXT_MAX];
	bool settled;	  /* each camera has been tried once, then the screen */
	int64_t heard_ns; /* when the loop last handled events */
};

/* From light and background to the pictures of a view. */
struct kiosk_picture {
	struct basis *basis;	/* on the heap, as the pipeline points to it */
	struct stat basis_file; /* when it was opened; all 0 where it could not be asked */
	struct pipeline *pipeline;
	struct show show;
	struct overlay overlay;
	bool pose_said[BASIS_POSES_MAX]; /* it was logged that the pose cannot be shown */
	struct tsai_camera camera;	 /* that the basis was baked for; width 0: not known */
	bool redraw;			 /* the picture changes although no frame has come */
	int64_t made_ns;		 /* when a picture was last made */
	bool begun; /* a picture has been made: the configuration fits the first cameras */
};

/* What people and programs choose, and how they say so. */
struct kiosk_controls {
	struct keypad keypads[CONFIG_DRIVERS_MAX];
	int keypad_count;
	struct control *control; /* the socket; NULL: none, or not open at present */
	struct fault control_said;
	char status[STATS_TEXT_MAX + 768]; /* the socket's answer to "status" */
	struct keeper *keeper;		   /* writes the next two */
	struct state *state;		   /* keeps what is chosen; NULL: nothing is kept */
	struct learned *learned;	   /* keeps the place without people; NULL likewise */
	struct timeline timeline;
	bool timed;	  /* a frame has come; its time begins the timeline */
	int64_t stamp_ns; /* when the newest frame was captured, by its camera's clock */
	/* What is chosen: */
	struct pipeline_choice choice;
	enum config_show view;
	double split;
	bool information, frozen;
};

/* The screen, which may go and come back. */
struct kiosk_screen {
	struct display display; /* state NULL: there is no screen at present */
	struct fault said;	/* the trouble that was logged last; empty: none */
	struct show_fit fit;	/* what display_fit() was asked for */
	bool fitted;		/* display_fit() has news it over: the hardware scales */
	uint64_t shown_before;	/* pictures shown on screens that were lost since */
	uint64_t submitted;	/* pictures that are on a screen or on their way to one */
};

struct kiosk {
	const struct kiosk_settings *settings;
	struct config *config; /* the one in force */
	struct loop loop;
	struct service service;
	struct stats stats;
	struct metrics metrics;
	struct kiosk_inputs inputs;
	struct kiosk_picture picture;
	struct kiosk_controls controls;
	struct kiosk_screen screen;
	struct rest rest;
	int64_t start_ns; /* when the loop began */
	unsigned owed; /* enum reload_effect of a reload for which memory or threads were short */
	struct reading *reading; /* kiosk_reload.c; NULL: nothing is being read */
	bool stop;
};

/* ---- kiosk_complain.c ---- */

/* Logs a trouble unless it was logged last, as *said has it; trouble NULL: logs that it has passed.
 * what: whose trouble, like "buttons gpio". */
void kiosk_complain(struct fault *said, const char *what, const struct fault *trouble);

/* ---- kiosk_parts.c: what opening and reloading share ---- */

/* The transfer curve that encodes a camera's linear radiance: the background's where the background
 * looks through it, else the fisheye's. */
struct transfer_curve kiosk_curve_for(const struct config *config, const char *camera);

/* Opens a basis, and notes what file that is. */
int kiosk_basis_open(struct basis **basis, struct stat *file, const char *path,
		     enum basis_part part, struct fault *fault);
void kiosk_basis_close(struct basis *basis); /* NULL is harmless */

/* ---- kiosk_open.c ---- */

/* Opens everything but the screen, from k->settings and k->config; the cameras are being opened
 * when it returns. After a failure kiosk_close() cleans up. */
int kiosk_open(struct kiosk *k, struct fault *fault);

/* Closes everything; idempotent. -errno where the screen cannot finish, such as a file that cannot
 * be written. */
int kiosk_close(struct kiosk *k, struct fault *fault);

/* ---- kiosk_light.c ---- */

/* Whether there is a new frame to make a picture of: from the camera that sets the pace, and from
 * each camera that makes frames on demand. */
bool kiosk_frames_are_due(const struct kiosk_inputs *inputs);

/* What is new in the frames that a picture is made of. */
struct kiosk_news {
	int64_t captured_ns; /* of the frame that set the pace; 0: there is no new one */
	bool fisheye;	     /* the fisheye's picture is a new one */
};

/* Makes pictures of the frames that the cameras hold. frames false: only for cameras that would
 * have no picture otherwise, so that cameras on demand stay in step. frozen: pictures that are
 * there stay, and newer frames are given back. */
struct kiosk_news kiosk_take_frames(struct kiosk_inputs *inputs, struct pipeline *pipeline,
				    bool frames, bool frozen);

/* Fits each view to its camera's picture. composited: the background has to have the basis's size.
 * A view that does not fit is logged and has no picture; strict not NULL: it is an error. */
int kiosk_fit_eyes(struct kiosk_inputs *inputs, const struct kiosk_picture *picture,
		   bool composited, struct fault *strict);

/* Measures the light in the fisheye's new picture. The light stays as it was where it cannot be
 * measured or a thread still prepares for it (in->light_awaited), or where the picture's exposure
 * is not known. An error only before the first picture. */
int kiosk_measure_light(struct kiosk_inputs *inputs, const struct kiosk_picture *picture,
			struct fault *fault);

/* ---- kiosk_picture.c ---- */

/* Makes a picture for the screen, if it has a buffer to draw in. frames: of new frames; else of the
 * pictures that are there. */
int kiosk_make_picture(struct kiosk *k, bool frames, struct fault *fault);

/* ---- kiosk_screen.c ---- */

/* Opens the screen. A failure that may pass is logged and returns 0; but at the very start (first)
 * a screen that another program holds is an error. */
int kiosk_screen_open(struct kiosk *k, bool first, struct fault *fault);

/* Handles an error of the open screen, which fault tells: closes it, to be opened again later. 0:
 * the kiosk waits for it; else it cannot come back. */
int kiosk_screen_lost(struct kiosk *k, int err, struct fault *fault);

/* Handles all events of the screen. */
int kiosk_screen_events(struct kiosk *k, struct fault *fault);

/* Asks the screen to scale the view by hardware; asks again only when the view's size has
 * changed. */
void kiosk_screen_fit(struct kiosk *k);

/* Pictures shown since the start. */
uint64_t kiosk_shown(const struct kiosk_screen *screen);

/* Its situation in a word, "off" where it is switched off. */
const char *kiosk_screen_situation(const struct kiosk_screen *screen);

/* Whether there is no screen to show on, so that a watchdog must not end the kiosk. */
bool kiosk_screen_is_excused(const struct kiosk_screen *screen);

/* ---- kiosk_actions.c ---- */

/* Does what a button or a command asks for. 0, or -EINVAL: there is no such pose or
 * view. */
int kiosk_act(struct kiosk *k, const struct button_press *press, struct fault *fault);

/* Chooses a pose, from which the timeline goes on. */
void kiosk_take_pose(struct kiosk *k, int pose);

/* What is chosen at present. */
struct state_values kiosk_chosen(const struct kiosk_controls *controls);

/* Keeps kiosk_chosen() over a power cut. */
void kiosk_keep_state(const struct kiosk_controls *controls);

/* Opens the drivers that [buttons] names and that are not open. At the very start (first) a mistake
 * in the configuration is an error; other failures are logged, and the drivers tried again
 * later. */
int kiosk_buttons_open(struct kiosk *k, bool first, struct fault *fault);

/* Does what a driver's buttons ask for. A driver that fails is closed and logged. */
void kiosk_buttons_read(struct kiosk *k, struct keypad *keypad);
void kiosk_buttons_close(struct kiosk *k);

/* ---- kiosk_rest.c ---- */

/* Takes the hours of the configuration and decides whether the kiosk begins at rest: before the
 * cameras are created. */
void kiosk_rest_begin(struct kiosk *k);

/* Goes to rest, or wakes, if it is time to. first: the screen has been opened at the very start. */
int kiosk_rest_look(struct kiosk *k, bool first, struct fault *fault);

/* ---- kiosk_control.c ---- */

/* Opens the socket of [control] in the same way; at the start a socket in use is an error, too. */
int kiosk_control_open(struct kiosk *k, bool first, struct fault *fault);

/* Answers the requests at the socket. */
void kiosk_control_read(struct kiosk *k);
void kiosk_control_close(struct kiosk *k);

/* ---- kiosk_snapshot.c ---- */

/* A client has asked for what the screen shows, which the next picture tells it. */
void kiosk_snapshot_ask(struct kiosk *k);

/* Answers the clients that wait where there is no screen or no picture comes; once a second. */
void kiosk_snapshot_check(struct kiosk *k);

/* Where a client waits: memory to draw in, as *aside, instead of the acquired screen, which
 * kiosk_snapshot_end() copies there and answers with, or with why drawing failed (NULL: it did
 * not). Else NULL, and *aside is the screen. */
struct snapshot *kiosk_snapshot_begin(struct kiosk *k, const struct display_buffer *screen,
				      struct display_buffer *aside);
void kiosk_snapshot_end(struct kiosk *k, struct snapshot *snapshot,
			const struct display_buffer *screen, const struct fault *failed);

/* ---- kiosk_doubt.c ---- */

/* Looks at a picture whose light was just measured, once a second. */
void kiosk_look_for_doubt(struct kiosk *k);

/* Once a second: writes a sentence on why the light that is measured cannot be right, and logs it
 * when it has been so for ten seconds. Returns 1; 0: there is no doubt. */
int kiosk_doubt(struct kiosk *k, char text[OVERLAY_TEXT_MAX]);

/* ---- kiosk_text.c ---- */

/* Updates the troubles and figures on the screen, and the service manager's status; once a
 * second. */
void kiosk_text(struct kiosk *k);

/* Writes a sentence on a chosen pose that cannot be shown. Returns its length; 0: there is no such
 * pose. */
int kiosk_pose_trouble(const struct kiosk_picture *picture, char text[OVERLAY_TEXT_MAX]);

/* ---- kiosk_reload.c ---- */

/* SIGHUP: a thread begins to read; while it reads, a further one is kept for afterwards. */
void kiosk_reload(struct kiosk *k);

/* SLOT_READING is ready: takes what the thread has read. With any fault every fault is logged, and
 * the old configuration stays. */
void kiosk_reload_take(struct kiosk *k);

/* Waits for the thread and drops what it has read. Idempotent. */
void kiosk_reload_close(struct kiosk *k);

#endif
