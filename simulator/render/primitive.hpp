#pragma once
// In: solids in the room frame (z up, floor at z = 0, metres). Out: bounds, exact surface distance, and
// surface coordinates for texture and light lookup.

#include <vector>

#include <Eigen/Geometry>

namespace kinloop::sim {

enum class Shape { kBox, kCylinder, kSphere, kEllipsoid };

/// Mapping of a texture to a face: fitted (fractions of the face) or metric (metres times 1 / period).
struct FaceTexture {
  int texture = 0;
  bool fitted = false;
  float u0 = 0, v0 = 0;            ///< texture coordinate of the face's corner
  float u_scale = 1, v_scale = 1;  ///< texture widths per face (fitted) or per metre (metric)
};

/// Faces of a solid: those of a box by axis and sign; a cylinder has the round side (0) and two caps, a
/// sphere or ellipsoid only face 0.
constexpr int kFaces = 6;
constexpr int kNoFace = -1;
enum Face { kLeft = 0, kRight = 1, kFront = 2, kBack = 3, kBottom = 4, kTop = 5 };

/// A convex solid. Seen from its front (-y), x points right and z up.
struct Primitive {
  Shape shape = Shape::kBox;
  Eigen::Matrix3f R_room_local = Eigen::Matrix3f::Identity();
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  Eigen::Vector3f half = Eigen::Vector3f::Ones();  ///< half extents; radius, radius, half height; radii
  FaceTexture face_texture;                        ///< of all faces but `picture_face`
  FaceTexture picture;
  int picture_face = kNoFace;
  bool emissive = false;         ///< shows its texture at full brightness (a lamp, a screen, the sky)
  bool no_depth_return = false;  ///< gives a Kinect no depth (glass, a lamp)
};

/// A point on a primitive: the face, fractions along it (v downwards), and the size of that face.
struct SurfacePoint {
  int face = 0;
  float u = 0, v = 0;
  float width_m = 0, height_m = 0;
};

/// Returns the surface coordinates of a local point on (or near) the surface.
SurfacePoint locate(const Primitive& primitive, const Eigen::Vector3f& p_local);

/// The inverse of `locate`: local point and outward normal at fractions (u, v) of a face.
struct SurfaceFrame {
  Eigen::Vector3f p_local, normal_local;
};
SurfaceFrame surface_frame(const Primitive& primitive, int face, float u, float v);

/// Returns the outward local normal at a local surface point.
Eigen::Vector3f normal_at(const Primitive& primitive, const Eigen::Vector3f& p_local);

/// Returns width and height of a face, zero if the shape has no such face.
Eigen::Vector2f face_size_m(const Primitive& primitive, int face);

/// Returns the signed distance from a point in the room to the surface, negative inside; of an ellipsoid, an
/// approximation that is exact on the surface.
double signed_distance_m(const Primitive& primitive, const Eigen::Vector3d& p_room);

/// Returns the axis-aligned bounding box of a primitive.
Eigen::AlignedBox3f bounds(const Primitive& primitive);

/// Returns the primitive rotated about z and translated.
Primitive moved(Primitive primitive, float yaw_rad, const Eigen::Vector3f& translation);

}  // namespace kinloop::sim
