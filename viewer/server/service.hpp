#pragma once
// A scene, its server and the thread that runs both.

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "viewer/scene/scene.hpp"
#include "viewer/server/access.hpp"
#include "viewer/server/command.hpp"

namespace kinloop {

class ViewerService {
 public:
  /// `update` updates the scene, about twenty times a second; `on_command` receives commands from browsers.
  /// Both are called on the service's thread, which alone accesses the scene. Throws InputError if the
  /// address is not available.
  ViewerService(const ListenAddress& listen, std::function<void(Scene&, size_t browsers)> update,
                std::function<void(const Command&)> on_command);
  ~ViewerService();
  ViewerService(const ViewerService&) = delete;
  ViewerService& operator=(const ViewerService&) = delete;

  /// URL of the page.
  [[nodiscard]] const std::string& url() const;

  /// Number of connected browsers.
  [[nodiscard]] size_t browsers() const;

  /// Waits until the scene has been updated and every browser has been sent what it held then, as far as the
  /// operating system tells; returns whether that is so within `timeout`. Without browsers, returns at once.
  bool wait_until_sent(std::chrono::milliseconds timeout) const;

 private:
  class Impl;  // keeps Boost.Asio out of the headers
  std::unique_ptr<Impl> impl_;
};

}  // namespace kinloop
