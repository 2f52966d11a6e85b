#!/bin/bash
# SPDX-License-Identifier: MIT
# Three minutes of the soak, so that every fault comes in the middle third, too, after which memory has to be flat
# (`make soak` is longer, and under the sanitizers too).
seed=$RANDOM
echo "# seed $seed"
exec tests/vm/soak.sh 3 $seed
