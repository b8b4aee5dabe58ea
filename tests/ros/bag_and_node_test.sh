#!/usr/bin/env bash
# The same simulated frames from files, from a bag, and played to the node with roscore. The trajectories must
# be identical, and the covariances of the node those of the run on files, in the axes of the map.
# Usage: bag_and_node_test.sh KINLOOP MAKE_BAG KINLOOP_NODE        exit code 77: no roscore or rosbag
set -euo pipefail
kinloop="$1" make_bag="$2" node="$3"
command -v roscore >/dev/null && command -v rosbag >/dev/null || exit 77

folder="$(mktemp -d)"
pids=()
clean_up() {
  local status=$?
  if [[ $status -ne 0 ]]; then tail -n 20 "$folder"/*.log || true; fi
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$folder"
}
trap clean_up EXIT

# Simulation time begins at 0, which ROS takes for "no time": shift it to second 10.
"$kinloop" simulate room --frames 45 --size 320x240 --quiet -o "$folder/frames"
for list in rgb.txt depth.txt associations.txt; do
  sed -i -E 's/(^| )([0-9]+\.[0-9]+)( )/\11\2\3/g' "$folder/frames/$list"
done
"$make_bag" "$folder/frames" "$folder/frames.bag"

"$kinloop" run "$folder/frames" -q -o "$folder/files" --poses-to "$folder/poses.jsonl"
"$kinloop" run "$folder/frames.bag" --camera "$folder/frames/camera.yaml" -q -o "$folder/bag"
cmp "$folder/files/trajectory.txt" "$folder/bag/trajectory.txt"
echo "the bag read directly: the same"

export ROS_IP=127.0.0.1 ROS_HOME="$folder/ros"

# Below the ports that the kernel hands out; another process may still hold one, so several are tried.
start_roscore() {
  for _ in 1 2 3 4 5; do
    local port=$((10000 + RANDOM % 20000))
    export ROS_MASTER_URI="http://127.0.0.1:$port"
    roscore -p "$port" >"$folder/roscore.log" 2>&1 &
    roscore_pid=$!
    pids=("$roscore_pid")
    for _ in $(seq 60); do
      kill -0 "$roscore_pid" 2>/dev/null || break
      # A run id that this roscore has set: the port may be that of another one.
      grep -q "setting /run_id" "$folder/roscore.log" && timeout 5 rosparam list >/dev/null 2>&1 && return
      sleep 0.5
    done
  done
  return 1
}

subscribed() {  # subscribed TOPIC: whether some node has subscribed to it
  /usr/bin/python3 -c 'import sys, rosgraph
_, subscribers, _ = rosgraph.Master("/test").getSystemState()
sys.exit(sys.argv[1] not in dict(subscribers))' "$1" 2>/dev/null
}

wait_for() {  # wait_for COMMAND...: until it succeeds, for a minute at most
  for _ in $(seq 120); do "$@" && return || sleep 0.5; done
  return 1
}

# Plays the bag to a new node, and records what that publishes. What is played before the node has connected is lost.
play_to_node() {
  rm -f "$folder"/published.bag*
  rosbag record -q -O "$folder/published.bag" /kinloop/pose /kinloop/pose_with_covariance >"$folder/record.log" 2>&1 &
  record_pid=$!
  timeout 200 "$node" _topics:="$color,$depth" _keep_all:=true _idle_s:=8 \
    _camera:="$folder/frames/camera.yaml" _output:="$folder/node" >"$folder/node.log" 2>&1 &
  node_pid=$!
  pids=("$roscore_pid" "$record_pid" "$node_pid")
  wait_for subscribed /kinloop/pose_with_covariance && wait_for subscribed "$depth" &&
    timeout 30 rosbag play -q --wait-for-subscribers -r 0.5 "$folder/frames.bag" --topics "$color" "$depth" \
      >"$folder/play.log" 2>&1 </dev/null
}

start_roscore
color=/kinect2/qhd/image_color_rect depth=/kinect2/qhd/image_depth_rect
# On a busy machine rosbag play of Debian sometimes hangs before it has played anything.
for _ in 1 2 3; do
  play_to_node && break
  echo "rosbag did not play the bag"
  kill "$node_pid" "$record_pid" || true
  wait "$node_pid" "$record_pid" || true
done
wait "$node_pid"
cat "$folder/node.log"
cmp "$folder/files/trajectory.txt" "$folder/node/trajectory.txt"
echo "played to the node: the same"

kill -INT "$record_pid"
wait "$record_pid" || true
for _ in $(seq 100); do [[ -f "$folder/published.bag" ]] && break || sleep 0.1; done  # rosbag ends before its recorder
/usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/check_covariances.py" "$folder/published.bag" "$folder/poses.jsonl"
