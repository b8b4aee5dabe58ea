#pragma once
// The connection to a client. It is read slowly, so that a flood of any kind (requests, pings, empty
// fragments, of which Beast takes any number) costs next to nothing and backs up in the client.

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/basic_stream.hpp>
#include <boost/beast/core/rate_policy.hpp>

namespace kinloop {

using ClientStream = boost::beast::basic_stream<boost::asio::ip::tcp, boost::asio::any_io_executor,
                                                boost::beast::simple_rate_policy>;

/// Bytes that are read per second from a client. A page sends less than 1 KiB/s, the longest request has 8
/// KiB.
constexpr size_t kMaxReadBytesPerS = 1 << 14;

}  // namespace kinloop
