/* SPDX-License-Identifier: MIT */
/*
 * What the service manager is told (sd_notify(3)): that the kiosk is ready, reloads, stops, and
 * that it lives. Outside of systemd, and in a build without libsystemd, nothing happens.
 *
 * The watchdog is fed with pictures that reached the screen, so that a pipeline which stands still
 * is started anew: a loop that blocks, a compositor that does not return, flips that never come.
 * The kiosk redraws at least every second and a half, so a camera without frames does not starve
 * it. Where there is no screen to show on (none connected, another program's, the console switched
 * away) waiting is right, and feeds it.
 */
#ifndef INLAY_APP_KIOSK_SERVICE_H
#define INLAY_APP_KIOSK_SERVICE_H

#include <stdbool.h>
#include <stdint.h>

struct service {
	int64_t watchdog_ns; /* it bites after so long; 0: there is none */
	int64_t fed_ns;
	bool ready;
	char status[256];
};

/* Reads what the environment says of the watchdog. */
void service_start(struct service *service);

void service_ready(struct service *service);			/* tells it once */
void service_status(struct service *service, const char *text); /* tells what has changed */
/* A picture is on the screen, or need not be. Tells it at most four times an interval. */
void service_alive(struct service *service, int64_t now_ns);
/* Around reading the configuration again. Before it is ready neither is told. */
void service_reloading(struct service *service, int64_t now_ns);
void service_reloaded(struct service *service);
void service_stopping(struct service *service);

#endif
