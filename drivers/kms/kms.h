/* SPDX-License-Identifier: MIT */
/* The parts of display_kms.c. Those that touch no device say so. */
#ifndef INLAY_DRIVERS_KMS_KMS_H
#define INLAY_DRIVERS_KMS_KMS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <xf86drmMode.h>

#include "hal/base/fault.h"
#include "hal/device/display.h"
#include "hal/frame/frame.h"
#include "hal/ini/ini.h"

/* The keys of the KMS display: [screen] kms.*. */

enum kms_scaling { KMS_SCALING_AUTO, KMS_SCALING_NEVER };
enum kms_range { KMS_RANGE_AUTO, KMS_RANGE_FULL, KMS_RANGE_LIMITED };

struct kms_options {
	char connector[INI_TEXT_MAX]; /* like HDMI-A-1; empty: the first with a screen */
	char second[INI_TEXT_MAX];    /* the connector of a second screen; empty: none */
	char mode[INI_TEXT_MAX];      /* size and rate, or a modeline; empty: one of the screen's */
	bool force;		      /* use a connector that reports no screen */
	int buffers;		      /* framebuffers, 2 or 3 */
	int scaling;		      /* enum kms_scaling */
	int range;		      /* enum kms_range */
	char vt[INI_TEXT_MAX];	      /* "/dev/tty1" or "auto"; empty: no console is taken */
};

/* Computes and parses modes that the screen has not reported. Pure: touches no device. */

/* Refresh rate in Hz, from the pixel clock and the totals; 0: the mode has no totals. */
double kms_mode_rate(const drmModeModeInfo *mode);

/* Makes a progressive mode: the standard timing for the size and rate if there is one (VESA DMT,
 * CTA-861), else VESA CVT with reduced blanking. */
void kms_timing(int width, int height, double rate_hz, drmModeModeInfo *mode);

/*
 * Reads "1920x1080", "1920x1080@50", or a modeline as cvt(1) prints it: clock in MHz, four numbers
 * across, four down, +hsync or -hsync, +vsync or -vsync. "Modeline" and a quoted name may stand
 * before it. *exact: the text was a modeline. 0, or -EINVAL: the text is neither.
 */
int kms_timing_parse(const char *text, drmModeModeInfo *mode, bool *exact);

/* Chooses one of the modes that a screen reports. Pure: touches no device. */

/*
 * Chooses a progressive mode. Width or height 0 accepts any; if both are 0, the size is that of the
 * preferred mode, else of the first one. Among the modes of that size the one nearest to rate_hz
 * wins; with a rate of 0 the preferred one, else the first. Returns its index, or -1: there is
 * none.
 */
int kms_mode_choose(const drmModeModeInfo *modes, int count, int width, int height, double rate_hz);

enum { KMS_RANK_BEST = 3 };

/* Ranks a connector by its state (DRM_MODE_CONNECTED ...) and number of modes: 3 connected, 2 state
 * unknown but with modes or kms.mode, 1 used only because of kms.force, 0 unusable. */
int kms_mode_rank(unsigned connection, int count, const struct kms_options *options);

/*
 * Picks the mode for a connector in this state. *computed: the mode is a timing from timing.h, not
 * one that the screen reported. 0; -ENOLINK: there is no screen; -EINVAL: no mode fits the
 * settings.
 */
int kms_mode_pick(const struct display_settings *settings, const struct kms_options *options,
		  unsigned connection, const drmModeModeInfo *modes, int count,
		  drmModeModeInfo *mode, bool *computed);

/* Whether both modes have the same timing; names and type flags do not count. */
bool kms_mode_same(const drmModeModeInfo *a, const drmModeModeInfo *b);

/* Where a scaled picture stands on the screen. Pure: touches no device. */

struct kms_box {
	int x, y, width, height; /* px of the screen */
};

/* The largest centred box on the screen for a picture whose pixels have height / width = squash. */
struct kms_box kms_fit_box(int width, int height, double squash, int screen_width,
			   int screen_height);

/* Finds the card, connector, CRTC and plane that show the picture. */

enum { KMS_CARDS = 16 }; /* /dev/dri/card0 to card15 are looked at */

/* The path that a picture takes: plane, CRTC, connector. */
struct kms_path {
	int card;	 /* descriptor; -1: none */
	char device[64]; /* path of the card, for messages */
	uint32_t connector, crtc, plane;
	char connector_name[32];
	drmModeModeInfo mode;
	bool computed; /* the screen has not reported this mode */
	/* Those that another screen uses; 0: none. */
	uint32_t taken_connector, taken_crtc, taken_plane;
};

