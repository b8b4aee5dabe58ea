#include "apps/shared/files/report_file.hpp"
#include "tests/fuzz/targets/expectations.hpp"
#include "tests/fuzz/targets/targets.hpp"
#include "viewer/saved/saved_run.hpp"

namespace kinloop::fuzz {

/// What `kinloop view` and `kinloop report` read.
void read_run_folder_bytes(std::string_view bytes) {
  with_folder(bytes, [](const auto& folder) {
    accept([&] {
      Scene scene("run");
      show_saved_run(scene, read_saved_run(folder));
    });
    accept([&] { write_report(RunFolder::open_existing(folder)); });
  });
}

}  // namespace kinloop::fuzz
