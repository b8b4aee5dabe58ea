#include "tools/export/grid_file.hpp"

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kFirstKey = "image: ";

/// The intensities of map_server.
char grey_of(Occupancy occupancy) {
  constexpr unsigned char kFree = 254, kUnknown = 205, kOccupied = 0;
  switch (occupancy) {
    case Occupancy::kFree:
      return static_cast<char>(kFree);
    case Occupancy::kOccupied:
      return static_cast<char>(kOccupied);
    default:
      return static_cast<char>(kUnknown);
  }
}

/// Throws InputError if the file is there and is not the description of a grid, e.g. camera.yaml.
void require_replaceable(const std::filesystem::path& description, const std::filesystem::path& picture) {
  std::error_code absent;
  if (!std::filesystem::exists(description, absent)) return;
  if (std::filesystem::is_regular_file(description) && read_file(description).starts_with(kFirstKey)) return;
  throw InputError(fmt::format("{}: the description of the grid would replace this file; name {} otherwise",
                               description.string(), picture.filename().string()));
}

}  // namespace

void write_grid(const std::filesystem::path& path, const OccupancyGrid& grid) {
  std::string picture =
      fmt::format("P5\n# kinloop, {} m a cell\n{} {}\n255\n", grid.cell_m, grid.width, grid.height);
  for (int row = grid.height - 1; row >= 0; --row) {  // the picture's first row has the largest y
    for (int col = 0; col < grid.width; ++col) {
      picture += grey_of(
          grid.cells[static_cast<size_t>(row) * static_cast<size_t>(grid.width) + static_cast<size_t>(col)]);
    }
  }
  auto description = path;
  description.replace_extension(".yaml");
  require_replaceable(description, path);
  write_file(path, picture);
  write_file(description, fmt::format("{}{}\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\n"
                                      "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                                      kFirstKey, json_text(path.filename().string()), grid.cell_m,
                                      grid.origin_x_m, grid.origin_y_m));
}

}  // namespace kinloop
