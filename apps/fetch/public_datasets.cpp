#include "apps/fetch/public_datasets.hpp"

#include <regex>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

namespace {

constexpr std::string_view kOpenLoris = "OpenLORIS-Scene";
constexpr std::string_view kOpenLorisServer =
    "https://huggingface.co/datasets/shixuesong/openloris-scene/resolve/main";
constexpr std::string_view kOpenLorisEvidence = "color.txt";
constexpr std::string_view kOpenLorisLicence =
    "Creative Commons Attribution-NoDerivatives 4.0 (CC BY-ND 4.0); cite Shi et al., Are We Ready for "
    "Service Robots? The OpenLORIS-Scene Datasets for Lifelong SLAM, ICRA 2020";

/// A scene of OpenLORIS: an archive of archives, one a sequence.
constexpr PublicDataset part_of_open_loris(std::string_view pattern, std::string_view archive,
                                           std::string_view folder, std::string_view examples = "") {
  return {.title = kOpenLoris,
          .examples = examples,
          .pattern = pattern,
          .server = kOpenLorisServer,
          .archives = {archive},
          .inside = "",
          .folder = folder,
          .sequence = "$1",
          .evidence = kOpenLorisEvidence,
          .licence = kOpenLorisLicence};
}

constexpr auto kPublic = std::to_array<PublicDataset>({
    {.title = "TUM RGB-D",
     .examples = "tum/fr1_room, tum/fr2_desk, tum/fr3_long_office_household",
     .pattern = "tum/fr([123])_([a-z0-9_]+)",
     .server = "https://cvg.cit.tum.de/rgbd/dataset",
     .archives = {"freiburg$1/rgbd_dataset_freiburg$1_$2.tgz"},
     .inside = "rgbd_dataset_freiburg$1_$2",
     .folder = "rgbd_dataset_freiburg$1_$2",
     .sequence = "",
     .evidence = "rgb.txt",
     .licence = "Creative Commons Attribution 4.0 (CC BY 4.0); cite Sturm et al., A Benchmark for the "
                "Evaluation of RGB-D SLAM Systems, IROS 2012"},
    {.title = "ETH3D SLAM",
     .examples = "eth3d/cables_1, eth3d/sfm_bench",
     .pattern = "eth3d/([a-z0-9_]+)",
     .server = "https://www.eth3d.net/data/slam/datasets",
     .archives = {"$1_mono.zip", "$1_rgbd.zip"},
     .inside = "$1",
     .folder = "$1",
     .sequence = "",
     .evidence = "depth.txt",
     .licence = "CC BY-NC-SA 4.0, not for commercial use; cite Schoeps et al., BAD SLAM: Bundle Adjusted "
                "Direct RGB-D SLAM, CVPR 2019"},
    {.title = "ICL-NUIM living room",
     .examples = "icl/living_room_traj0, ..., 3; with noise icl/living_room_traj0n, ..., 3n",
     .pattern = "icl/living_room_traj([0-3]n?)(?:_frei_png)?",
     .server = "https://www.doc.ic.ac.uk/~ahanda",
     .archives = {"living_room_traj$1_frei_png.tar.gz"},
     .inside = "",
     .folder = "living_room_traj$1_frei_png",
     .sequence = "",
     .evidence = "associations.txt",
     .licence = "CC BY 3.0; cite Handa et al., A Benchmark for RGB-D Visual Odometry, 3D Reconstruction "
                "and SLAM, ICRA 2014"},
    {.title = "ICL-NUIM office",
     .examples = "icl/office_traj0, ..., 3; with noise icl/office_traj0n, ..., 3n",
     .pattern = "icl/(?:office_)?traj([0-3]n?)(?:_frei_png)?",
     .server = "https://www.doc.ic.ac.uk/~ahanda",
     .archives = {"traj$1_frei_png.tar.gz"},
     .inside = "",
     .folder = "office_traj$1_frei_png",
     .sequence = "",
     .evidence = "associations.txt",
     .licence = "CC BY 3.0; cite Handa et al., A Benchmark for RGB-D Visual Odometry, 3D Reconstruction "
                "and SLAM, ICRA 2014"},
    {.title = "7-Scenes",
     .examples = "7scenes/redkitchen/seq-01; all sequences of a scene come in one archive",
     .pattern = "7scenes/(chess|fire|heads|office|pumpkin|redkitchen|stairs)/(seq-[0-9]{2})",
     .server = "https://download.microsoft.com/download/2/8/5/28564B23-0828-408F-8631-23B1EFF1DAC8",
     .archives = {"$1.zip"},
     .inside = "$1",
     .folder = "7scenes/$1",
     .sequence = "$2",
     .evidence = "frame-000000.pose.txt",
     .licence = "Microsoft Research licence, not for commercial use; cite Shotton et al., Scene Coordinate "
                "Regression Forests for Camera Relocalization in RGB-D Images, CVPR 2013"},
    {.title = "Bonn RGB-D Dynamic",
     .examples = "bonn/balloon, bonn/person_tracking2, bonn/static",
     .pattern = "bonn/([a-z0-9_]+)",
     .server = "https://www.ipb.uni-bonn.de/html/projects/rgbd_dynamic2019",
     .archives = {"rgbd_bonn_$1.zip"},
     .inside = "rgbd_bonn_$1",
     .folder = "rgbd_bonn_$1",
     .sequence = "",
     .evidence = "rgb.txt",
     .licence = "none stated; for research; cite Palazzolo et al., ReFusion: 3D Reconstruction in Dynamic "
                "Environments for RGB-D Cameras Exploiting Residuals, IROS 2019"},
    {.title = "Replica, as rendered for iMAP and NICE-SLAM",
     .examples = "replica/room0, ..., 2, replica/office0, ..., 4; all come in one archive of 12 GB",
     .pattern = "replica/(room[0-2]|office[0-4])",
     .server = "https://cvg-data.inf.ethz.ch/nice-slam/data",
     .archives = {"Replica.zip"},
     .inside = "Replica",
     .folder = "Replica",
     .sequence = "$1",
     .evidence = "traj.txt",
     .licence = "Replica Dataset Research Terms, not for commercial use; cite Straub et al., The Replica "
                "Dataset, 2019, and Sucar et al., iMAP, ICCV 2021"},
    part_of_open_loris("openloris/(cafe1-[12])", "package/cafe1-1_2-package.tar", "openloris/cafe1",
                       "openloris/cafe1-1, corridor1-5, home1-5, market1-3, office1-7; all sequences of a "
                       "scene come in one archive of up to 33 GB"),
    part_of_open_loris("openloris/(corridor1-[2-5])", "package/corridor1-2_5-package.tar",
                       "openloris/corridor1"),
    part_of_open_loris("openloris/(home1-[1-5])", "package/home1-1_5-package.tar", "openloris/home1"),
    part_of_open_loris("openloris/(market1-[1-3])", "package/market1-1_3-package.tar", "openloris/market1"),
    part_of_open_loris("openloris/(office1-[1-7])", "package/office1-1_7-package.tar", "openloris/office1"),
    {.title = kOpenLoris,
     .examples = "",
     .pattern = "openloris/(corridor1-1)",
     .server = kOpenLorisServer,
     .archives = {"package/corridor1-1.7z"},
     .inside = "corridor1-1",
     .folder = "openloris/corridor1-1",
     .sequence = "",
     .evidence = kOpenLorisEvidence,
     .licence = kOpenLorisLicence},
    {.title = "ScanNet",
     .examples = "scannet/scene0000_00, ..., scene0706_00",
     .pattern = "scannet/(scene[0-9]{4}_[0-9]{2})",
     .server = "",
     .archives = {"v2/scans/$1/$1.sens"},
     .inside = "",
     .folder = "scannet/$1",
     .sequence = "",
     .evidence = "$1.sens",
     .licence = "ScanNet Terms of Use, not for commercial use; cite Dai et al., ScanNet: Richly-annotated 3D "
                "Reconstructions of Indoor Scenes, CVPR 2017",
     .access = "sign its terms of use (https://github.com/ScanNet/ScanNet); you receive a script, "
               "download-scannet.py, whose BASE_URL is the address of the server",
     .server_variable = "KINLOOP_SCANNET_SERVER"},
});

}  // namespace

