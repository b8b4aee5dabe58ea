#include "simulator/movers/movers.hpp"

#include "kinloop/core/time.hpp"

namespace kinloop::sim {

MoverPoses Movers::at(int64_t stamp_ns) const {
  const double time_s = to_seconds(stamp_ns - begin_ns);
  MoverPoses poses;
  Parts at_rest;
  const auto add = [&](const Parts& parts, bool moving) {
    Parts& list = moving ? poses.parts : at_rest;
    list.insert(list.end(), parts.begin(), parts.end());
  };
  for (const Person& person : people) add(person_at(person, time_s), true);
  if (door) add(door_at(*door, time_s), is_turning(*door, time_s));
  for (const PushedChair& chair : chairs) add(chair_at(chair, time_s), is_pushed(chair, time_s));
  poses.in_motion = poses.parts.size();
  poses.parts.insert(poses.parts.end(), at_rest.begin(), at_rest.end());
  return poses;
}

}  // namespace kinloop::sim