/* Opens a card, non-blocking. Returns a descriptor that the caller closes, or -errno. */
int kms_card_open(const char *path);

/* Writes advice for a card that may not be opened: " (is the user in the group ...?)". */
void kms_card_remedy(const char *device, char *text, size_t room);

/* Writes the connector's name, like "HDMI-A-1". */
void kms_connector_name(const drmModeConnector *connector, char *name, size_t room);

/*
 * Opens the card of the settings, or the one with the best screen, and fills in the path. Returns
 * the descriptor (non-blocking; the caller closes it), or -errno with a fault that says what to do:
 * -ENODEV or -ENOENT no card, -ENOLINK no screen, -EINVAL no mode, -EACCES no permission, -ENOTSUP
 * the card lacks something that is needed.
 */
int kms_find(const struct display_settings *settings, const struct kms_options *options,
	     struct kms_path *path, struct fault *fault);

/* Fills in the path to that screen of the options' two which *first is not, on the same card: with
 * a mode of the first one's size where it has one. *path keeps the connector even if there is no
 * screen. 0 or -errno as above. */
int kms_find_second(const struct kms_options *options, const struct kms_path *first,
		    struct kms_path *path, struct fault *fault);

/* Lists cards, connectors and modes for people. */

/* display_ops.list of KMS: calls found() for each card. Returns their number, or -ENOMEM. */
int kms_list(void (*found)(void *context, const struct display_listing *listing), void *context);

/* Properties of the connector that describe the panel behind it. */

/* By how much a picture has to be turned to be upright on the panel, as it is built in ("panel
 * orientation"). Upright where the kernel does not know. */
enum picture_turn kms_panel_turn(const struct kms_path *path);

/* Finds the value of an enumerated property by its name. 0 or -ENOENT. */
int kms_panel_value(int card, uint32_t property, const char *name, uint64_t *value);

/* The name in "Broadcast RGB" of a range of [screen] kms.range. */
const char *kms_range_name(enum kms_range range);

/* Reads the state of a connector while pictures flow. */

enum { KMS_MODES_MAX = 256 };

struct kms_connector {
	uint32_t id;
	uint32_t link_property; /* id of link-status, set by the caller; 0: the card has none */
	unsigned connection;	/* DRM_MODE_CONNECTED ... */
	bool link_failed;	/* the screen gets no picture until its mode is set again */
	int count;		/* modes */
	drmModeModeInfo modes[KMS_MODES_MAX];
};

/* Reads the state without allocating. probe: the kernel asks the screen, which may take tens of
 * milliseconds; otherwise it reports what it last knew. 0; -ENOENT, -ENODEV: the connector or card
 * is gone; -E2BIG: more than KMS_MODES_MAX modes, and modes are not filled in. */
int kms_connector_read(int card, uint32_t id, bool probe, struct kms_connector *connector);

/* The properties of connector, CRTC and planes that make up a picture, read and set atomically. */

/* Ids of the properties; 0: the card lacks this optional property. */
struct kms_properties {
	uint32_t connector_crtc, connector_link, connector_range, crtc_active, crtc_mode;
	uint32_t crtc_degamma, crtc_matrix, crtc_gamma;
	uint32_t plane_fb, plane_crtc, plane_source[4], plane_target[4]; /* x, y, width, height */
};

enum { KMS_COVERS_MAX = 32 };

/* Another plane on the CRTC: a cursor or an overlay that another program left there. While it is
 * off it keeps its size and place. */
struct kms_cover {
	uint32_t plane;
	uint64_t fb; /* framebuffer; 0: the plane is off */
};

/* Values of the properties. Both the state that was found and the one that is set have this
 * type. */
struct kms_state {
	uint64_t connector_crtc, connector_link, connector_range, crtc_active, crtc_mode;
	uint64_t crtc_degamma, crtc_matrix, crtc_gamma; /* blobs; 0: colours pass unchanged */
	uint64_t plane_fb, plane_crtc;
	uint64_t plane_source[4]; /* px of the framebuffer, 16.16 fixed point */
	uint64_t plane_target[4]; /* px of the screen */
	struct kms_cover covers[KMS_COVERS_MAX];
	int cover_count;
};

/* Reads ids and present values. Mode and colours are copied into blobs of this process, because
 * the process that made the present ones may be gone when they are needed again. The caller
 * destroys them with kms_state_forget(), after a failure too. -ENOTSUP: a mandatory property is
 * missing. */
