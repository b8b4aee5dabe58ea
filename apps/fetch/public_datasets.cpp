#include "apps/fetch/public_datasets.hpp"

#include <regex>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

namespace {

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
});

constexpr auto kRequested = std::to_array<RequestedDataset>({
    {"scannet/", "ScanNet",
     "sign its terms of use (https://github.com/ScanNet/ScanNet), run the script download-scannet.py that "
     "you receive with --type .sens, and give the .sens file to kinloop run"},
    {"openloris/", "OpenLORIS-Scene",
     "ask for access at https://lifelong-robotic-vision.github.io/dataset/scene, unpack the sequence, and "
     "give its folder to kinloop run"},
});

}  // namespace

std::span<const PublicDataset> public_datasets() {
  return kPublic;
}

std::span<const RequestedDataset> requested_datasets() {
  return kRequested;
}

FetchPlan plan_fetch(const std::string& name) {
  for (const RequestedDataset& dataset : requested_datasets()) {
    if (!name.starts_with(dataset.prefix)) continue;
    throw UsageError(
        fmt::format("fetch: {} is given only to those who ask for it: {}", dataset.title, dataset.remedy));
  }
  for (const PublicDataset& dataset : public_datasets()) {
    std::smatch match;
    if (!std::regex_match(name, match, std::regex(std::string(dataset.pattern)))) continue;
    const auto filled = [&](std::string_view text) { return match.format(std::string(text)); };
    FetchPlan plan{.server = std::string(dataset.server),
                   .archives = {},
                   .inside = filled(dataset.inside),
                   .folder = filled(dataset.folder),
                   .sequence = filled(dataset.sequence),
                   .evidence = std::string(dataset.evidence),
                   .licence = fmt::format("{}: {}", dataset.title, dataset.licence)};
    for (const std::string_view archive : dataset.archives) {
      if (!archive.empty()) plan.archives.push_back(filled(archive));
    }
    return plan;
  }
  throw UsageError(
      fmt::format("fetch: '{}' is not a known sequence; expected e.g. tum/fr1_room, eth3d/cables_1, "
                  "icl/living_room_traj0, 7scenes/redkitchen/seq-01, bonn/balloon or replica/room0 "
                  "(all datasets: kinloop fetch --list)",
                  name));
}

}  // namespace kinloop
