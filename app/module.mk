APP_SOURCES := \
	app/driver_list.c
APP_MAIN := app/main.c
