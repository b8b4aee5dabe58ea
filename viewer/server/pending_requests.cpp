#include "viewer/server/pending_requests.hpp"

#include <algorithm>
#include <map>

namespace kinloop {

void PendingRequests::add(const std::shared_ptr<HttpSession>& session,
                          const boost::asio::ip::address& client) {
  std::erase_if(pending_, [](const Pending& pending) { return pending.session.expired(); });
  if (pending_.size() >= kMax) close_one();
  pending_.push_back({session, client});
}

void PendingRequests::close_one() {
  std::map<boost::asio::ip::address, size_t> count;
  for (const Pending& pending : pending_) ++count[pending.client];
  const auto most = std::max_element(count.begin(), count.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const auto oldest = std::find_if(pending_.begin(), pending_.end(),
                                   [&](const Pending& pending) { return pending.client == most->first; });
  if (const auto session = oldest->session.lock()) session->close();
  pending_.erase(oldest);
}

}  // namespace kinloop
