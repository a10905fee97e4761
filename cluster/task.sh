#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs one shard of a study. cluster/submit submits it as a task of a Slurm array.
# usage: task.sh DIR PROGRAM SHARDS [options of montecarta run]
set -u
dir=$1 program=$2 shards=$3
shard=$(printf 'shard_%04d' "$SLURM_ARRAY_TASK_ID")
me=${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}  # $SLURM_JOB_ID may name the whole array

"$program" run "$dir/study.ini" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
  -o "$dir/shards/$shard.h5" --attempt --quiet "${@:4}" &
child=$!
trap 'heard=1; kill -TERM $child 2>/dev/null' TERM
code=127 heard=1
while [ -n "$heard" ]; do  # a signal ends wait early, so wait again
  heard=
  wait "$child"
  ended=$?
  [ $ended -eq 127 ] || code=$ended
done

case $code in
  0 | 3)  # complete; with 3 some runs failed, which is a result
    rm -f "$dir/logs/$shard.log"
    exit 0 ;;
  85)     # stopped at a checkpoint; requeue unless cancelled or restarted by the scheduler
    echo "task: checkpoint of shard $SLURM_ARRAY_TASK_ID on $(hostname), job $me"
    case $(scontrol show job --oneliner "$me" 2>/dev/null) in
      *JobState=RUNNING* | *JobState=TIMEOUT*) scontrol requeue "$me" ;;
    esac
    exit 85 ;;
  *)
    echo "task: shard $SLURM_ARRAY_TASK_ID failed on $(hostname), job $me: exit code $code"
    exit "$code" ;;
esac
