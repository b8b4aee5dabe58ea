// The messages of kinloop run for a wrong argument, camera or ground truth.

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "drivers/image_files/image_file.hpp"
#include "tests/apps/program_test.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using test::kTrackingLost;
using test::kWrongUse;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RunCommand : public test::ProgramTest {
 protected:
  /// A sequence of a few small frames.
  [[nodiscard]] std::string sequence(int frames = 4) const {
    test::write_room(at("seq"), "--frames " + std::to_string(frames));
    return at("seq");
  }

  /// Its camera, with another depth scale.
  [[nodiscard]] std::string camera_with_scale(const std::string& scale) const {
    std::string camera = read_file(at("seq/camera.yaml"));
    const std::string right = "depth_scale: 5000";
    folder_.write("camera.yaml", camera.replace(camera.find(right), right.size(), "depth_scale: " + scale));
    return at("camera.yaml");
  }
};

TEST_F(RunCommand, UnknownCommandsAreNamedWithTheNearest) {
  const Run far = run("frobnicate");
  EXPECT_EQ(far.exit_code, kWrongUse);
  EXPECT_THAT(far.err, AllOf(HasSubstr("'frobnicate'"), Not(HasSubstr("did you mean"))));
  EXPECT_THAT(run("simulte room").err, HasSubstr("did you mean 'simulate'?"));
  EXPECT_THAT(run("map inof x").err, HasSubstr("map: unknown command 'inof'; did you mean 'info'?"));
}

TEST_F(RunCommand, EachSetTakesOneAssignment) {
  EXPECT_THAT(run("run --help").out, HasSubstr("--set KEY=VALUE "));
  const Run two = run("run sim:room --set sim.frames=2 sim.fps=5");
  EXPECT_EQ(two.exit_code, kWrongUse);
  EXPECT_THAT(two.err, HasSubstr("sim.fps=5"));
}

/// The keys that a list of options shows.
std::set<std::string> keys_of(const std::string& list) {
  std::set<std::string> keys;
  std::istringstream lines(list);
  for (std::string line; std::getline(lines, line);) {
    const size_t equals = line.find('=');
    if (line.starts_with("  ") && line[2] != ' ' && equals != std::string::npos)
      keys.insert(line.substr(2, equals - 2));
  }
  return keys;
}

TEST_F(RunCommand, OptionsListsFewKeysAndAllOnRequest) {
  const Run documented = run("run --options"), all = run("run --options=all");
  EXPECT_EQ(documented.exit_code, kDone);
  EXPECT_EQ(all.exit_code, kDone);
  const auto few = keys_of(documented.out), many = keys_of(all.out);
  EXPECT_THAT(few, AllOf(testing::SizeIs(testing::Le(60U)), testing::Contains("dense.voxel_m")));
  EXPECT_THAT(few, Not(testing::Contains("tracking.pose.rounds")));
  EXPECT_THAT(many, testing::Contains("tracking.pose.rounds"));
  EXPECT_TRUE(std::includes(many.begin(), many.end(), few.begin(), few.end()));
  EXPECT_THAT(documented.out, HasSubstr("--options=all"));
  EXPECT_THAT(run("run --help").out, HasSubstr("--options=all"));
  EXPECT_EQ(run("run --options=everything").exit_code, kWrongUse);
}

TEST_F(RunCommand, ExpertOptionsCanBeSet) {
  const Run done = run("run '" + sequence() + "' -q --set tracking.pose.rounds=3 -o '" + at("out") + "'");
  EXPECT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(read_file(at("out/run.json")), HasSubstr("\"tracking.pose.rounds\": 3"));
  EXPECT_EQ(run("run seq --set tracking.pose.rounds=0").exit_code, kWrongUse);
}

TEST_F(RunCommand, EndsWithAVerdict) {
  const std::string folder = sequence();
  for (const char* option : {"", " --keep-doubtful"}) {
    const Run done = run("run '" + folder + "'" + option + " -o '" + at("out") + "'");
    EXPECT_EQ(done.exit_code, kDone) << done.err;
    EXPECT_THAT(done.out, testing::EndsWith("\nquality: good\n"));
    const auto summary = nlohmann::json::parse(read_file(at("out/run.json")));
    EXPECT_EQ(summary["quality"]["verdict"], "good");
    EXPECT_EQ(summary["quality"]["seconds_doubtful"], 0);
    EXPECT_EQ(summary["quality"]["reasons"], nlohmann::json::array());
    EXPECT_EQ(summary["doubtful"], 0);
    EXPECT_THAT(read_file(at("out/frames.txt")),
                HasSubstr(" ms sigma_m cause expected contradicted moved\n"));
    EXPECT_THAT(read_file(at("out/trajectory.txt")), Not(HasSubstr("#")));
  }
}

