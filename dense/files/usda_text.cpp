#include <iterator>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <fmt/format.h>

#include "dense/files/linear_color.hpp"
#include "dense/files/mesh_formats.hpp"

namespace kinloop {
namespace {

/// Appends `name = [...]` with the text that `item` returns for each index.
template <class Item>
void add_list(std::string& text, const char* name, size_t count, const Item& item,
              const char* metadata = "") {
  text += fmt::format("    {} = [", name);
  for (size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    text += item(i);
  }
  text += fmt::format("]{}\n", metadata);
}

std::string text_of(const Eigen::Vector3f& v, int digits) {
  return fmt::format("({0:.{3}f}, {1:.{3}f}, {2:.{3}f})", v.x(), v.y(), v.z(), digits);
}

std::string text_of(const Triangle& triangle) {
  return fmt::format("{}, {}, {}", triangle[0], triangle[1], triangle[2]);
}

void add_colors(std::string& text, const FileMesh& file) {
  constexpr int kDigits = 4;
  add_list(
      text, "color3f[] primvars:displayColor", file.size(),
      [&](size_t i) {
        const auto& [red, green, blue] = file.mesh.colors[i];
        const Eigen::Vector3d linear(linear_color(red), linear_color(green), linear_color(blue));
        return text_of(linear.cast<float>(), kDigits);
      },
      " (interpolation = \"vertex\")");
}

void add_places(std::string& text, const MeshTexture& texture) {
  text += "    rel material:binding = </Map/Images>\n";
  add_list(
      text, "texCoord2f[] primvars:st", texture.uvs.size(),
      [&](size_t i) { return fmt::format("({:.6f}, {:.6f})", texture.uvs[i].x(), 1 - texture.uvs[i].y()); },
      " (interpolation = \"faceVarying\")");
  add_list(text, "int[] primvars:st:indices", texture.triangles.size(),
           [&](size_t i) { return text_of(texture.triangles[i]); });
}

/// The path of an asset beside the scene. One with an @ stands between three, in which three are escaped.
std::string asset(std::string name) {
  constexpr std::string_view kThree = "@@@";
  if (name.find('@') == std::string::npos) return fmt::format("@./{}@", name);
  for (size_t at = 0; (at = name.find(kThree, at)) != std::string::npos; at += kThree.size() + 1)
    name.insert(at, 1, '\\');
  return fmt::format("@@@./{}@@@", name);
}

/// The images already contain the light of the room, so the surface emits them.
std::string material(const std::string& image) {
  return fmt::format(R"(def Material "Images"
{{
    token outputs:surface.connect = </Map/Images/Surface.outputs:surface>

    def Shader "Surface"
    {{
        uniform token info:id = "UsdPreviewSurface"
        color3f inputs:diffuseColor = (0, 0, 0)
        color3f inputs:emissiveColor.connect = </Map/Images/Texture.outputs:rgb>
        float inputs:roughness = 1
        token outputs:surface
    }}

    def Shader "Texture"
    {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = {}
        token inputs:sourceColorSpace = "sRGB"
        float2 inputs:st.connect = </Map/Images/Places.outputs:result>
        float3 outputs:rgb
    }}

    def Shader "Places"
    {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }}
}}

)",
                     asset(image));
}

}  // namespace

std::string usda_text(const FileMesh& file, const std::string& image) {
  constexpr int kDigits = 5, kNormalDigits = 3;
  // USD knows y up and z up; the frame of a camera, y down, is turned over.
  std::string text = fmt::format(
      "#usda 1.0\n(\n    defaultPrim = \"Map\"\n    metersPerUnit = 1\n    upAxis = \"{}\"\n"
      "    customLayerData = {{\n        string kinloop = \"{}\"\n    }}\n)\n\ndef Xform \"Map\"\n{{\n",
      file.frame.z_up ? "Z" : "Y", fmt::join(format_frame_comments(file.frame), "; "));
  if (!file.frame.z_up)
    text += "double xformOp:rotateX = 180\nuniform token[] xformOpOrder = [\"xformOp:rotateX\"]\n\n";
  if (file.texture != nullptr) text += material(image);
  text += "def Mesh \"Mesh\" (prepend apiSchemas = [\"MaterialBindingAPI\"])\n{\n";
  text += "    uniform token subdivisionScheme = \"none\"\n    bool doubleSided = 1\n";
  const auto& triangles = file.mesh.triangles;
  add_list(text, "int[] faceVertexCounts", triangles.size(), [](size_t) { return "3"; });
  add_list(text, "int[] faceVertexIndices", triangles.size(),
           [&](size_t i) { return text_of(triangles[i]); });
  add_list(text, "point3f[] points", file.size(), [&](size_t i) { return text_of(file.point(i), kDigits); });
  add_list(
      text, "normal3f[] normals", file.size(),
      [&](size_t i) { return text_of(file.normal(i), kNormalDigits); }, " (interpolation = \"vertex\")");
  if (file.texture != nullptr) {
    add_places(text, *file.texture);
  } else {
    add_colors(text, file);
  }
  return text + "}\n}\n";
}

}  // namespace kinloop
