#pragma once
// Expectations on the one-line error messages.

#include <string>

#include <gmock/gmock.h>

#include "kinloop/core/errors.hpp"

namespace kinloop::test {

/// Returns the `Error` that `call` throws; fails the test if it throws nothing or something else.
template <class Error, class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), testing::Not(testing::HasSubstr("\n"))) << "more than one line";
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "threw a different exception: " << error.what();
    return {};
  }
  ADD_FAILURE() << "threw nothing";
  return {};
}

/// Returns the message of the InputError that `call` throws.
template <class Call>
std::string input_error(const Call& call) {
  return message_of<InputError>(call);
}

/// Returns the message of the UsageError that `call` throws.
template <class Call>
std::string usage_error(const Call& call) {
  return message_of<UsageError>(call);
}

}  // namespace kinloop::test
