#!/bin/bash
# SPDX-License-Identifier: MIT
# A minute of the soak (`make soak` is longer, and under the sanitizers too).
seed=$RANDOM
echo "# seed $seed"
exec tests/vm/soak.sh 1 $seed
