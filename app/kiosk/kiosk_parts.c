/* SPDX-License-Identifier: MIT */
#include "app/kiosk/kiosk_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "app/pipeline/pipeline_config.h"
#include "hal/base/log.h"

int kiosk_basis_open(struct basis **out, struct stat *file, const char *path, enum basis_part part,
		     struct fault *fault)
{
	struct basis *basis = calloc(1, sizeof(*basis));
	int err;

	if (!basis)
		return fault_say(fault, -ENOMEM, "not enough memory");
	/* Asked before it is read: a file that comes in its place meanwhile is noticed later. */
	if (stat(path, file) < 0)
		*file = (struct stat){.st_ino = 0};
	err = pipeline_open_basis(basis, path, part, fault);
	if (err)
		free(basis);
	else
		*out = basis;
	return err;
}

void kiosk_basis_close(struct basis *basis)
{
	if (basis)
		basis_close(basis);
	free(basis);
}

struct transfer_curve kiosk_curve_for(const struct config *config, const char *camera)
{
	return !strcmp(config->background.view.camera, camera)
		       ? config_background_curve(&config->background)
		       : config_fisheye_curve(&config->fisheye);
}

/* Troubles in the log: each is logged when it begins and when it has passed. */

void kiosk_complain(struct fault *said, const char *what, const struct fault *trouble)
{
	if (trouble && strcmp(trouble->text, said->text) != 0)
		log_warning_paced("%s: %s", what, trouble->text);
	if (!trouble && *said->text)
		log_info_paced("%s: fine again", what);
	*said = trouble ? *trouble : (struct fault){.text = ""};
}
