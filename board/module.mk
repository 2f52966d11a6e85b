# SPDX-License-Identifier: MIT
# Nothing here is compiled into the programs; `make kernel` is in tests/vm/vm.mk.
include board/install.mk
include board/image.mk
