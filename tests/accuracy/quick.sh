#!/bin/bash
# A few cells of the accuracy table as a test.
exec "$(dirname "$0")/panoramas.sh" --quick
