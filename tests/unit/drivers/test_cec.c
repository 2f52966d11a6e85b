/* SPDX-License-Identifier: MIT */
/* What a television is told by CEC, by an adapter that is played. */
#include <errno.h>
#include <linux/cec.h>
#include <string.h>
#include <sys/ioctl.h>

#include "drivers/drivers.h"
#include "tests/support/test.h"

static struct {
	struct cec_log_addrs addresses;
	struct cec_msg sent[4];
	int count;
	bool deaf;
} adapter;

int __wrap_ioctl(int fd, unsigned long request, ...);

int __wrap_ioctl(int fd, unsigned long request, ...)
{
	void *argument;
	va_list list;

	(void)fd;
	va_start(list, request);
	argument = va_arg(list, void *);
	va_end(list);
	switch (request) {
	case CEC_ADAP_G_LOG_ADDRS:
		memcpy(argument, &adapter.addresses, sizeof(adapter.addresses));
		return 0;
	case CEC_ADAP_S_LOG_ADDRS:
		memcpy(&adapter.addresses, argument, sizeof(adapter.addresses));
		adapter.addresses.log_addr[0] = CEC_LOG_ADDR_PLAYBACK_2;
		memcpy(argument, &adapter.addresses, sizeof(adapter.addresses));
		return 0;
	case CEC_ADAP_G_PHYS_ADDR:
		*(__u16 *)argument = 0x2100;
		return 0;
	case CEC_TRANSMIT:
		((struct cec_msg *)argument)->tx_status = adapter.deaf ? CEC_TX_STATUS_NACK
								       : CEC_TX_STATUS_OK;
		memcpy(&adapter.sent[adapter.count++], argument, sizeof(struct cec_msg));
		return 0;
	default:
		errno = ENOTTY;
		return -1;
	}
}

static void check_sent(int i, unsigned length, const char *bytes)
{
	assert_int_equal(adapter.sent[i].len, length);
	assert_memory_equal(adapter.sent[i].msg, bytes, length);
}

TEST("a television is switched")
{
	struct fault fault = {""};

	memset(&adapter, 0, sizeof(adapter));
	assert_int_equal(cec_switch("/dev/null", false, &fault), 0);
	assert_int_equal(adapter.addresses.log_addr_type[0], CEC_LOG_ADDR_TYPE_PLAYBACK);
	assert_int_equal(adapter.count, 1);
	check_sent(0, 2, "\x80\x36");
	adapter.addresses.log_addr[0] =
		CEC_LOG_ADDR_PLAYBACK_1; /* another program has claimed it */
	assert_int_equal(cec_switch("/dev/null", true, &fault), 0);
	assert_int_equal(adapter.count, 3);
	check_sent(1, 2, "\x40\x04");
	check_sent(2, 4, "\x4f\x82\x21\x00");
}

TEST("what fails is said")
{
	struct fault fault = {""};

	memset(&adapter, 0, sizeof(adapter));
	assert_int_equal(cec_switch("/dev/null/none", true, &fault), -ENOTDIR);
	assert_string_equal(fault.text,
			    "/dev/null/none: the television is not told to wake: Not a directory");
	adapter.deaf = true;
	assert_int_equal(cec_switch("/dev/null", false, &fault), -ENOTCONN);
	assert_string_equal(fault.text,
			    "/dev/null: the television is not told to go to standby: none answers");
}
