#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "drivers/bags/bag_files.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

constexpr const char* kMetadata = "metadata.yaml";
constexpr const char* kBagNode = "rosbag2_bagfile_information";

bool is_ros2_file(const std::filesystem::path& file) {
  return file.extension() == ".mcap" || file.extension() == ".db3";
}

std::vector<std::filesystem::path> files_by_name(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (is_ros2_file(entry.path())) files.push_back(entry.path());
  }
  // "_2" comes before "_10": a longer name has a larger number.
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) {
    const auto x = a.string(), y = b.string();
    return x.size() != y.size() ? x.size() < y.size() : x < y;
  });
  return files;
}

/// The file that metadata.yaml names. Older versions name the folder, too. Throws InputError if it leaves the
/// folder or is compressed as a whole.
std::filesystem::path listed_file(const std::filesystem::path& folder, const std::string& name) {
  const auto metadata = (folder / kMetadata).string();
  if (name.ends_with(".zstd"))
    throw InputError(
        fmt::format("{}: compressed as a whole; decompress it with `zstd -d` and remove .zstd from {}",
                    (folder / name).string(), metadata));
  const std::filesystem::path file(name);
  const bool leaves =
      file.is_absolute() || std::any_of(file.begin(), file.end(), [](const auto& p) { return p == ".."; });
  if (leaves) throw InputError(fmt::format("{}: '{}' is outside of the folder", metadata, name));
  if (!std::filesystem::exists(folder / file) && std::filesystem::exists(folder / file.filename()))
    return folder / file.filename();
  return folder / file;
}

std::vector<std::filesystem::path> listed_files(const std::filesystem::path& folder) {
  const auto path = folder / kMetadata;
  std::vector<std::filesystem::path> files;
  constexpr uint64_t kMostBytes = uint64_t{16} << 20;
  require_size(path, kMostBytes);
  try {
    const YAML::Node bag = YAML::Load(read_file(path))[kBagNode];
    for (const auto& name : bag["relative_file_paths"])
      files.push_back(listed_file(folder, printable(name.as<std::string>())));
  } catch (const YAML::Exception&) {
    throw InputError(fmt::format("{}: not the metadata of a ROS 2 bag; remove it to read the files by name",
                                 path.string()));
  }
  return files;
}

/// Several files, one after the other. A topic has one entry, with the messages of all.
class FileSequence : public MessageFile {
 public:
  explicit FileSequence(std::vector<std::unique_ptr<MessageFile>> files) : files_(std::move(files)) {
    for (const auto& file : files_) {
      for (const BagTopic* topic : file->topics()) {
        const auto [known, is_new] = topics_.emplace(topic->name, *topic);
        if (!is_new) known->second.messages += topic->messages;
      }
    }
  }

  [[nodiscard]] std::vector<const BagTopic*> topics() const override {
    std::vector<const BagTopic*> all;
    for (const auto& [name, topic] : topics_) all.push_back(&topic);
    return all;
  }

  void select(const std::set<std::string>& topics) override {
    for (const auto& file : files_) file->select(topics);
    current_ = 0;
  }

  std::optional<BagMessage> next() override {
    for (; current_ < files_.size(); ++current_) {
      if (const auto message = files_[current_]->next()) return message;
    }
    return std::nullopt;
  }

  [[nodiscard]] SkippedFrames damage() const override {
    SkippedFrames all;
    for (const auto& file : files_) {
      const auto damage = file->damage();
      all.add(damage);
    }
    return all;
  }

 private:
  std::vector<std::unique_ptr<MessageFile>> files_;
  std::map<std::string, BagTopic> topics_;
  size_t current_ = 0;
};

}  // namespace

bool is_ros2_bag_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) return false;
  if (!files_by_name(folder).empty()) return true;
  if (!std::filesystem::exists(folder / kMetadata, ignored)) return false;
  try {
    return read_file(folder / kMetadata).find(kBagNode) != std::string::npos;
  } catch (const InputError&) {
    return false;
  }
}

std::unique_ptr<MessageFile> open_ros2_folder(const std::filesystem::path& folder) {
  const auto paths =
      std::filesystem::exists(folder / kMetadata) ? listed_files(folder) : files_by_name(folder);
  std::vector<std::unique_ptr<MessageFile>> files;
  for (const auto& file : paths) {
    if (!is_ros2_file(file))
      throw InputError(fmt::format("{}: unknown kind of bag; expected .mcap or .db3", file.string()));
    files.push_back(file.extension() == ".mcap" ? open_mcap(file) : open_sqlite_bag(file));
  }
  if (files.empty()) throw InputError(fmt::format("{}: names no bag file", (folder / kMetadata).string()));
  if (files.size() == 1) return std::move(files.front());
  return std::make_unique<FileSequence>(std::move(files));
}

}  // namespace kinloop
