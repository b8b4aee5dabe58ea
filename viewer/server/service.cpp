#include "viewer/server/service.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "kinloop/core/log.hpp"
#include "kinloop/core/threads/thread_priority.hpp"
#include "viewer/server/server.hpp"

namespace kinloop {
namespace {

constexpr std::chrono::milliseconds kBetweenUpdates{50};

}  // namespace

class ViewerService::Impl {
 public:
  Impl(const ListenAddress& listen, std::function<void(Scene&, size_t)> update,
       std::function<void(const Command&)> on_command)
      : scene_(random_token()),
        update_(std::move(update)),
        timer_(context_),
        server_(context_, listen, scene_, std::move(on_command)),
        url_(server_.url()),
        thread_([this] { run(); }) {}

  ~Impl() {
    context_.stop();
    thread_.join();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] const std::string& url() const { return url_; }
  [[nodiscard]] size_t browsers() const { return browsers_; }

  bool wait_until_sent(std::chrono::milliseconds timeout) const {
    const auto until = std::chrono::steady_clock::now() + timeout;
    const auto wait_for = [&](const auto& condition) {
      while (browsers_ > 0 && !stopped_ && std::chrono::steady_clock::now() < until && !condition())
        std::this_thread::sleep_for(kBetweenUpdates);
      return browsers_ == 0 || condition();
    };
    const size_t updates = updates_ + 1;  // one may be in progress
    if (!wait_for([&] { return updates_ > updates; })) return false;
    const uint64_t version = newest_version_;
    return wait_for([&] { return sent_version_ >= version; });
  }

 private:
  /// A failing viewer must not end the run.
  void run() {
    lower_thread_priority(ThreadPriority::kLow);  // the viewer must not slow the run
    try {
      tick();
      context_.run();
    } catch (const std::exception& error) {
      stopped_ = true;
      log::error("viewer stopped: {}; the run continues", error.what());
    }
  }

  /// Leaves at least half of the thread's time for sending, also on a machine with little time for it.
  void tick() {
    const auto began = std::chrono::steady_clock::now();
    browsers_ = server_.browsers();
    update_(scene_, browsers_);
    server_.send_changes();
    newest_version_ = scene_.newest();
    sent_version_ = server_.sent_version();
    ++updates_;
    const auto busy = std::chrono::steady_clock::now() - began;
    timer_.expires_after(std::max<std::chrono::steady_clock::duration>(kBetweenUpdates, busy));
    timer_.async_wait([this](boost::system::error_code error) {
      if (!error) tick();
    });
  }

  Scene scene_;
  std::function<void(Scene&, size_t)> update_;
  boost::asio::io_context context_{1};
  boost::asio::steady_timer timer_;
  ViewerServer server_;
  std::string url_;
  std::atomic<size_t> browsers_ = 0, updates_ = 0;
  std::atomic<uint64_t> newest_version_ = 0, sent_version_ = 0;  // after the last update
  std::atomic<bool> stopped_ = false;
  std::thread thread_;  // declared last: it uses all the others
};

ViewerService::ViewerService(const ListenAddress& listen, std::function<void(Scene&, size_t)> update,
                             std::function<void(const Command&)> on_command)
    : impl_(std::make_unique<Impl>(listen, std::move(update), std::move(on_command))) {}

ViewerService::~ViewerService() = default;

const std::string& ViewerService::url() const {
  return impl_->url();
}

size_t ViewerService::browsers() const {
  return impl_->browsers();
}

bool ViewerService::wait_until_sent(std::chrono::milliseconds timeout) const {
  return impl_->wait_until_sent(timeout);
}

}  // namespace kinloop