std::span<const PublicDataset> public_datasets() {
  return kPublic;
}

FetchPlan plan_fetch(const std::string& name) {
  for (const PublicDataset& dataset : public_datasets()) {
    std::smatch match;
    if (!std::regex_match(name, match, std::regex(std::string(dataset.pattern)))) continue;
    const auto filled = [&](std::string_view text) { return match.format(std::string(text)); };
    FetchPlan plan{.server = std::string(dataset.server),
                   .archives = {},
                   .inside = filled(dataset.inside),
                   .folder = filled(dataset.folder),
                   .sequence = filled(dataset.sequence),
                   .evidence = filled(dataset.evidence),
                   .licence = fmt::format("{}: {}", dataset.title, dataset.licence),
                   .access = std::string(dataset.access),
                   .server_variable = std::string(dataset.server_variable)};
    for (const std::string_view archive : dataset.archives) {
      if (!archive.empty()) plan.archives.push_back(filled(archive));
    }
    return plan;
  }
  throw UsageError(
      fmt::format("fetch: '{}' is not a known sequence; expected e.g. tum/fr1_room, eth3d/cables_1, "
                  "icl/living_room_traj0, 7scenes/redkitchen/seq-01, bonn/balloon, replica/room0, "
                  "openloris/cafe1-1 or scannet/scene0000_00 "
                  "(all datasets: kinloop fetch --list)",
                  name));
}

}  // namespace kinloop
