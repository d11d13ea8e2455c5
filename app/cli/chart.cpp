#include "chart.h"

#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "coppice/base/error.h"
#include "coppice/render/png.h"
#include "coppice/system/file.h"

namespace coppice::cli {
namespace {

constexpr double kFont = 13, kTitleFont = 16;                             // [pixels]
constexpr double kLeft = 76, kRight = 20, kTop = 44, kBottom = 58;        // [pixels] margins around the frame
constexpr double kLegendRow = 18, kLegendSwatch = 22, kLegendInset = 10;  // [pixels]
constexpr double kBarsShare = 0.8;  // fraction of the width of a category

struct Color {
    double red, green, blue;
};

/// Colours that remain distinguishable with colour vision deficiency [Okabe2008].
constexpr std::array<Color, 7> kColors{{{0.0, 0.447, 0.698},
                                        {0.835, 0.369, 0.0},
                                        {0.0, 0.620, 0.451},
                                        {0.8, 0.475, 0.655},
                                        {0.902, 0.624, 0.0},
                                        {0.337, 0.706, 0.914},
                                        {0.0, 0.0, 0.0}}};

struct Destroy {
    void operator()(cairo_t* c) const { cairo_destroy(c); }
    void operator()(cairo_surface_t* s) const { cairo_surface_destroy(s); }
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy>;
using Pen = std::unique_ptr<cairo_t, Destroy>;

cairo_status_t append(void* closure, const unsigned char* data, unsigned int length) {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return CAIRO_STATUS_SUCCESS;
}

/// An axis from 0 to a round number, with the distance between its ticks: 1, 2 or 5 times a power of ten.
struct Scale {
    double top = 1, step = 1;

