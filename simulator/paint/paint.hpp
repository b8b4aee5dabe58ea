#pragma once
// In: a seed. Out: procedural textures: materials, pictures, and the faces of everyday objects. Every
// function returns an 8UC3 BGR image whose sides are powers of two.

#include <cstdint>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/random.hpp"

namespace kinloop::sim {

/// Limits of a random number.
struct Range {
  double low = 0, high = 1;
};

/// Random helpers shared by the painters. C++ leaves open in which order the arguments of a call are
/// evaluated, so painters and furniture draw at most one number in each call and name the others before it.
/// Their order decides what every seed's room looks like.
int random_below(Random& random, int count);  ///< 0 to count - 1
cv::Scalar hsv(double hue_deg, double saturation, double value);
cv::Scalar random_color(Random& random, double max_saturation, double min_value, double max_value);
/// Returns a colour of the hue `base_hue_deg` plus a number from `hue_deg`.
cv::Scalar random_hsv(Random& random, Range hue_deg, Range saturation, Range value, double base_hue_deg = 0);
cv::Scalar random_hsv(Random& random, Range hue_deg, double saturation, Range value);
cv::Point random_point(Random& random, cv::Size size);

/// Sum of octaves of smooth noise, about -1 to 1, CV_32F; periodic for power-of-two sizes. The first octave
/// has `cells` cells over the image, each further one twice as many at `gain` times the amplitude.
cv::Mat fractal_noise(cv::Size size, cv::Size cells, int octaves, double gain, Random& random);

/// Multiplies an image by (1 + contrast * noise), pixel by pixel.
void shade(cv::Mat& image, const cv::Mat& noise, double contrast);

/// Returns `color` times (1 + contrast * noise).
cv::Mat shaded(const cv::Scalar& color, const cv::Mat& noise, double contrast);

/// Writes lines of pseudo words from `top_left`, `line_px` apart, down to the lower right corner of `area`.
void write_lines(cv::Mat& image, const cv::Rect& area, double line_px, const cv::Scalar& ink, Random& random);

// Materials.
cv::Mat paint_plaster(Random& random);
cv::Mat paint_wallpaper(Random& random);
cv::Mat paint_bricks(Random& random);
cv::Mat paint_planks(Random& random);
cv::Mat paint_carpet(Random& random);
cv::Mat paint_tiles(Random& random);
cv::Mat paint_wood(Random& random);
cv::Mat paint_fabric(Random& random);
cv::Mat paint_plain(Random& random);
cv::Mat paint_metal(Random& random);
cv::Mat paint_cardboard(Random& random);
cv::Mat paint_leaf(Random& random);
cv::Mat paint_rug(Random& random);

// Pictures for walls.
cv::Mat paint_landscape(Random& random);
cv::Mat paint_abstract(Random& random);
cv::Mat paint_poster(Random& random);
cv::Mat paint_map(Random& random);
cv::Mat paint_whiteboard(Random& random);
cv::Mat paint_window_view(Random& random);

// Faces of objects.
cv::Mat paint_paper(Random& random);
cv::Mat paint_screen(Random& random);
cv::Mat paint_keyboard(Random& random);
cv::Mat paint_label(Random& random);
cv::Mat paint_book_spines(Random& random);  ///< an atlas of kSpineColumns x kSpineRows spines
cv::Mat paint_drawers(Random& random);
cv::Mat paint_door(Random& random);
cv::Mat paint_clock(Random& random);
cv::Mat paint_ball(Random& random);

constexpr int kSpineColumns = 16;
constexpr int kSpineRows = 2;

}  // namespace kinloop::sim
