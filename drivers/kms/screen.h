/* SPDX-License-Identifier: MIT */
/* The KMS display while it is open. Private to drivers/display_kms.c. */
#ifndef INLAY_DRIVERS_KMS_SCREEN_H
#define INLAY_DRIVERS_KMS_SCREEN_H

#include "drivers/kms/connector.h"
#include "drivers/kms/console.h"
#include "drivers/kms/fit.h"
#include "drivers/kms/state.h"
#include "drivers/kms/watch.h"

#define NONE (-1)
#define BUFFERS_MAX 3
#define VERDICTS 8

/* What is shown of a buffer, and where on the screen. */
struct kms_fit {
	int width, height;
	struct kms_box box;
};

/* Whether the hardware scales pictures of a size, once asked. */
struct kms_verdict {
	int width, height; /* 0: none */
	double squash;
	bool accepted;
};

struct kms_buffer {
	uint32_t handle, stride, framebuffer;
	uint64_t bytes;
	uint8_t *map; /* NULL: not mapped */
	struct kms_fit fit;
	int64_t token;
};

struct kms_screen {
	struct kms_path path; /* path.card is ours; -1: closed */
	bool master;
	bool timestamps; /* of events are CLOCK_MONOTONIC */
	struct kms_watch watch;
	struct kms_console console;
	struct kms_connector connector; /* as seen last */
	int64_t looked_ns;

	struct kms_properties properties;
	struct kms_state before, ours;
	bool kept; /* before is known */
	bool set;  /* ours is on the screen */

	struct kms_buffer buffers[BUFFERS_MAX];
	int buffer_count;
	int on_screen;	     /* index */
	int flipping;	     /* queued in the kernel, or NONE */
	int waiting;	     /* submitted, but not yet the kernel's, or NONE */
	int64_t flip_due_ns; /* when the one that is flipping or refused must be shown; 0: none */
	struct kms_fit fit;  /* of the next pictures */
	struct kms_verdict verdicts[VERDICTS];
	int verdict_next;
	bool stalled; /* a flip never came: nothing waits for one any more */
	bool exposed; /* to be told */
	struct display_event shown;
};

/* *screen is zeroed. On failure, what it has got stays in it for kms_screen_release(). Found, its
 * buffers made, not yet shown. *situation: set where the error alone does not tell. */
int kms_screen_open(struct kms_screen *screen, const struct display_settings *settings,
		    const struct kms_options *options, enum display_situation *situation,
		    struct fault *fault);

/* -EBUSY: somebody else is. */
int kms_screen_become_master(struct kms_screen *screen, struct fault *fault);

struct kms_fit kms_screen_whole(const struct kms_screen *screen);
void kms_screen_set_fit(struct kms_state *state, const struct kms_fit *fit);

/* The mode, with this buffer. Tried before it is done, so that a refusal changes nothing. */
int kms_screen_set_mode(struct kms_screen *screen, int index, struct fault *fault);

/* err, in words. */
int kms_screen_refused(const struct kms_screen *screen, int err, const char *what,
		       struct fault *fault);

/* -EBUSY, with who has it as far as that can be seen. */
int kms_screen_held(const struct kms_screen *screen, struct fault *fault);

/* Puts back what was found, and frees *screen itself. May wait for the last flip. */
int kms_screen_release(struct kms_screen *screen);

#endif
