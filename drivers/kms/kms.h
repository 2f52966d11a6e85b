/*
 * What the files of the KMS display share: choosing a mode, finding a screen, and the state of the
 * objects that lead to it. Private to drivers/display_kms.c.
 */
#ifndef INLAY_DRIVERS_KMS_KMS_H
#define INLAY_DRIVERS_KMS_KMS_H

#include <stdbool.h>
#include <stdint.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include "hal/display.h"
#include "hal/fault.h"

struct kms_options {
	char connector[INI_TEXT_MAX]; /* like HDMI-A-1; empty: the first with a screen */
	int buffers;
};

/* ---- mode.c: pure ---- */

/* Refreshes a second, from the pixel clock. */
double kms_mode_rate(const drmModeModeInfo *mode);

/*
 * The mode to set, progressive: of the size asked for (0: any; without either, the size of the
 * preferred mode, or of the first), and of those the nearest in rate (0: the preferred one, else
 * the first). Returns its index, or -1: there is none.
 */
int kms_mode_choose(const drmModeModeInfo *modes, int count, int width, int height, double rate_hz);

/* ---- find.c ---- */

/* The way of a picture: plane, CRTC, connector. */
struct kms_path {
	int card;	 /* descriptor; not owned */
	char device[64]; /* of the card, for messages */
	uint32_t connector, crtc, plane;
	char connector_name[32];
	drmModeModeInfo mode;
};

/* Opens the card asked for, or the first with a screen that will do, and finds the path. Returns
 * the descriptor (non-blocking), or -errno with a fault that says what to do about it. */
int kms_find(const struct display_settings *settings, const char *connector, struct kms_path *path,
	     struct fault *fault);

int kms_list(void (*found)(void *context, const struct display_listing *listing), void *context);

/* ---- state.c ---- */

/* The properties that set a picture up, by id. */
struct kms_properties {
	uint32_t connector_crtc, crtc_active, crtc_mode;
	uint32_t plane_fb, plane_crtc, plane_source[4], plane_target[4]; /* x, y, width, height */
};

/* Their values. What was there and what we set are both one of these. */
struct kms_state {
	uint64_t connector_crtc, crtc_active, crtc_mode;
	uint64_t plane_fb, plane_crtc, plane_source[4], plane_target[4];
};

/* Ids and present values. The mode is kept as a blob of our own, because whoever made the present
 * one may be gone when it is needed again: destroy state->crtc_mode with
 * drmModeDestroyPropertyBlob(). */
int kms_state_read(const struct kms_path *path, struct kms_properties *properties,
		   struct kms_state *state, struct fault *fault);

/* All of it in one atomic commit; flags as drmModeAtomicCommit(). 0 or -errno. */
int kms_state_commit(const struct kms_path *path, const struct kms_properties *properties,
		     const struct kms_state *state, uint32_t flags);

#endif
