/* SPDX-License-Identifier: MIT */
/* The KMS display while it is open: its state, opening, mode setting, release. */
#ifndef INLAY_DRIVERS_KMS_SCREEN_H
#define INLAY_DRIVERS_KMS_SCREEN_H

#include "drivers/kms/connector.h"
#include "drivers/kms/console.h"
#include "drivers/kms/fit.h"
#include "drivers/kms/second.h"
#include "drivers/kms/state.h"
#include "drivers/kms/watch.h"

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

/* Names in the fault the programs that hold the card, as far as /proc shows them. Returns
 * -EBUSY. */
int kms_screen_held(const struct kms_screen *screen, struct fault *fault);

/* Restores the state that was found and frees *screen itself. May wait for the last flip. 0, or
 * -errno: the state could not be restored. */
int kms_screen_release(struct kms_screen *screen);

#endif
