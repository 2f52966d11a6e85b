#!/bin/bash
# SPDX-License-Identifier: MIT
# A few cells of the accuracy table, and a small one of settings within a time, and a low sun, as tests.
cd "$(dirname "$0")" && ./panoramas.sh --quick && ./within.sh --quick && ./low_sun.sh --quick
