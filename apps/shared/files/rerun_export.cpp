#include "apps/shared/files/rerun_export.hpp"

#include <cstdlib>

#include "apps/shared/files/python_files.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/anonymous_temp_file.hpp"
#include "kinloop/core/files/output_file.hpp"

namespace kinloop {
namespace {

constexpr const char* kScript = "_rerun.py";

/// A new folder that is removed with all that is in it.
class PartsFolder {
 public:
  PartsFolder() {
    require_temporary_folder();
    std::string name = (temporary_folder() / "kinloop_rerun_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw InputError(name + ": cannot create this folder");
    path_ = name;
  }
  ~PartsFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PartsFolder(const PartsFolder&) = delete;
  PartsFolder& operator=(const PartsFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

void require_rerun() {
  run_python(python_file(kScript), {});
}

void export_rerun(const std::filesystem::path& file, const RerunRequest& request, const FileCloud& cloud,
                  OpenMap& open, const Progress& progress) {
  const PartsFolder parts;
  write_rerun_parts(parts.path(), request, cloud, open, progress);
  OutputFile out(file);
  run_python(python_file(kScript),
             {parts.path().string(), std::filesystem::absolute(out.temporary()).string()});
  out.commit();
}

}  // namespace kinloop
