/* SPDX-License-Identifier: MIT */
/* inlay-calibrate board: a board to print. */
#include <getopt.h>
#include <stdlib.h>

#include "bake/calibrate/commands.h"
#include "bake/calibrate/observe/boards.h"
#include "hal/base/log.h"

/* Fits a4 and letter, and may be seen in part. */
#define DEFAULT_BOARD "charuco:7x9:26mm:19mm"
#define DEFAULT_PAGE "a4"

struct board_choices {
	const char *board, *page, *output;
};

#define AT(field) .place = offsetof(struct board_choices, field)

static const struct option_row options[] = {
	{"board", OPTION_TEXT, AT(board)},
	{"page", OPTION_TEXT, AT(page)},
	{"output", OPTION_TEXT, AT(output)},
	{.name = NULL},
};

static int board_run(const struct command *command, int argc, char **argv)
{
	struct board_choices c = {.board = DEFAULT_BOARD, .page = DEFAULT_PAGE};
	struct fault fault = {.text = ""};
	struct board board;
	const int status = command_read(command, argc, argv, options, &c);

	if (status != COMMAND_GOES_ON)
		return status;
	if (optind != argc)
		return command_wrong(command, "expected no more than options, not \"%s\"",
				     argv[optind]);
	if (!c.output)
		return command_wrong(command, "expected -o FILE.pdf");
	if (board_parse(&board, c.board, &fault))
		return command_wrong(command, "--board %s", fault.text);
	if (board_page_check(c.page, &fault))
		return command_wrong(command, "--%s", fault.text);
	if (board_print(&board, c.page, c.output, &fault)) {
		log_error("%s", fault.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}

const struct command board_command = {
	.name = "board",
	.usage = "[--board BOARD] [--page PAGE] -o FILE.pdf",
	.summary = "a board to print, at its true size",
	.help = "\n"
		"Print it at 100 % (not fitted to the page), measure the ruler on it, and fix it to\n"
		"something flat.\n\n"
		"  --board BOARD  charuco:COLUMNSxROWS:SQUARE:MARKER, squares with markers: may be seen in part;\n"
		"                 more words: :6x6 or :DICT_6X6_250 for other markers, :legacy for squares\n"
		"                 as OpenCV before 4.6 has them\n"
		"                 chess:COLUMNSxROWS:SQUARE, columns and rows of inner corners\n"
		"                 (" DEFAULT_BOARD ")\n"
		"  --page PAGE    a4, a3, letter (" DEFAULT_PAGE ")\n",
	.run = board_run,
};
