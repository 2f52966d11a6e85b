/* SPDX-License-Identifier: MIT */
#include "tests/support/thorough.h"

#include <stdlib.h>

bool thorough(void)
{
	return !SANITIZED && getenv("INLAY_THOROUGH");
}
