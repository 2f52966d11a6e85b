/* SPDX-License-Identifier: MIT */
/*
 * What the files of the KMS display share. Private to drivers/display_kms.c and its tests.
 */
#ifndef INLAY_DRIVERS_KMS_KMS_H
#define INLAY_DRIVERS_KMS_KMS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include "hal/base/fault.h"
#include "hal/device/display.h"

enum kms_scaling { KMS_SCALING_AUTO, KMS_SCALING_NEVER };

struct kms_options {
	char connector[INI_TEXT_MAX]; /* like HDMI-A-1; empty: the first with a screen */
	char mode[INI_TEXT_MAX];      /* size and rate, or a modeline; empty: of the screen's own */
	bool force;		      /* use a connector that knows of no screen */
	int buffers;
	int scaling;	       /* enum kms_scaling */
	char vt[INI_TEXT_MAX]; /* "/dev/tty1" or "auto"; empty: none */
};

/* ---- mode.c: choosing; pure ---- */

/*
 * The mode to set, progressive: of the size asked for (0: any; without either, the size of the
 * preferred mode, or of the first), and of those the nearest in rate (0: the preferred one, else
 * the first). Returns its index, or -1: there is none.
 */
int kms_mode_choose(const drmModeModeInfo *modes, int count, int width, int height, double rate_hz);

enum { KMS_RANK_BEST = 3 };

/* How good a connector in this state (DRM_MODE_CONNECTED ...) is, with so many modes: 3 connected,
 * 2 perhaps, 1 only because it is forced, 0 not to be used. */
int kms_mode_rank(unsigned connection, int count, const struct kms_options *options);

/*
 * The mode for such a connector. *computed: it is a timing of ours, which the screen has not named.
 * -ENOLINK: there is no screen; -EINVAL: none of its modes is what was asked for.
 */
int kms_mode_pick(const struct display_settings *settings, const struct kms_options *options,
		  unsigned connection, const drmModeModeInfo *modes, int count,
		  drmModeModeInfo *mode, bool *computed);

/* The same picture, whatever the modes are called. */
bool kms_mode_same(const drmModeModeInfo *a, const drmModeModeInfo *b);

/* ---- timing.c: modes of our own; pure ---- */

/* Refreshes a second, from the pixel clock. */
double kms_mode_rate(const drmModeModeInfo *mode);

/* A progressive mode: the standard's where there is one for the size and rate (VESA DMT, CTA-861),
 * else VESA CVT with reduced blanking. */
void kms_timing(int width, int height, double rate_hz, drmModeModeInfo *mode);

/*
 * "1920x1080", "1920x1080@50", or a modeline as cvt(1) prints it: clock in MHz, four numbers
 * across, four down, +hsync or -hsync, +vsync or -vsync; "Modeline" and a quoted name may stand
 * before it. *exact: it was a modeline. -EINVAL: neither.
 */
int kms_timing_parse(const char *text, drmModeModeInfo *mode, bool *exact);

/* ---- fit.c: pure ---- */

struct kms_box {
	int x, y, width, height;
};

/* Where a picture whose pixels are height/width = squash stands, as large as the screen allows, in
 * its middle. */
struct kms_box kms_fit_box(int width, int height, double squash, int screen_width,
			   int screen_height);

/* ---- find.c ---- */

enum { KMS_CARDS = 16 }; /* /dev/dri/card0 ... are looked at */

/* The way of a picture: plane, CRTC, connector. */
struct kms_path {
	int card;	 /* descriptor; not owned */
	char device[64]; /* of the card, for messages */
	uint32_t connector, crtc, plane;
	char connector_name[32];
	drmModeModeInfo mode;
	bool computed; /* mode is not one that the screen named */
};

/* Non-blocking. -errno. */
int kms_card_open(const char *path);

/* What to do when a card may not be opened: " (is the user in the group ...?)" */
void kms_card_remedy(const char *device, char *text, size_t room);

/* "HDMI-A-1" */
void kms_connector_name(const drmModeConnector *connector, char *name, size_t room);

/*
 * Opens the card asked for, or the one with the best screen, and finds the path. Returns the
 * descriptor (non-blocking), or -errno with a fault that says what to do about it: -ENODEV or
 * -ENOENT no card, -ENOLINK no screen, -EINVAL no mode, -EACCES no permission, -ENOTSUP a card that
 * cannot do it.
 */
int kms_find(const struct display_settings *settings, const struct kms_options *options,
	     struct kms_path *path, struct fault *fault);

/* ---- list.c ---- */

int kms_list(void (*found)(void *context, const struct display_listing *listing), void *context);

/* ---- holder.c ---- */

/* Other programs that have this device open, "name (pid 123), ...", as far as this user may see
 * them. Returns how many were found. */
int kms_holders(const char *device, char *text, size_t room);

/* ---- connector.c ---- */

enum { KMS_MODES_MAX = 256 };