    explicit Scale(double largest) {
        constexpr double kTicks = 6;
        if (!(largest > 0)) return;
        const double power = std::pow(10.0, std::floor(std::log10(largest / kTicks)));
        step = 10 * power;
        for (const double factor : {5.0, 2.0, 1.0})
            if (largest / (factor * power) <= kTicks + 1) step = factor * power;
        top = step * std::ceil(largest / step * (1 - 1e-9));
    }
    int ticks() const { return static_cast<int>(std::lround(top / step)); }
};

class Drawing {
  public:
    Drawing(const Chart& chart, cairo_surface_t* surface)
        : chart_(chart), pen_(cairo_create(surface)), x_(largest(true)), y_(largest(false)) {
        cairo_select_font_face(pen_.get(), "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    }

    void draw() {
        use({1, 1, 1});
        cairo_paint(pen_.get());
        draw_axes();
        for (std::size_t k = 0; k < chart_.series.size(); ++k) {
            use(kColors[k % kColors.size()]);
            chart_.categories.empty() ? draw_line(chart_.series[k]) : draw_bars(chart_.series[k], k);
        }
        draw_legend();
    }

  private:
    double largest(bool x) const {
        double out = 0;
        for (const ChartSeries& s : chart_.series)
            for (const auto& [a, b] : s.values)
                if (const double v = x ? a : b; std::isfinite(v)) out = std::max(out, v);
        return out;
    }

    double right() const { return chart_.width - kRight; }
    double bottom() const { return chart_.height - kBottom; }
    double place_x(double x) const { return kLeft + (right() - kLeft) * x / x_.top; }
    double place_y(double y) const { return bottom() - (bottom() - kTop) * y / y_.top; }
    double category_width() const {
        return (right() - kLeft) / static_cast<double>(chart_.categories.size());
    }

    void use(Color c) { cairo_set_source_rgb(pen_.get(), c.red, c.green, c.blue); }

    void line(double x0, double y0, double x1, double y1, double width) {
        cairo_set_line_width(pen_.get(), width);
        cairo_move_to(pen_.get(), x0, y0);
        cairo_line_to(pen_.get(), x1, y1);
        cairo_stroke(pen_.get());
    }

    double compute_width(const std::string& words, double size) {
        cairo_set_font_size(pen_.get(), size);
        cairo_text_extents_t extents;
        cairo_text_extents(pen_.get(), words.c_str(), &extents);
        return extents.x_advance;
    }

    /// Draws text aligned at a fraction `align` of its width: 0 at its start, 0.5 at its centre, 1 at its
    /// end.
    void text(double x, double y, const std::string& words, double align, double size = kFont) {
        cairo_move_to(pen_.get(), x - align * compute_width(words, size), y);
        cairo_show_text(pen_.get(), words.c_str());
    }

    void draw_axes() {
        for (int k = 0; k <= y_.ticks(); ++k) {
            const double y = place_y(k * y_.step);
            use({0.88, 0.88, 0.88});
            line(kLeft, y, right(), y, 1);
            use({0.2, 0.2, 0.2});
            text(kLeft - 8, y + 0.35 * kFont, fmt::format("{:g}", k * y_.step), 1);
        }
        use({0.2, 0.2, 0.2});
        if (chart_.categories.empty()) {
            for (int k = 0; k <= x_.ticks(); ++k) {
                line(place_x(k * x_.step), bottom(), place_x(k * x_.step), bottom() + 5, 1);
                text(place_x(k * x_.step), bottom() + 20, fmt::format("{:g}", k * x_.step), 0.5);
            }
        }
        for (std::size_t k = 0; k < chart_.categories.size(); ++k) {
            text(kLeft + (static_cast<double>(k) + 0.5) * category_width(), bottom() + 20,
                 chart_.categories[k], 0.5);
        }
        line(kLeft, bottom(), right(), bottom(), 1.5);
        line(kLeft, kTop, kLeft, bottom(), 1.5);
        text(0.5 * chart_.width, 26, chart_.title, 0.5, kTitleFont);
        text(0.5 * (kLeft + right()), chart_.height - 14, chart_.x_label, 0.5);
        cairo_save(pen_.get());
        cairo_translate(pen_.get(), 18, 0.5 * (kTop + bottom()));
        cairo_rotate(pen_.get(), -0.5 * std::numbers::pi);
        text(0, 0, chart_.y_label, 0.5);
        cairo_restore(pen_.get());
    }

    void draw_line(const ChartSeries& series) {
        cairo_set_line_width(pen_.get(), 2);
        cairo_set_line_join(pen_.get(), CAIRO_LINE_JOIN_ROUND);
        cairo_new_path(pen_.get());  // otherwise lines would start at the end of the text
        for (const auto& [x, y] : series.values)
            if (std::isfinite(x) && std::isfinite(y)) cairo_line_to(pen_.get(), place_x(x), place_y(y));
        cairo_stroke(pen_.get());
    }

    void draw_bars(const ChartSeries& series, std::size_t number) {
        const double width = kBarsShare * category_width() / static_cast<double>(chart_.series.size());
        for (const auto& [category, y] : series.values) {
            if (!std::isfinite(y)) continue;
            const double left = kLeft + (category + 0.5 * (1 - kBarsShare)) * category_width();
            cairo_rectangle(pen_.get(), left + static_cast<double>(number) * width, place_y(y), width,
                            bottom() - place_y(y));
        }
        cairo_fill(pen_.get());
    }

    /// Draws the legend on white in the upper right corner of the frame.
    void draw_legend() {
        if (chart_.series.size() < 2) return;
        double widest = 0;
        for (const ChartSeries& s : chart_.series) widest = std::max(widest, compute_width(s.name, kFont));
        const double left = right() - kLegendInset - widest, top = kTop + kLegendInset;
        cairo_set_source_rgba(pen_.get(), 1, 1, 1, 0.85);
        cairo_rectangle(pen_.get(), left - kLegendSwatch - 8, top - 4, widest + kLegendSwatch + 12,
                        kLegendRow * static_cast<double>(chart_.series.size()) + 6);
        cairo_fill(pen_.get());
        for (std::size_t k = 0; k < chart_.series.size(); ++k) {
            const double y = top + kLegendRow * (static_cast<double>(k) + 0.5);
            use(kColors[k % kColors.size()]);
            line(left - kLegendSwatch, y, left - 6, y, 4);
            use({0.2, 0.2, 0.2});
            text(left, y + 0.35 * kFont, chart_.series[k].name, 0);
        }
    }

    const Chart& chart_;
    Pen pen_;
    Scale x_, y_;
};

bool is_svg(const std::filesystem::path& path) {
    return path.extension() == ".svg" || path.extension() == ".SVG";
}

}  // namespace

bool is_chart_name(const std::filesystem::path& path) { return is_svg(path) || is_png_name(path); }

void write_chart(const std::filesystem::path& path, const Chart& chart) {
    std::string bytes;
    const bool svg = is_svg(path);
    const Surface surface(svg ? cairo_svg_surface_create_for_stream(append, &bytes, chart.width, chart.height)
                              : cairo_image_surface_create(CAIRO_FORMAT_RGB24, chart.width, chart.height));
    Drawing(chart, surface.get()).draw();
    if (!svg) cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
    cairo_surface_finish(surface.get());
    const cairo_status_t status = cairo_surface_status(surface.get());
    if (status != CAIRO_STATUS_SUCCESS)
        throw IoError(fmt::format("cannot draw '{}': {}", path.string(), cairo_status_to_string(status)));
    write_file(path, bytes);
}

}  // namespace coppice::cli
