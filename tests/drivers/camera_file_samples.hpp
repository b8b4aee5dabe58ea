#pragma once
// The same camera in every format of camera files that kinloop reads, as the programs write it.

#include <vector>

#include "kinloop/geometry/camera.hpp"

namespace kinloop::test {

struct CameraFileSample {
  const char* format;  ///< that kinloop names
  const char* file;    ///< a usual name
  const char* text;
  bool has_size = false;
  double depth_scale = 0;  ///< 0: not stated
  bool distorted = false;  ///< by `sample_distortion`
};

/// The camera of all samples.
inline PinholeCamera sample_camera() {
  PinholeCamera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = 525.5, camera.fy = 526.5, camera.cx = 318.25, camera.cy = 240.75;
  return camera;
}

inline LensDistortion sample_distortion() {
  LensDistortion lens;
  lens.k1 = 0.25, lens.k2 = -0.5, lens.p1 = 0.001, lens.p2 = -0.002;
  return lens;
}

inline const std::vector<CameraFileSample>& camera_file_samples() {
  static const std::vector<CameraFileSample> kSamples = {
      {"matrix of numbers", "K.txt", "525.5 0 318.25\n0 526.5 240.75\n0 0 1\n"},
      {"matrix of numbers", "numpy_intrinsics.txt",
       "[[525.5, 0., 318.25],\n [0., 526.5, 240.75],\n [0., 0., 1.]]\r\n"},
      {"matrix of numbers", "camera-intrinsics.txt",
       " 5.255e+02\t 0\t 318.25\t 0\n0 526.5 240.75 0\n0 0 1 0\n0 0 0 1\n"},
      {"matrix of numbers", "matlab_K.txt", "525.5 0 0\n0 526.5 0\n318.25 240.75 1\n"},
      {"matrix of numbers", "distorted_K.txt",
       "525.5 0 318.25\n0 526.5 240.75\n0 0 1\n0.25 -0.5 0.001 -0.002 0\n", false, 0, true},
      {"fx fy cx cy [width height]", "camera.txt", "# fx fy cx cy\n525.5 526.5 318.25 240.75\n"},
      {"fx fy cx cy [width height]", "cam.txt", "525.5,526.5,318.25,240.75,640,480\n", true},
      {"fx fy cx cy [width height]", "calibration.txt", "640 480 525.5 526.5 318.25 240.75", true},
      {"fx fy cx cy [width height]", "calib.txt", "525.5 526.5 318.25 240.75 0.25 -0.5 0.001 -0.002 0", false,
       0, true},
      {"COLMAP cameras.txt", "cameras.txt",
       "# Camera list\n# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 PINHOLE 640 480 525.5 526.5 318.75 "
       "241.25\n",
       true},
      {"COLMAP cameras.txt", "sparse_cameras.txt",
       "1 OPENCV 640 480 525.5 526.5 318.75 241.25 0.25 -0.5 0.001 -0.002\n", true, 0, true},
      {"ORB-SLAM or stella_vslam settings", "TUM1.yaml",
       "%YAML:1.0\n\n# Camera Parameters\nCamera.fx: 525.5\nCamera.fy: 526.5\nCamera.cx: 318.25\nCamera.cy: "
       "240.75\n\n"
       "Camera.k1: 0.25\nCamera.k2: -0.5\nCamera.p1: 0.001\nCamera.p2: -0.002\nCamera.k3: 0.\n\n"
       "Camera.width: 640\nCamera.height: 480\nCamera.fps: 30.0\nCamera.bf: 40.0\nCamera.RGB: 1\nThDepth: "
       "40.0\n"
       "DepthMapFactor: 5000.0\nORBextractor.nFeatures: 1000\n",
       true, 5000, true},
      {"ORB-SLAM or stella_vslam settings", "RealSense_D435i.yaml",
       "%YAML:1.0\n\nFile.version: \"1.0\"\n\nCamera.type: \"PinHole\"\n\nCamera1.fx: 525.5\nCamera1.fy: "
       "526.5\n"
       "Camera1.cx: 318.25\nCamera1.cy: 240.75\n\nCamera1.k1: 0.25\nCamera1.k2: -0.5\nCamera1.p1: 0.001\n"
       "Camera1.p2: -0.002\n\nCamera.width: 640\nCamera.height: 480\nCamera.newWidth: 600\nCamera.fps: 30\n"
       "RGBD.DepthMapFactor: 1000.0\nIMU.T_b_c1: !!opencv-matrix\n  rows: 1\n  cols: 2\n  dt: f\n  data: [1, "
       "0]\n",
       true, 1000, true},
      {"ORB-SLAM or stella_vslam settings", "TUM_RGBD_rgbd_1.yaml",
       "Camera:\n  name: \"TUM\"\n  setup: \"RGBD\"\n  model: \"perspective\"\n\n  fx: 525.5\n  fy: 526.5\n  "
       "cx: 318.25\n"
       "  cy: 240.75\n\n  k1: 0.25\n  k2: -0.5\n  p1: 0.001\n  p2: -0.002\n  k3: 0.0\n\n  fps: 30.0\n  cols: "
       "640\n"
       "  rows: 480\n\nPreprocessing:\n  depthmap_factor: 5000.0\n",
       true, 5000, true},
      {"Kalibr camchain", "camchain-cam.yaml",
       "cam0:\n  cam_overlaps: []\n  camera_model: pinhole\n  distortion_coeffs: [0.25, -0.5, 0.001, "
       "-0.002]\n"
       "  distortion_model: radtan\n  intrinsics: [525.5, 526.5, 318.25, 240.75]\n  resolution: [640, 480]\n"
       "  rostopic: /camera/color/image_raw\n",
       true, 0, true},
      {"Nerfstudio transforms.json", "transforms.json",
       R"({"w": 640, "h": 480, "fl_x": 525.5, "fl_y": 526.5, "cx": 318.75, "cy": 241.25, "k1": 0.25, "k2": -0.5,
 "p1": 0.001, "p2": -0.002, "camera_model": "OPENCV", "frames": [{"file_path": "images/0.png",
 "transform_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]})",
       true, 0, true},
      {"Nerfstudio transforms.json", "transforms_frames.json",
       R"({"depth_unit_scale_factor": 0.001, "frames": [
 {"file_path": "0.png", "w": 640, "h": 480, "fl_x": 525.5, "fl_y": 526.5, "cx": 318.75, "cy": 241.25},
 {"file_path": "1.png", "w": 640, "h": 480, "fl_x": 525.5, "fl_y": 526.5, "cx": 318.75, "cy": 241.25}]})",
       true, 1000},
      {"matrix in JSON or YAML", "opencv.yml",
       "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   "
       "cols: 3\n"
       "   dt: d\n   data: [ 5.255e+02, 0., 318.25, 0., 526.5,\n       240.75, 0., 0., 1. ]\n"
       "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
       "   data: [ 0.25, -0.5, 0.001, -0.002, 0. ]\n",
       true, 0, true},
      {"matrix in JSON or YAML", "camera_info.yaml",
       "image_width: 640\nimage_height: 480\ncamera_name: rgb\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
       "  data: [525.5, 0, 318.25, 0, 526.5, 240.75, 0, 0, 1]\ndistortion_model: plumb_bob\n"
       "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.25, -0.5, 0.001, -0.002, 0]\n"
       "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, "
       "1]\nprojection_matrix:\n"
       "  rows: 3\n  cols: 4\n  data: [525.5, 0, 318.25, 0, 0, 526.5, 240.75, 0, 0, 0, 1, 0]\n",
       true, 0, true},
      {"matrix in JSON or YAML", "topic.yaml",
       "header:\n  seq: 0\n  frame_id: \"camera\"\nheight: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\n"
       "D: [0.25, -0.5, 0.001, -0.002, 0.0]\nK: [525.5, 0.0, 318.25, 0.0, 526.5, 240.75, 0.0, 0.0, "
       "1.0]\n---\n"
       "header:\n",
       true, 0, true},
      {"matrix in JSON or YAML", "camera_intrinsic.json",
       R"({"width": 640, "height": 480, "intrinsic_matrix": [525.5, 0, 0, 0, 526.5, 0, 318.25, 240.75, 1]})",
       true},
      {"matrix in JSON or YAML", "K.json", R"({"K": [[525.5, 0, 318.25], [0, 526.5, 240.75], [0, 0, 1]]})"},
      {"matrix in JSON or YAML", "scene_camera.json",
       R"({"0": {"cam_K": [525.5, 0, 318.25, 0, 526.5, 240.75, 0, 0, 1], "depth_scale": 0.1},
 "1": {"cam_K": [525.5, 0, 318.25, 0, 526.5, 240.75, 0, 0, 1], "depth_scale": 0.1}})",
       false, 10'000},
      {"fx, fy, cx, cy in JSON or YAML", "bop_camera.json",
       R"({"cx": 318.25, "cy": 240.75, "depth_scale": 0.1, "fx": 525.5, "fy": 526.5, "height": 480, "width": 640})",
       true, 10'000},
      {"camodocal or VINS camera", "cam0_pinhole.yaml",
       "%YAML:1.0\n---\nmodel_type: PINHOLE\ncamera_name: camera\nimage_width: 640\nimage_height: 480\n"
       "distortion_parameters:\n   k1: 0.25\n   k2: -0.5\n   p1: 0.001\n   p2: -0.002\n"
       "projection_parameters:\n   fx: 525.5\n   fy: 526.5\n   cx: 318.25\n   cy: 240.75\n",
       true, 0, true},
      {"camodocal or VINS camera", "realsense_color_config.yaml",
       "%YAML:1.0\nmodel_type: PINHOLE\nimage_width: 640\nimage_height: 480\ndistortion_parameters:\n   k1: "
       "0.25\n"
       "   k2: -0.5\n   p1: 0.001\n   p2: -0.002\nprojection_parameters:\n   fx: 525.5\n   fy: 526.5\n"
       "   cx: 318.25\n   cy: 240.75\nestimate_extrinsic: 0\nextrinsicRotation: !!opencv-matrix\n   rows: 1\n"
       "   cols: 2\n   dt: d\n   data: [0.5, 0.7]\nestimate_td: 1\n",
       true, 0, true},
      {"Basalt calibration", "basalt_calibration.json",
       R"({"value0": {"T_imu_cam": [{"px": 1, "py": 2}], "intrinsics": [{"camera_type": "pinhole-radtan8", "intrinsics":
 {"fx": 525.5, "fy": 526.5, "cx": 318.25, "cy": 240.75, "k1": 0.25, "k2": -0.5, "p1": 0.001, "p2": -0.002, "k3": 0,
 "k4": 0, "k5": 0, "k6": 0}}], "resolution": [[640, 480]]}})",
       true, 0, true},
      {"MATLAB camera parameters", "cameraParams.json",
       R"({"FocalLength": [525.5, 526.5], "PrincipalPoint": [319.25, 241.75], "ImageSize": [480, 640],
 "RadialDistortion": [0.25, -0.5], "TangentialDistortion": [0.001, -0.002]})",
       true, 0, true},
      {"MATLAB camera parameters", "matlab_camera.json",
       R"({"IntrinsicMatrix": [[525.5, 0, 0], [0, 526.5, 0], [319.25, 241.75, 1]], "ImageSize": [480, 640],
 "RadialDistortion": [0.25, -0.5, 0], "TangentialDistortion": [0.001, -0.002]})",
       true, 0, true},
      {"Agisoft calibration", "camera_agisoft.txt",
       "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<calibration>\n  <projection>frame</projection>\n"
       "  <width>640</width>\n  <height>480</height>\n  <f>526.5</f>\n  <cx>-1.25</cx>\n  <cy>1.25</cy>\n"
       "  <b1>-1</b1>\n  <k1>0.25</k1>\n  <k2>-0.5</k2>\n  <p1>-0.002</p1>\n  <p2>0.001</p2>\n"
       "  <date>2024-01-01T00:00:00Z</date>\n</calibration>\n",
       true, 0, true},
      {"matrix in JSON or YAML", "opencv_camera.txt",
       "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n"
       "<image_height>480</image_height>\n<board_width>9</board_width>\n"
       "<camera_matrix type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n"
       "  <data>\n    525.5 0. 318.25 0. 526.5 240.75 0. 0. 1.</data></camera_matrix>\n"
       "<distortion_coefficients type_id=\"opencv-matrix\">\n  <rows>5</rows>\n  <cols>1</cols>\n  "
       "<dt>d</dt>\n"
       "  <data>0.25 -0.5 0.001 -0.002 0.</data></distortion_coefficients>\n</opencv_storage>\n",
       true, 0, true},
      {"fx, fy, cx, cy in JSON or YAML", "zed_camera.json",
       R"({"calibration_parameters": {"left_cam": {"fx": 525.5, "fy": 526.5, "cx": 318.25, "cy": 240.75,
 "disto": [0.25, -0.5, 0.001, -0.002, 0], "image_size": {"width": 640, "height": 480}},
 "right_cam": {"fx": 500, "fy": 500, "cx": 320, "cy": 240, "disto": [0.3, 0, 0, 0, 0]}}})",
       true, 0, true},
      {"matrix in JSON or YAML", "nested_camera.yaml",
       "K: [[525.5, 0, 318.25], [0, 526.5, 240.75], [0, 0, 1]]\nimage_size: {width: 640, height: 480}\n"
       "distortion: {model: radtan, k1: 0.25, k2: -0.5, p1: 0.001, p2: -0.002}\n",
       true, 0, true},
      {"fx, fy, cx, cy in JSON or YAML", "nested_camera.json",
       R"({"camera": {"intrinsics": {"fx": 525.5, "fy": 526.5, "cx": 318.25, "cy": 240.75}}, "distortion":
 {"radial": [0.25, -0.5, 0], "tangential": [0.001, -0.002]}})",
       false, 0, true},
      {"fx, fy, cx, cy in JSON or YAML", "realsense.json",
       R"({"width": 640, "height": 480, "ppx": 318.25, "ppy": 240.75, "fx": 525.5, "fy": 526.5,
 "model": "distortion.inverse_brown_conrady", "coeffs": [0, 0, 0, 0, 0], "depth_scale": 0.0010000000474974513})",
       true, 1000},
      {"fx, fy, cx, cy in JSON or YAML", "cam_params.json",
       R"({"camera": {"w": 640, "h": 480, "fx": 525.5, "fy": 526.5, "cx": 318.25, "cy": 240.75, "scale": 6553.5}})",
       true, 6553.5},
      {"fx, fy, cx, cy in JSON or YAML", "two.json",
       R"({"depth": {"fx": 400, "fy": 400, "cx": 320, "cy": 240},
 "rgb": {"fx": 525.5, "fy": 526.5, "cx": 318.25, "cy": 240.75}})"},
      {"fx, fy, cx, cy in JSON or YAML", "intrinsics.yaml",
       "fx: 525.5\nfy: 526.5\ncx: 318.25\ncy: 240.75\nk1: 0.25\nk2: -0.5\np1: 0.001\np2: -0.002\n", false, 0,
       true},
      {"fx, fy, cx, cy in JSON or YAML", "config.yaml",
       "dataset: replica\ncam:\n  H: 480\n  W: 640\n  fx: 525.5\n  fy: 526.5\n  cx: 318.25\n  cy: 240.75\n"
       "  png_depth_scale: 1000.0\n",
       true, 1000},
  };
  return kSamples;
}

}  // namespace kinloop::test
