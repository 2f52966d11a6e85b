/* SPDX-License-Identifier: MIT */
/*
 * The text console under the picture. While the program holds it, the kernel asks before it
 * switches to another console.
 */
#ifndef INLAY_DRIVERS_KMS_CONSOLE_H
#define INLAY_DRIVERS_KMS_CONSOLE_H

#include <stdbool.h>

#include "hal/base/fault.h"

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

#endif
