tests_PACKAGES := cmocka $(drivers_PACKAGES) $(hal_PACKAGES)
UNIT_TESTS := \
	tests/unit/test_cow.c \
	tests/unit/test_ini.c
FUZZ_TARGETS :=
CLI_TESTS :=
ACCURACY_TESTS :=
include tests/vm/vm.mk
