#include "simulator/paint/palette.hpp"

#include <optional>

#include "kinloop/core/threads/parallel_for.hpp"
#include "simulator/paint/paint.hpp"

namespace kinloop::sim {
namespace {

struct Painting {
  Kind kind;
  cv::Mat (*paint)(Random&);
};

std::vector<Painting> paintings(Random& random) {
  std::vector<Painting> list;
  const auto add = [&](int count, Kind kind, cv::Mat (*paint)(Random&)) {
    list.insert(list.end(), static_cast<size_t>(count), Painting{kind, paint});
  };
  constexpr cv::Mat (*kFloors[])(Random&) = {paint_planks, paint_carpet, paint_tiles};
  constexpr cv::Mat (*kAccents[])(Random&) = {paint_wallpaper, paint_bricks};
  add(1, Kind::kFloor, kFloors[random.index(3)]);  // largest first, for even load across threads
  add(1, Kind::kAccentWall, kAccents[random.index(2)]);
  add(1, Kind::kRug, paint_rug);
  add(2, Kind::kPlaster, paint_plaster);
  add(4, Kind::kWood, paint_wood);
  add(6, Kind::kFabric, paint_fabric);
  add(12, Kind::kPlain, paint_plain);
  add(4, Kind::kMetal, paint_metal);
  add(3, Kind::kCardboard, paint_cardboard);
  add(2, Kind::kLeaf, paint_leaf);
  add(6, Kind::kPicture, paint_landscape);
  add(6, Kind::kPicture, paint_abstract);
  add(6, Kind::kPicture, paint_poster);
  add(3, Kind::kPicture, paint_map);
  add(1, Kind::kWhiteboard, paint_whiteboard);
  add(1, Kind::kWindowView, paint_window_view);
  add(12, Kind::kPaper, paint_paper);
  add(6, Kind::kScreen, paint_screen);
  add(3, Kind::kKeyboard, paint_keyboard);
  add(20, Kind::kLabel, paint_label);
  add(2, Kind::kSpines, paint_book_spines);
  add(3, Kind::kDrawers, paint_drawers);
  add(1, Kind::kDoor, paint_door);
  add(1, Kind::kClock, paint_clock);
  add(2, Kind::kBall, paint_ball);
  return list;
}

float uniform(Random& random) {
  return static_cast<float>(random.uniform());
}

}  // namespace

Palette::Palette(uint64_t seed, int threads) : versions_(static_cast<size_t>(Kind::kCount)) {
  Random random(seed);
  const std::vector<Painting> list = paintings(random);
  std::vector<std::optional<Texture>> painted(list.size());
  // Interleaved, since neighbours in the list take about the same time.
  const auto workers = static_cast<size_t>(std::max(threads, 1));
  parallel_for(workers, threads, [&](size_t begin, size_t end) {
    for (size_t worker = begin; worker < end; ++worker) {
      for (size_t i = worker; i < list.size(); i += workers) {
        Random own(hash(seed, i));
        painted[i].emplace(list[i].paint(own));
      }
    }
  });
  for (size_t i = 0; i < list.size(); ++i) {
    versions_[static_cast<size_t>(list[i].kind)].push_back(static_cast<int>(i));
    textures_.push_back(std::move(*painted[i]));
  }
}

int Palette::pick(Kind kind, Random& random) const {
  const std::vector<int>& versions = versions_[static_cast<size_t>(kind)];
  return versions[random.index(static_cast<uint32_t>(versions.size()))];
}

FaceTexture Palette::fitted(Kind kind, Random& random) const {
  return {pick(kind, random), true, 0, 0, 1, 1};
}

FaceTexture Palette::metric(Kind kind, double period_m, Random& random) const {
  const auto scale = static_cast<float>(1 / period_m);
  const int texture = pick(kind, random);
  const float u0 = uniform(random), v0 = uniform(random);
  return {texture, false, u0, v0, scale, scale};
}

FaceTexture Palette::cell(Kind kind, int columns, int rows, Random& random) const {
  const float width = 1.0F / static_cast<float>(columns), height = 1.0F / static_cast<float>(rows);
  const int texture = pick(kind, random);
  const auto column = static_cast<float>(random.index(static_cast<uint32_t>(columns)));
  const auto row = static_cast<float>(random.index(static_cast<uint32_t>(rows)));
  return {texture, true, column * width, row * height, width, height};
}

}  // namespace kinloop::sim
