#include "figures/canvas.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <cstring>
#include <span>
#include <system_error>

#include "base/files.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

constexpr const char* kFont = "DejaVu Sans";
constexpr int kTicks = 5;
constexpr double kRounding = 1e-9;  // of a tick, relative to the step

cairo_status_t append(void* png, const unsigned char* data, unsigned length) {
  static_cast<std::string*>(png)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

Canvas::Canvas(double width, double height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(width * kPixelsPerPoint)),
                                          static_cast<int>(std::ceil(height * kPixelsPerPoint))),
               cairo_surface_destroy),
      cairo_(cairo_create(surface_.get()), cairo_destroy) {
  if (cairo_status(cairo_.get()) != CAIRO_STATUS_SUCCESS)
    throw Error(ErrorKind::kInput, fmt::format("cannot draw a picture of {:.0f} x {:.0f} points: {}", width, height,
                                               cairo_status_to_string(cairo_status(cairo_.get()))));
  cairo_scale(*this, kPixelsPerPoint, kPixelsPerPoint);
  colour(kPaper);
  cairo_paint(*this);
  cairo_set_line_join(*this, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(*this, CAIRO_LINE_CAP_ROUND);
}

void Canvas::font(double size, bool bold) const {
  cairo_select_font_face(*this, kFont, CAIRO_FONT_SLANT_NORMAL, bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(*this, size);
}

double Canvas::widthOf(const std::string& text) const {
  cairo_text_extents_t extents;
  cairo_text_extents(*this, text.c_str(), &extents);
  return extents.x_advance;
}

void Canvas::text(double x, double y, const std::string& text, double anchor, double room) const {
  cairo_save(*this);
  const double width = widthOf(text);
  const double scale = room > 0 && width > room ? room / width : 1;
  cairo_translate(*this, x - anchor * width * scale, y);
  cairo_scale(*this, scale, scale);
  cairo_move_to(*this, 0, 0);
  cairo_show_text(*this, text.c_str());
  cairo_restore(*this);
  cairo_new_path(*this);
}

void Canvas::heading(const std::string& title, const std::string& subtitle, double width) const {
  colour(kInk);
  font(kHeading, true);
  text(kMargin, kMargin + 0.75 * kHeading, title, 0, width - 2 * kMargin);
  colour(kGrey);
  font(kBody);
  text(kMargin, kMargin + kHeading + 0.9 * kBody + 4, subtitle, 0, width - 2 * kMargin);
}

void Canvas::save(const std::filesystem::path& file) const {
  std::error_code error;
  if (!file.parent_path().empty() && !std::filesystem::is_directory(file.parent_path(), error))
    throw Error(ErrorKind::kIo, "cannot write " + file.string() + ": its folder does not exist");
  std::string png;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface_.get(), append, &png);
  if (status != CAIRO_STATUS_SUCCESS) throw Error(ErrorKind::kIo, "cannot write " + file.string() + ": " + cairo_status_to_string(status));
  writeFileAtomically(file, std::as_bytes(std::span(png)));
}

Pixels Canvas::pixels() const {
  cairo_surface_flush(surface_.get());
  Pixels pixels{.width = static_cast<std::size_t>(cairo_image_surface_get_width(surface_.get())),
                .height = static_cast<std::size_t>(cairo_image_surface_get_height(surface_.get())),
                .values = {}};
  pixels.values.reserve(3 * pixels.width * pixels.height);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface_.get()));
  for (std::size_t y = 0; y < pixels.height; ++y) {
    const unsigned char* const row = cairo_image_surface_get_data(surface_.get()) + y * stride;
    for (std::size_t x = 0; x < pixels.width; ++x) {
      std::uint32_t pixel = 0;  // 0x00rrggbb
      std::memcpy(&pixel, row + sizeof(pixel) * x, sizeof(pixel));
      for (const int shift : {16, 8, 0}) pixels.values.push_back(static_cast<std::uint8_t>(pixel >> shift));
    }
  }
  return pixels;
}

double headingRoom(const std::string& subtitle) {
  return kMargin + kHeading + (subtitle.empty() ? 0 : kBody + 8) + 20;
}

double tickStep(double range) {
  const double raw = range / kTicks;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= raw) return step * power;
  return 10 * power;
}

std::vector<double> ticksOf(double low, double high) {
  const double step = tickStep(high - low);
  std::vector<double> ticks;
  for (double k = std::ceil(low / step - kRounding); k * step <= high + kRounding * step; ++k) ticks.push_back(k == 0 ? 0 : k * step);
  return ticks;
}

}  // namespace taxelsim::figures
