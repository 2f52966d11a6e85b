/* SPDX-License-Identifier: MIT */
/* The commands of inlay-bake. */
#ifndef INLAY_BAKE_BASE_COMMANDS_H
#define INLAY_BAKE_BASE_COMMANDS_H

#include "hal/options/options.h"

extern const struct command dome_command, render_command, merge_command, import_command,
	export_command, info_command, truth_command, pictures_command, preview_command,
	report_command, sky_command;

#endif
