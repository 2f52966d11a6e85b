/* SPDX-License-Identifier: MIT */
/* The properties of connector, CRTC and planes that make up a picture, read and set atomically. */
#ifndef INLAY_DRIVERS_KMS_STATE_H
#define INLAY_DRIVERS_KMS_STATE_H

#include <stdint.h>

#include "drivers/kms/find.h"
#include "hal/base/fault.h"

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

#endif