TEST_F(RunCommand, AMaskLeavesItsPixelsOutOfTheMap) {
  const std::string folder = sequence();
  cv::Mat mask = cv::Mat::zeros(120, 160, CV_8UC1);
  mask(cv::Rect(0, 0, 80, 120)) = 255;
  write_png(at("half.png"), mask);
  ASSERT_EQ(run("run '" + folder + "' -q -o '" + at("all") + "'").exit_code, kDone);
  const Run masked = run("run '" + folder + "' -q --mask '" + at("half.png") + "' -o '" + at("out") + "'");
  EXPECT_EQ(masked.exit_code, kDone) << masked.err;
  const auto points = [&](const char* out) {
    return nlohmann::json::parse(read_file(at(std::string(out) + "/run.json")))["map"]["points"].get<int>();
  };
  EXPECT_LT(points("out"), 0.7 * points("all"));
  EXPECT_GT(points("out"), 0.3 * points("all"));
  const Run missing = run("run '" + folder + "' -q --mask no.png -o '" + at("out") + "'");
  EXPECT_EQ(missing.exit_code, kBadInput);
  EXPECT_THAT(missing.err, HasSubstr("no.png"));
}

TEST_F(RunCommand, MasksOfAllFramesActAsOneMask) {
  const std::string folder = sequence();
  cv::Mat mask = cv::Mat::zeros(120, 160, CV_8UC1);
  mask(cv::Rect(0, 0, 80, 120)) = 255;
  write_png(at("half.png"), mask);
  ASSERT_EQ(run("run '" + folder + "' -q --mask '" + at("half.png") + "' -o '" + at("one") + "'").exit_code,
            kDone);
  std::filesystem::create_directories(at("seq/masks"));
  for (const auto& image : std::filesystem::directory_iterator(at("seq/rgb")))
    write_png(at("seq/masks/") + image.path().filename().string(), mask);
  const Run masked = run("run '" + folder + "' -o '" + at("each") + "'");
  EXPECT_EQ(masked.exit_code, kDone) << masked.err;
  EXPECT_THAT(masked.err, HasSubstr("masks of 4"));
  for (const char* file : {"/trajectory.txt", "/map.ply"})
    EXPECT_TRUE(read_file(at("each") + file) == read_file(at("one") + file)) << file;
  for (const auto& image : std::filesystem::directory_iterator(at("seq/masks")))
    write_png(image.path(), mask.rowRange(0, 60));
  const Run wrong = run("run '" + folder + "' -q -o '" + at("out") + "'");
  EXPECT_EQ(wrong.exit_code, kBadInput);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("/masks/"), HasSubstr("160 x 60")));
}

TEST_F(RunCommand, UnknownOptionsAreErrors) {
  const Run wrong = run("run sim:room --set global_ba.no_such_thing=1");
  EXPECT_EQ(wrong.exit_code, kWrongUse);
  EXPECT_THAT(wrong.err, HasSubstr("unknown option 'global_ba.no_such_thing'"));
}

TEST_F(RunCommand, WrongDepthScaleIsRejectedWithASuggestion) {
  const std::string folder = sequence(12);
  for (const char* scale : {"1000", "50000"}) {
    const Run done =
        run("run '" + folder + "' -q --camera '" + camera_with_scale(scale) + "' -o '" + at("out") + "'");
    EXPECT_EQ(done.exit_code, kBadInput) << done.err;
    const bool far = std::string(scale) == "1000";
    EXPECT_THAT(done.err,
                AllOf(HasSubstr(far ? "of the depth lies beyond 4 m" : "of the depth lies nearer than 0.4 m"),
                      HasSubstr("depth_scale: 5000 instead of " + std::string(scale)),
                      HasSubstr("camera.yaml"), HasSubstr(far ? "dense.max_depth_m" : "dense.min_depth_m")));
    EXPECT_THAT(done.err, HasSubstr("in the first 10 frames"));
  }
}

TEST_F(RunCommand, ImplausibleDepthEndsTheRun) {
  const std::string folder = sequence(40);
  const Run done =
      run("run '" + folder + "' --camera '" + camera_with_scale("1") + "' -o '" + at("out") + "'");
  EXPECT_EQ(done.exit_code, kBadInput);
  EXPECT_THAT(done.err, HasSubstr("depth is outside the range of any RGB-D camera"));
  EXPECT_FALSE(std::filesystem::exists(at("out/trajectory.txt")));
}

TEST_F(RunCommand, DistantSceneIsAccepted) {
  // As when the camera looks down a hall: nearly everything is out of the map's range; the rest makes the
  // map.
  const std::string far = "run '" + sequence(12) + "' -q -o '" + at("out") + "' --set dense.max_depth_m=";
  const Run done = run(far + "1.5");
  EXPECT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(done.err, Not(HasSubstr("instead of")));
}

