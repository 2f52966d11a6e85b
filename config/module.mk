CONFIG_SOURCES := \
	config/config.c \
	config/config_changes.c \
	config/config_keys.c
