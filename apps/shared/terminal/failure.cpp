#include "apps/shared/terminal/failure.hpp"

#include <cstdlib>
#include <filesystem>
#include <new>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"

namespace kinloop {
namespace {

template <class Error>
const Error* as(const std::exception& error) {
  return dynamic_cast<const Error*>(&error);
}

bool is_out_of_memory(const std::exception& error) {
  if (as<std::bad_alloc>(error) != nullptr) return true;
  const auto* of_opencv = as<cv::Exception>(error);
  return of_opencv != nullptr && of_opencv->code == cv::Error::StsNoMem;
}

bool is_limit_of_threads(const std::error_code& error) {
  return error == std::errc::resource_unavailable_try_again;  // of the C++ library, for std::thread
}

bool is_limit_of_files(const std::error_code& error) {
  return error == std::errc::too_many_files_open || error == std::errc::too_many_files_open_in_system;
}

std::string describe_system_error(const std::system_error& error) {
  if (is_limit_of_threads(error.code())) {
    return "the system refuses to start another thread; use fewer with --threads 1, or raise the limit "
           "(ulimit -u)";
  }
  if (is_limit_of_files(error.code())) return "too many files are open; raise the limit (ulimit -n)";
  return fmt::format("the system reports: {}", error.what());
}

/// Whether something could not be written or read, or the machine is busy.
std::string_view code_of(const std::error_code& error) {
  if (error == std::errc::no_space_on_device || error == std::errc::read_only_file_system) return "output";
  return is_limit_of_threads(error) || is_limit_of_files(error) ? "limit" : "input";
}

/// The message for a path that the standard library could not use.
std::string describe_path_error(const std::filesystem::filesystem_error& error) {
  try {
    throw_no_access(error.path1(), error.code());
  } catch (const InputError& described) {
    return described.what();
  }
}

}  // namespace

Failure describe_failure(const std::exception& error) {
  if (as<UsageError>(error) != nullptr) return {ExitCode::kWrongUse, error.what(), {}, "usage"};
  if (as<OutputError>(error) != nullptr) return {ExitCode::kBadInput, error.what(), {}, "output"};
  if (const auto* hinted = as<InputErrorWithHint>(error))
    return {ExitCode::kBadInput, error.what(), hinted->hint(), "input"};
  if (as<InputError>(error) != nullptr) return {ExitCode::kBadInput, error.what(), {}, "input"};
  if (is_out_of_memory(error)) {
    return {ExitCode::kBadInput,
            "out of memory; try a larger --set dense.voxel_m, smaller images or a shorter sequence",
            {},
            "memory"};
  }
  if (const auto* of_path = as<std::filesystem::filesystem_error>(error))
    return {ExitCode::kBadInput, describe_path_error(*of_path), {}, code_of(of_path->code())};
  if (const auto* of_system = as<std::system_error>(error))
    return {ExitCode::kBadInput, describe_system_error(*of_system), {}, code_of(of_system->code())};
  return {ExitCode::kInternalError, fmt::format("internal error: {} (please report it)", error.what()), {}};
}

void tell_error_code(std::string_view code) {
  const char* file = std::getenv("KINLOOP_ERRORS");  // NOLINT(concurrency-mt-unsafe): nobody changes it
  if (file == nullptr) return;
  constexpr mode_t kAll = 0666;  // without the bits of umask
  const int descriptor = open(file, O_WRONLY | O_APPEND | O_CREAT | O_NONBLOCK | O_NOCTTY | O_CLOEXEC, kAll);
  if (descriptor < 0) return;
  for (const std::string_view part : {std::string_view("{\"code\": \""), code, std::string_view("\"}\n")})
    static_cast<void>(!write(descriptor, part.data(), part.size()));
  close(descriptor);
}

}  // namespace kinloop
