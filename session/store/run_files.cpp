#include "session/store/run_files.hpp"

#include <system_error>

#include "dense/files/ply.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"

namespace kinloop {

void write_run_files(const RunFolder& folder, const RunFiles& files) {
  write_tum_trajectory(folder.trajectory(), files.trajectory, files.note);
  write_covariances(folder.covariances(), files.trajectory, files.covariances);
  write_tum_trajectory(folder.keyframes(), files.keyframes);
  if (files.ground_truth.empty()) {
    std::error_code ignored;
    if (std::filesystem::exists(folder.run_json(), ignored)) {  // otherwise it is not from an earlier run
      std::filesystem::remove(folder.ground_truth(), ignored);
    }
  } else {
    write_tum_trajectory(folder.ground_truth(), files.ground_truth);
  }
  write_ply(folder.map(), files.map, files.frame);
  if (files.metrics.is_null()) return;
  write_file(folder.run_json(), json_text(files.metrics, 2) + "\n");
}

}  // namespace kinloop
