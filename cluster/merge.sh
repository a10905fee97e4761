#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Merges the shards of a study and analyses the result. cluster/submit submits it as a Slurm job.
# usage: merge.sh DIR PROGRAM SHARDS
set -u
dir=$1 program=$2 shards=$3
cd "$dir" || exit 1
shopt -s nullglob

# A network file system may take a minute to show files that another node has finished.
for ((waited = 0; waited < ${MONTECARTA_MERGE_WAIT:-60}; waited++)); do
  files=(shards/shard_*.h5)
  [ ${#files[@]} -lt "$shards" ] || break
  sleep 1
done
files=(shards/shard_*.h5)
echo "merge: ${#files[@]} of $shards shards are there"
if [ ! -e result.h5 ]; then
  "$program" merge result.h5 "${files[@]}" || {
    echo "merge: no result: the same cluster/submit command again computes what is missing or" \
      "damaged"
    exit 1
  }
fi
"$program" analyze result.h5 --csv tables --force >verdict.txt.new &&
  mv verdict.txt.new verdict.txt || exit 1
if command -v gnuplot >/dev/null; then
  "$program" report result.h5 -o report --force || exit 1
else
  echo "merge: no gnuplot on $(hostname): draw where there is one:" \
    "montecarta report $dir/result.h5 -o report"
fi
