#include "simulator/movers/movers.hpp"

namespace kinloop::sim {
namespace {

constexpr float kPersonRadius_m = 0.27F;

Person make_person(const FreeFloor& floor, const FloorTrack& track, const std::vector<Person>& others,
                   Wardrobe& wardrobe, Random& random) {
  std::vector<Walk> walks;
  for (const Person& other : others) walks.push_back(other.walk);
  Person person;
  person.figure.height_m = static_cast<float>(random.uniform(1.58, 1.88));
  person.figure.girth = static_cast<float>(random.uniform(0.88, 1.15));
  person.outfit = wardrobe.outfit(random);
  person.walk = plan_walk(floor, track, walks, random);
  return person;
}

}  // namespace

Movers populate(Parts& room, const MoverSite& site, const MoverOptions& options, Wardrobe& wardrobe,
                uint64_t seed) {
  const FloorTrack track = floor_track(*site.camera);
  // Streams of their own, so that a person stays the same when a door is added.
  Random door_random(hash(seed, 1)), chair_random(hash(seed, 2));
  Movers movers;
  movers.begin_ns = site.camera->poses().front().stamp_ns;
  FreeFloor chair_floor(room, site.size_m, kChairRadius_m);
  FreeFloor person_floor(room, site.size_m, kPersonRadius_m);
  if (options.door) {
    FurnitureBuilder builder(*site.palette, door_random);
    movers.door = open_doorway(room, site.door, builder, track);
  }
  FurnitureBuilder builder(*site.palette, chair_random);
  for (int i = 0; i < options.chairs; ++i) {
    movers.chairs.push_back(place_chair(chair_floor, track, builder));
    const PushedChair& chair = movers.chairs.back();
    for (const ChairPlace& place : {chair.before, chair.after}) {
      person_floor.block({place.position.array() - kChairRadius_m, place.position.array() + kChairRadius_m});
    }
  }
  for (int i = 0; i < options.people; ++i) {
    Random random(hash(seed, 100 + static_cast<uint64_t>(i)));
    movers.people.push_back(make_person(person_floor, track, movers.people, wardrobe, random));
  }
  return movers;
}

}  // namespace kinloop::sim
