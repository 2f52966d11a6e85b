CONFIG_SOURCES := \
	config/config.c \
	config/config_keys.c
