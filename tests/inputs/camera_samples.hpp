// Camera files of every origin, as they are found on disks.
#pragma once

namespace binpick::drivers {

// All of these are the camera fx 812.5, fy 810.25, cx 401.5, cy 299.75, of 800 x 600 px.
struct ReadableCamera {
  const char* origin;
  const char* name;
  const char* text;
  double k1 = 0;           // the first coefficient of its lens
  double depth_scale = 0;  // 0: none
};

inline constexpr ReadableCamera kReadableCameras[] = {
    {"binpick", "camera.json",
     R"({"width": 800, "height": 600, "fx": 812.5, "fy": 810.25, "cx": 401.5, "cy": 299.75,
         "depth_scale": 0.1})",
     0, 0.1},
    {"BOP, nine numbers", "camera.json",
     R"({"cam_K": [812.5, 0, 401.5, 0, 810.25, 299.75, 0, 0, 1], "width": 800, "height": 600,
         "depth_scale": 1.0})",
     0, 1.0},
    {"K of three rows", "camera.json",
     R"({"K": [[812.5, 0, 401.5], [0, 810.25, 299.75], [0, 0, 1]], "width": 800, "height": 600})"},
    {"ROS, calibration file", "ost.yaml",
     R"(image_width: 800
image_height: 600
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [812.5, 0.0, 401.5, 0.0, 810.25, 299.75, 0.0, 0.0, 1.0]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.25, 0.1, 0.001, -0.002, 0.0]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [790.0, 0, 402.0, 0, 0, 791.0, 301.0, 0, 0, 0, 1, 0]
)",
     -0.25},
    {"ROS 1, message of rostopic echo", "camera_info.yaml",
     R"(header: 
  seq: 7
  stamp: 
    secs: 1618
    nsecs: 123456
  frame_id: "camera_optical"
height: 600
width: 800
distortion_model: "rational_polynomial"
D: [0.5, -2.5, 0.0, 0.0, 1.5, 0.4, -2.3, 1.4]
K: [812.5, 0.0, 401.5, 0.0, 810.25, 299.75, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
P: [812.5, 0.0, 401.5, 0.0, 0.0, 810.25, 299.75, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
roi: 
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: False
---
)",
     0.5},
    {"ROS 2, message of ros2 topic echo", "camera_info.yaml",
     R"(header:
  frame_id: camera
height: 600
width: 800
distortion_model: plumb_bob
d:
- 0.125
- -0.25
- 0.0
- 0.0
- 0.0
k:
- 812.5
- 0.0
- 401.5
- 0.0
- 810.25
- 299.75
- 0.0
- 0.0
- 1.0
---
)",
     0.125},
    {"OpenCV, YAML", "calibration.yml",
     R"(%YAML:1.0
---
calibration_time: "Mon 30 Nov 2026"
image_width: 800
image_height: 600
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 8.125e+02, 0., 401.5, 0., 810.25, 299.75, 0., 0.,
       1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.5e-01, .125, 0., 0., 0. ]
avg_reprojection_error: 2.1e-01
)",
     -0.25},
    {"OpenCV, YAML without a mark of the document", "calibration.yaml",
     R"(%YAML:1.0
image_size: [800, 600]
cameraMatrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 812.5, 0., 401.5, 0., 810.25, 299.75, 0., 0., 1. ]
dist_coeffs: !!opencv-matrix
   rows: 1
   cols: 4
   dt: d
   data: [ -0.5, 0., 0., 0. ]
)",
     -0.5},
    {"OpenCV, JSON", "calibration.json",
     R"({"image_width": 800, "image_height": 600,
         "camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
                           "data": [812.5, 0.0, 401.5, 0.0, 810.25, 299.75, 0.0, 0.0, 1.0]},
         "dist_coeffs": {"type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d",
                         "data": [0.25, 0, 0, 0, 0]}})",
     0.25},
    {"OpenCV, XML", "calibration.xml",
     R"(<?xml version="1.0"?>
<opencv_storage>
<image_width>800</image_width>
<image_height>600</image_height>
<Camera_Matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>812.5 0. 401.5 0. 810.25 299.75 0. 0. 1.</data></Camera_Matrix>
<Distortion_Coefficients type_id="opencv-matrix">
  <rows>5</rows>
  <cols>1</cols>
  <dt>d</dt>
  <data>0.75 0. 0. 0. 0.</data></Distortion_Coefficients>
</opencv_storage>
)",
     0.75},
    {"OpenCV from Python, lists of lists", "calibration.json",
     R"({"mtx": [[812.5, 0, 401.5], [0, 810.25, 299.75], [0, 0, 1]], "dist": [[0.5, 0, 0, 0, 0]],
         "width": 800, "height": 600})",
     0.5},
    {"RealSense, without distortion", "color.json",
     R"({"width": 800, "height": 600, "fx": 812.5, "fy": 810.25, "ppx": 401.5, "ppy": 299.75,
         "model": "distortion.inverse_brown_conrady", "coeffs": [0, 0, 0, 0, 0]})"},
    {"RealSense L515", "color.json",
     R"({"width": 800, "height": 600, "fx": 812.5, "fy": 810.25, "ppx": 401.5, "ppy": 299.75,
         "model": "Brown Conrady", "coeffs": [0.125, -0.5, 0, 0, 0.25]})",
     0.125},
    {"RealSense, model by its number", "color.json",
     R"({"width": 800, "height": 600, "fx": 812.5, "fy": 810.25, "ppx": 401.5, "ppy": 299.75,
         "model": 4, "coeffs": [0.125, 0, 0, 0, 0]})",
     0.125},
    {"Open3D, by columns", "intrinsic.json",
     R"({"width": 800, "height": 600,
         "intrinsic_matrix": [812.5, 0, 0, 0, 810.25, 0, 401.5, 299.75, 1]})"},
    {"Open3D, with its count of units per metre", "intrinsic.json",
     R"({"width": 800, "height": 600, "depth_scale": 4000.0,
         "intrinsic_matrix": [812.5, 0, 0, 0, 810.25, 0, 401.5, 299.75, 1]})",
     0, 0.25},
    {"Open3D, view of its visualizer", "view.json",
     R"({"class_name": "PinholeCameraParameters", "extrinsic": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0,
         0, 0, 0, 1], "intrinsic": {"width": 800, "height": 600, "intrinsic_matrix":
         [812.5, 0, 0, 0, 810.25, 0, 401.5, 299.75, 1]}, "version_major": 1, "version_minor": 0})"},
    {"nested, with the size outside", "rig.json",
     R"({"width": 800, "height": 600, "intrinsics": {"fx": 812.5, "fy": 810.25, "cx": 401.5,
         "cy": 299.75}, "distortion": {"model": "plumb_bob", "k1": 0.5, "p2": 0.001}})",
     0.5},
    {"nested twice", "rig.yaml", R"(cell:
  station: 4
  color:
    width: 800
    height: 600
    fx: 812.5
    fy: 810.25
    cx: 401.5
    cy: 299.75
)"},
    {"Zivid", "camera.yml", R"(__version__:
  serializer: 1
CameraIntrinsics:
  CameraMatrix:
    CX: 401.5
    CY: 299.75
    FX: 812.5
    FY: 810.25
  Distortion:
    K1: -0.25
    K2: 0.125
    K3: 0
    P1: 0
    P2: 0
)",
     -0.25},
    {"YAML whose name does not tell it", "camera.txt",
     "fx: 812.5\nfy: 810.25\ncx: 401.5\ncy: 299.75\nresolution: [800, 600]\n"},
};

}  // namespace binpick::drivers
