/* SPDX-License-Identifier: MIT */
/* The commands of inlay-calibrate. */
#ifndef INLAY_BAKE_CALIBRATE_COMMANDS_H
#define INLAY_BAKE_CALIBRATE_COMMANDS_H

#include "hal/options/options.h"

extern const struct command board_command, camera_command, fisheye_command, light_command,
	watch_command, convert_command, lamps_command;

#endif
