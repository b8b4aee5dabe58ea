#!/bin/sh
# Trains the built-in vocabulary (kinloop/place/vocabulary/orb.kinvoc). The same images and the same feature extractor give the
# same bytes, on any number of cores. Rebuild afterwards: the library embeds the file.
#
#   scripts/train_default_vocabulary.sh [IMAGES] [KINLOOP]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
images=${1:-$root/../shared/data/vocabulary_images}
kinloop=${2:-$root/build/release/apps/kinloop}
exec "$kinloop" vocab train "$images" -o "$root/kinloop/place/vocabulary/orb.kinvoc" -k 32 -L 3 --count 2000 --seed 1
