APP_SOURCES :=
APP_MAIN := app/main.c