/* A connector's state, without allocating. */
struct kms_connector {
	uint32_t id;
	uint32_t link_property; /* to be set before: its property link-status; 0: it has none */
	unsigned connection;	/* DRM_MODE_CONNECTED ... */
	bool link_failed;	/* the screen gets no picture any more until its mode is set anew */
	int count;
	drmModeModeInfo modes[KMS_MODES_MAX];
};

/* probe: the driver asks the screen again, which may take some ten milliseconds; else what it
 * knows. -ENOENT, -ENODEV: gone. */
int kms_connector_read(int card, uint32_t id, bool probe, struct kms_connector *connector);

/* ---- watch.c ---- */

/* What there may be to do: bits. */
enum {
	KMS_READY_CARD = 1,    /* an event of the card */
	KMS_READY_HOTPLUG = 2, /* the kernel says that something about screens changed */
	KMS_READY_TICK = 4,    /* four times a second, or soon after kms_watch_soon() */
	KMS_READY_CONSOLE = 8,
	KMS_READY_GONE = 16, /* the card itself was taken out */
};

struct kms_watch {
	int set; /* epoll: the display's descriptor */
	int timer;
	int netlink; /* the kernel's own messages; -1: none to be had, the tick has to do */
};

/* console: polled too; -1: none. Descriptors of *watch are -1 before. */
int kms_watch_open(struct kms_watch *watch, int card, int console, struct fault *fault);
unsigned
kms_watch_take(struct kms_watch *watch);      /* KMS_READY_...; takes in all but card, console */
void kms_watch_soon(struct kms_watch *watch); /* a tick in some milliseconds */
void kms_watch_close(struct kms_watch *watch);

/* Whether a message of the kernel (strings, each ended by 0) is about screens. */
bool kms_watch_concerns(const char *message, size_t length);

/* ---- console.c ---- */

enum kms_switch { KMS_SWITCH_NONE, KMS_SWITCH_AWAY, KMS_SWITCH_BACK };

/* A text console that is ours: the kernel asks before it switches away. */
struct kms_console {
	int tty;  /* -1: none */
	int told; /* readable when the kernel has asked */
	int number;
};

/* vt: as the option. One per process. A failure leaves *console closed and nothing changed. */
int kms_console_open(struct kms_console *console, const char *vt, struct fault *fault);
bool kms_console_is_active(const struct kms_console *console);
void kms_console_activate(const struct kms_console *console); /* asks for a switch to it */
enum kms_switch kms_console_next(struct kms_console *console);
void kms_console_show_text(const struct kms_console *console); /* if it is the active one */
void kms_console_let_go(struct kms_console *console);	       /* answers KMS_SWITCH_AWAY */
void kms_console_taken(struct kms_console *console);	       /* answers KMS_SWITCH_BACK */
void kms_console_close(struct kms_console *console);	       /* text again; idempotent */

/* ---- state.c ---- */

/* The properties that set a picture up, by id; 0: the card has none such and need not. */
struct kms_properties {
	uint32_t connector_crtc, connector_link, crtc_active, crtc_mode;
	uint32_t crtc_degamma, crtc_matrix, crtc_gamma;
	uint32_t plane_fb, plane_crtc, plane_source[4], plane_target[4]; /* x, y, width, height */
};

enum { KMS_COVERS_MAX = 32 };

/* Another plane of the CRTC, a cursor or an overlay that somebody left there. Off it keeps its size
 * and place. */
struct kms_cover {
	uint32_t plane;
	uint64_t fb; /* 0: it is off */
};

/* Their values. What was there and what we set are both one of these. */
struct kms_state {
	uint64_t connector_crtc, connector_link, crtc_active, crtc_mode;
	uint64_t crtc_degamma, crtc_matrix, crtc_gamma; /* 0: colours are shown as they are */
	uint64_t plane_fb, plane_crtc, plane_source[4], plane_target[4];
	struct kms_cover covers[KMS_COVERS_MAX];
	int cover_count;
};

/* Ids and present values. The mode and the colours are kept as blobs of our own, because whoever
 * made the present ones may be gone when they are needed again: kms_state_forget() destroys them.
 */
int kms_state_read(const struct kms_path *path, struct kms_properties *properties,
		   struct kms_state *state, struct fault *fault);
void kms_state_forget(int card, const struct kms_state *state);

/* Makes it part of *state that all other planes which are on the CRTC at present are off. */
void kms_state_uncover(const struct kms_path *path, struct kms_state *state);

/* All of it in one atomic commit; flags as drmModeAtomicCommit(). 0 or -errno. */
int kms_state_commit(const struct kms_path *path, const struct kms_properties *properties,
		     const struct kms_state *state, uint32_t flags);

/* Picture, its part and place, nothing else: a flip that is reported as an event. Does not
 * allocate. 0 or -errno. */
int kms_state_flip(const struct kms_path *path, const struct kms_properties *properties,
		   const struct kms_state *state, void *user);

#endif
