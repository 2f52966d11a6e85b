/* SPDX-License-Identifier: MIT */
#include <stddef.h>

#include "app/bench/bench.h"
#include "app/settings.h"

int main(int argc, char **argv)
{
	static const struct command *const commands[] = {
		&command_run,	  &command_control, &command_still, &command_grab,
		&command_devices, &command_check,   &command_bench, NULL};

	return program_run(
		"inlay",
		"Stands a virtual object in a live picture, lit by the light that is there.\n"
		"Exit codes: 0 done, 1 failed, 2 wrong usage.\n\n",
		commands, argc, argv);
}
