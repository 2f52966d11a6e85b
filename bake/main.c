/* SPDX-License-Identifier: MIT */
/* inlay-bake: the offline side of inlay. */
#include <stddef.h>

#include "bake/base/blas.h"
#include "bake/base/commands.h"

int main(int argc, char **argv)
{
	static const struct command *const commands[] = {
		&dome_command,	  &render_command, &merge_command, &import_command,
		&export_command,  &info_command,   &truth_command, &pictures_command,
		&preview_command, &report_command, &sky_command,   NULL,
	};

	blas_choose_kernels(argv);
	return program_run("inlay-bake", NULL, commands, argc, argv);
}
