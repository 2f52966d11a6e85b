/* SPDX-License-Identifier: MIT */
/* The commands of `inlay`, in the order of --help. */
#ifndef INLAY_APP_COMMANDS_H
#define INLAY_APP_COMMANDS_H

#include "hal/options/options.h"

extern const struct command command_run, command_control, command_still, command_grab,
	command_devices, command_check;

#endif
