#pragma once
// A scene, its server and the thread on which both live.

#include <functional>
#include <memory>
#include <string>

#include "viewer/scene/scene.hpp"
#include "viewer/server/access.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

class ViewerService {
 public:
  /// `update` brings the scene up to date, some twenty times a second; `on_command` gets what browsers ask.
  /// Both are called on the thread of the service, and nothing else touches the scene. Throws InputError
  /// where the address cannot be had.
  ViewerService(const ListenAddress& listen, std::function<void(Scene&, size_t browsers)> update,
                std::function<void(Command)> on_command);
  ~ViewerService();
  ViewerService(const ViewerService&) = delete;
  ViewerService& operator=(const ViewerService&) = delete;

  /// Where to look.
  [[nodiscard]] const std::string& url() const;

  /// Browsers that watch now.
  [[nodiscard]] size_t browsers() const;

 private:
  class Impl;  // Boost.Asio stays out of the headers
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinloop
