# SPDX-License-Identifier: MIT
CONFIG_SOURCES := \
	config/config.c \
	config/config_blocks.c \
	config/config_changes.c \
	config/config_check.c \
	config/config_files.c \
	config/config_hours.c \
	config/config_keys.c