int kms_state_read(const struct kms_path *path, struct kms_properties *properties,
		   struct kms_state *state, struct fault *fault);
void kms_state_forget(int card, const struct kms_state *state);

/* Adds to *state that all other planes which are on the CRTC at present are off. */
void kms_state_uncover(const struct kms_path *path, struct kms_state *state);

/* Sets everything in one atomic commit; flags as drmModeAtomicCommit(). 0 or -errno. */
int kms_state_commit(const struct kms_path *path, const struct kms_properties *properties,
		     const struct kms_state *state, uint32_t flags);

/* What one screen shows at a flip. */
struct kms_flip {
	const struct kms_path *path;
	const struct kms_properties *properties;
	const struct kms_state *state;
};

/* Page flip of one or two screens of a card: sets framebuffer, source and target only, without
 * waiting. The kernel reports it as an event for each screen that carries user. Does not allocate.
 * 0 or -errno. */
int kms_state_flip(const struct kms_flip *flips, int count, void *user);

/*
 * The text console under the picture. While the program holds it, the kernel asks before it
 * switches to another console.
 */

enum kms_switch { KMS_SWITCH_NONE, KMS_SWITCH_AWAY, KMS_SWITCH_BACK };

struct kms_console {
	int tty;    /* -1: no console is held */
	int told;   /* pipe: readable when the kernel has asked for a switch */
	int number; /* N of /dev/ttyN */
};

/* Takes the console that the option vt names; an empty vt takes none. Only one console per process.
 * A failure leaves *console closed and changes nothing. */
int kms_console_open(struct kms_console *console, const char *vt, struct fault *fault);

bool kms_console_is_active(const struct kms_console *console);
void kms_console_activate(const struct kms_console *console); /* asks for a switch to it */

/* Returns the oldest switch that the kernel asks for; never blocks. */
enum kms_switch kms_console_next(struct kms_console *console);

/* Makes the kernel draw the console's text, if the console is the active one. */
void kms_console_show_text(const struct kms_console *console);

void kms_console_let_go(struct kms_console *console); /* answers KMS_SWITCH_AWAY */
void kms_console_taken(struct kms_console *console);  /* answers KMS_SWITCH_BACK */
void kms_console_close(struct kms_console *console);  /* shows the text again; idempotent */

/*
 * What happens to a screen while it is open: events of the card, hotplug messages of the kernel and
 * a slow timer, behind one epoll descriptor.
 */

/* Bits that kms_watch_take() returns. */
enum {
	KMS_READY_CARD = 1,    /* the card has an event to read */
	KMS_READY_HOTPLUG = 2, /* the kernel reports a change of connectors */
	KMS_READY_TICK = 4,    /* four times a second, or soon after kms_watch_soon() */
	KMS_READY_CONSOLE = 8, /* the text console is to be switched */
	KMS_READY_GONE = 16,   /* the card itself was removed */
};

struct kms_watch {
	int set;     /* epoll: the display's descriptor */
	int timer;   /* timerfd of the tick */
	int netlink; /* hotplug messages of the kernel; -1: forbidden, only the tick is left */
};

/* Starts watching. console: descriptor of kms_console.told; -1: none. All members of *watch are -1
 * before. kms_watch_close() cleans up after a failure too. */
int kms_watch_open(struct kms_watch *watch, int card, int console, struct fault *fault);

/* Returns KMS_READY_... bits without waiting. Reads everything but the card and the console. */
unsigned kms_watch_take(struct kms_watch *watch);

void kms_watch_soon(struct kms_watch *watch);  /* brings the next tick forward to 4 ms from now */
void kms_watch_close(struct kms_watch *watch); /* idempotent */

/* Whether a hotplug message (strings, each ended by NUL) is about graphics cards. */
bool kms_watch_concerns(const char *message, size_t length);

/*
 * A second screen of the same card that shows the same buffers, at a mode of its own. It comes and
 * goes without the first one noticing.
 */

struct kms_second {
	struct kms_path path; /* card borrowed; connector 0: not found yet */
	struct kms_properties properties;
	struct kms_state before, ours;
	struct kms_connector connector;
	bool kept;  /* before is filled in */
	bool shown; /* it shows what the first one shows, with each flip */
};

/* Finds the connector that *first does not use and shows a framebuffer of width x height on it.
 * Nothing happens if it is shown already, or if there is no screen. A failure is logged. */
void kms_second_show(struct kms_second *second, const struct kms_options *options,
		     const struct kms_path *first, uint32_t framebuffer);

