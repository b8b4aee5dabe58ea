#pragma once
// The connections that wait for their request to be read or answered. Silent and slow ones give way to new
// ones, so that they cannot lock anybody out.

#include <memory>
#include <vector>

#include <boost/asio/ip/address.hpp>

#include "viewer/server/http_session.hpp"

namespace kinloop {

class PendingRequests {
 public:
  static constexpr size_t kMax = 32;

  /// If there are already kMax, the oldest of the address that has the most is closed.
  void add(const std::shared_ptr<HttpSession>& session, const boost::asio::ip::address& client);

 private:
  struct Pending {
    std::weak_ptr<HttpSession> session;
    boost::asio::ip::address client;
  };

  void close_one();

  std::vector<Pending> pending_;  ///< the oldest first
};

}  // namespace kinloop
