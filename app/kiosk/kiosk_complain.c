/* SPDX-License-Identifier: MIT */
/* Troubles in the log: each is logged when it begins and when it has passed. */
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "hal/base/log.h"

void kiosk_complain(struct fault *said, const char *what, const struct fault *trouble)
{
	if (trouble && strcmp(trouble->text, said->text) != 0)
		log_warning_paced("%s: %s", what, trouble->text);
	if (!trouble && *said->text)
		log_info_paced("%s: fine again", what);
	*said = trouble ? *trouble : (struct fault){.text = ""};
}