/* Looks whether the screen has come or gone, or has other modes, and shows or leaves it. probe: as
 * for kms_connector_read(). */
void kms_second_look(struct kms_second *second, const struct kms_options *options,
		     const struct kms_path *first, uint32_t framebuffer, bool probe);

/* Switches it off; waits for a pending flip. */
void kms_second_hide(struct kms_second *second);

/* Restores what was found. Idempotent. */
void kms_second_release(struct kms_second *second);

/* The KMS display while it is open: its state, opening, mode setting, release. */

#define NONE (-1)
#define BUFFERS_MAX 3
#define VERDICTS 8

/* The part of a buffer that is shown, from its upper left corner, and its box on the screen. */
struct kms_fit {
	int width, height;
	struct kms_box box;
};

/* The hardware's answer whether it scales pictures of this size, kept so that it is asked once. */
struct kms_verdict {
	int width, height; /* 0: empty entry */
	double squash;
	bool accepted;
};

struct kms_verdicts {
	struct kms_verdict entry[VERDICTS];
	int next; /* the entry that the next verdict replaces */
};

struct kms_buffer {
	uint32_t handle, stride, framebuffer;
	uint64_t bytes;
	uint8_t *map; /* NULL: not mapped */
	struct kms_fit fit;
	int64_t token;
};

/* The buffers, and which of them is where. */
struct kms_swap {
	struct kms_buffer buffers[BUFFERS_MAX];
	int count;
	int shown;	/* index of the buffer on the screen, or NONE */
	int flipping;	/* index of the buffer queued in the kernel, or NONE */
	int waiting;	/* index of the submitted buffer that is not queued yet, or NONE */
	int64_t due_ns; /* deadline of the flip that is queued or was refused; 0: none */
	bool stalled;	/* a flip missed its deadline: close() must not wait for it */
};

struct kms_screen {
	struct kms_path path; /* owns path.card; -1: closed */
	bool master;	      /* this process is DRM master of the card */
	bool timestamps;      /* times of events are of CLOCK_MONOTONIC */
	struct kms_watch watch;
	struct kms_console console;
	struct kms_connector connector; /* as read last */
	int64_t looked_ns;		/* when it was read */

	struct kms_properties properties;
	struct kms_state before, ours; /* found at opening; set by this driver */
	bool kept;		       /* before is filled in */
	bool set;		       /* ours is on the screen */

	struct kms_second second; /* another screen that shows the same */
	int flips_due;		  /* events that the queued flip still owes, one a screen */
	int64_t flip_ns;	  /* time of the first screen's */

	struct kms_swap swap;
	struct kms_fit fit; /* for the buffers acquired next */
	struct kms_verdicts verdicts;
	bool exposed;		    /* DISPLAY_EXPOSED is to be reported */
	struct display_event shown; /* to be reported, unless DISPLAY_NOTHING */
};

/* Finds the screen and creates its buffers; sets no mode yet. *screen is zeroed before. After a
 * failure too, kms_screen_release() cleans up. Sets *situation where the error alone does not tell
 * it. */
int kms_screen_open(struct kms_screen *screen, const struct display_settings *settings,
		    const struct kms_options *options, enum display_situation *situation,
		    struct fault *fault);

/* Becomes DRM master of the card. -EBUSY: another program is. */
int kms_screen_become_master(struct kms_screen *screen, struct fault *fault);

/* The fit that shows a whole buffer on the whole screen. */
struct kms_fit kms_screen_whole(const struct kms_screen *screen);
void kms_screen_set_fit(struct kms_state *state, const struct kms_fit *fit);

/* Sets the mode and shows the buffer of this index. A test commit comes first, so that a refusal
 * changes nothing. */
int kms_screen_set_mode(struct kms_screen *screen, int index, struct fault *fault);

/* Switches the screen off (DPMS) and keeps everything else. Waits for a pending flip. */
int kms_screen_set_dark(struct kms_screen *screen, struct fault *fault);

/* Says in the fault that the driver cannot do `what`. Returns err. */
int kms_screen_refused(const struct kms_screen *screen, int err, const char *what,
		       struct fault *fault);

/* Says in the fault that another program holds the card. Returns -EBUSY. */
int kms_screen_held(const struct kms_screen *screen, struct fault *fault);

/* Restores the state that was found and frees *screen itself. May wait for the last flip. 0, or
 * -errno: the state could not be restored. */
int kms_screen_release(struct kms_screen *screen);

#endif