TEST_F(RunCommand, OneFrameGivesItsSurface) {
  const Run done = run("run '" + sequence(1) + "' -o '" + at("out") + "'");
  EXPECT_EQ(done.exit_code, kDone);
  EXPECT_THAT(done.out, AllOf(HasSubstr("1 tracked of 1"), Not(HasSubstr("map        0 points"))));
  EXPECT_THAT(done.err, Not(HasSubstr("depth_scale")));
}

/// CPU time of all programs run so far, as the system counts it.
double programs_cpu_s() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// The CPU times in a table of --profile, from top to bottom, without the last row, the sum.
std::vector<double> profiled_cpu_s(const std::string& text) {
  std::vector<double> cpu_s;
  std::istringstream lines(text.substr(text.find("module ")));
  std::string line;
  std::getline(lines, line);  // names of the columns
  while (std::getline(lines, line) && !line.starts_with("sum ")) cpu_s.push_back(std::stod(line.substr(26)));
  return cpu_s;
}

TEST_F(RunCommand, TimingsCoverTheCpuTimeOfTheProcess) {
  const std::string folder = sequence(30);
  const double before_s = programs_cpu_s();
  const Run done = run("run '" + folder + "' --profile -o '" + at("out") + "'");
  const double process_s = programs_cpu_s() - before_s;
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("module"), HasSubstr("decoding"), HasSubstr("CPU s of the process")));
  const auto summary = nlohmann::json::parse(read_file(at("out/run.json")));
  double sum_s = 0;
  for (const auto& module : summary["timings"]) {
    const double cpu_s = module["cpu_s"], p95_ms = module["cpu_p95_ms"];
    EXPECT_LE(p95_ms, 1000.01 * cpu_s) << "of one of its calls";
    sum_s += cpu_s;
  }
  EXPECT_GT(summary["timings"]["tracking"]["cpu_p95_ms"].get<double>(), 0);
  EXPECT_GT(sum_s, 0.9 * summary["cpu_s"].get<double>());
  EXPECT_LE(sum_s, 1.02 * summary["cpu_s"].get<double>());  // every second counts once
  EXPECT_LE(summary["cpu_s"].get<double>(), process_s);
  EXPECT_GT(summary["cpu_s"].get<double>(), 0.5 * process_s);  // the report comes after it
  const auto rows = profiled_cpu_s(done.out);
  EXPECT_EQ(rows.size(), summary["timings"].size());
  EXPECT_TRUE(std::is_sorted(rows.rbegin(), rows.rend()));  // the largest first
}

TEST_F(RunCommand, ReportsAMapThatWasNeverInitialised) {
  const Run lost =
      run("run '" + sequence() + "' -q --set min_initial_keypoints=10000 -o '" + at("out") + "'");
  EXPECT_EQ(lost.exit_code, kTrackingLost);
  EXPECT_THAT(lost.err, AllOf(HasSubstr("the map has no point"), HasSubstr("no frame had enough keypoints")));
}

TEST_F(RunCommand, ReportsGroundTruthWithoutOverlapInTime) {
  const std::string folder = sequence();
  folder_.write("seq/groundtruth.txt", "9000 0 0 0 0 0 0 1\n9001 1 0 0 0 0 0 1\n9002 0 1 0 0 0 0 1\n");
  const Run done = run("run '" + folder + "' -q -o '" + at("out") + "'");
  EXPECT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_THAT(done.err, AllOf(HasSubstr("the estimate lasts from 1.0"),
                              HasSubstr("the truth lasts from 9000.000000 to 9002.000000")));
}

TEST_F(RunCommand, AStreamThatBreaksOffKeepsWhatWasMapped) {
  const std::string send = "python3 '" +
                           (test::source_folder() / "docs/examples/python/stream_frames.py").string() +
                           "' '" + sequence() + "'";
  const std::string map = " | '" KINLOOP_PROGRAM "' run - -q -o '";
  EXPECT_EQ(shell(send + map + at("whole") + "'").exit_code, kDone);
  EXPECT_EQ(run("run '" + at("seq") + "' -q -o '" + at("folder") + "'").exit_code, kDone);
  EXPECT_EQ(read_file(at("whole/trajectory.txt")), read_file(at("folder/trajectory.txt")));
  const Run cut =
      shell(send + " >'" + at("bytes") + "'; head -c -1 '" + at("bytes") + "'" + map + at("cut") + "'");
  EXPECT_EQ(cut.exit_code, kBadInput);
  EXPECT_THAT(cut.err, AllOf(HasSubstr("error: -: record 4"), HasSubstr("docs/protocol.md")));
  EXPECT_EQ(std::count(cut.err.begin(), cut.err.end(), '\n'), 1);
  EXPECT_TRUE(std::filesystem::exists(at("cut/map.kinmap")));
}

}  // namespace
}  // namespace kinloop
