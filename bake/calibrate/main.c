/* SPDX-License-Identifier: MIT */
/* inlay-calibrate: where the object stands, where the lights are, how bright they are. */
#include <stddef.h>

#include "bake/calibrate/commands.h"

int main(int argc, char **argv)
{
	static const struct command *const commands[] = {
		&board_command, &camera_command, &fisheye_command, &light_command,
		&lamps_command, &watch_command,	 &convert_command, NULL,
	};

	return program_run("inlay-calibrate", NULL, commands, argc, argv);
}
