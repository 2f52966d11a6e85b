/* SPDX-License-Identifier: MIT */
/*
 * HDMI's CEC: a television is told to go to standby, or to wake and show this machine. The adapter
 * needs an address of the kind that a player has; one that another program has claimed is used. The
 * messages are those of HDMI 1.4, supplement 1, CEC 15.
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/cec-funcs.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "drivers/drivers.h"

/* The address, or -errno. */
static int own_address(int fd)
{
	struct cec_log_addrs addresses = {.num_log_addrs = 0};

	if (ioctl(fd, CEC_ADAP_G_LOG_ADDRS, &addresses))
		return -errno;
	if (addresses.num_log_addrs == 0) {
		addresses = (struct cec_log_addrs){
			.cec_version = CEC_OP_CEC_VERSION_1_4,
			.vendor_id = CEC_VENDOR_ID_NONE,
			.num_log_addrs = 1,
			.osd_name = "inlay",
			.primary_device_type = {CEC_OP_PRIM_DEVTYPE_PLAYBACK},
			.log_addr_type = {CEC_LOG_ADDR_TYPE_PLAYBACK},
		};
		if (ioctl(fd, CEC_ADAP_S_LOG_ADDRS, &addresses))
			return -errno;
	}
	return addresses.log_addr[0] == CEC_LOG_ADDR_INVALID ? -ENOTCONN : addresses.log_addr[0];
}

static int message_send(int fd, struct cec_msg *message)
{
	if (ioctl(fd, CEC_TRANSMIT, message))
		return -errno;
	return cec_msg_status_is_ok(message) ? 0 : -ENOTCONN;
}

static int television_switch(int fd, bool on)
{
	const int own = own_address(fd);
	struct cec_msg message;
	__u16 place; /* in the tree of HDMI's cables */
	int err;

	if (own < 0)
		return own;
	cec_msg_init(&message, (__u8)own, CEC_LOG_ADDR_TV);
	if (on)
		cec_msg_image_view_on(&message);
	else
		cec_msg_standby(&message);
	err = message_send(fd, &message);
	if (err || !on)
		return err;
	if (ioctl(fd, CEC_ADAP_G_PHYS_ADDR, &place))
		return -errno;
	cec_msg_init(&message, (__u8)own, CEC_LOG_ADDR_BROADCAST);
	cec_msg_active_source(&message, place);
	return message_send(fd, &message);
}

int cec_switch(const char *device, bool on, struct fault *fault)
{
	const int fd = open(device, O_RDWR | O_CLOEXEC);
	int err = fd < 0 ? -errno : television_switch(fd, on);

	if (fd >= 0)
		close(fd);
	return err ? fault_say(fault, err, "%s: the television is not told to %s: %s", device,
			       on ? "wake" : "go to standby",
			       err == -ENOTCONN ? "none answers" : strerror(-err))
		   : 0;
}
