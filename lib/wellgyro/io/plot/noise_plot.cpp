#include "wellgyro/io/plot/noise_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <fmt/core.h>

#include "wellgyro/io/plot/plot_text_internal.h"

namespace wellgyro {
namespace {

// Pixels, of the picture and around the plot.
constexpr double kNoiseWidth = 900;
constexpr double kNoiseHeight = 620;
constexpr double kNoiseLeft = 90;
constexpr double kNoiseTop = 66;
constexpr double kNoiseRight = 290;  // the legend stands here
constexpr double kNoiseBottom = 70;

// Told apart also by readers who do not see red and green (Okabe and Ito).
constexpr std::array<const char*, kNoiseTerms> kTermColours{"#cc79a7", "#0072b2", "#009e73",
                                                            "#d55e00", "#e69f00", "#56b4e9"};

// One logarithmic axis on the paper.
struct LogAxis {
  double low = 0;  // powers of ten
  double high = 1;
  double from = 0;  // pixels
  double to = 1;

  double operator()(double value) const {
    return from + (std::log10(value) - low) / (high - low) * (to - from);
  }
};

struct Point {
  double x = 0;
  double y = 0;
};

class Plot {
 public:
  Plot(std::span<const AllanRow> rows, const NoiseFit* fit, const NoisePlotLabels& labels)
      : rows_(rows), fit_(fit), labels_(labels) {
    double least = std::numeric_limits<double>::infinity();
    double most = 0;
    for (const auto& row : rows) {
      const double deviation = Deviation(row.point.variance);
      // The widest bounds, of the last few points, may leave the paper.
      least = std::min(least, std::max(Deviation(row.interval95.lower), deviation / 3));
      most = std::max(most, std::min(Deviation(row.interval95.upper), deviation * 3));
    }
    // The floor that bias instability makes is looked for on the paper.
    if (fit && fit->term[NoiseTerm::kBiasInstability].observable) {
      const double b = fit->term[NoiseTerm::kBiasInstability].value;
      if (!fit->model.shape.correlation_time) {
        least = std::min(
            least,
            Deviation(b * b * UnitAllanVariance(NoiseTerm::kBiasInstability, fit->model.shape, 1)));
      }
    }
    x_ = Axis(rows.front().point.tau, rows.back().point.tau, kNoiseLeft, kNoiseWidth - kNoiseRight);
    y_ = Axis(least, most, kNoiseHeight - kNoiseBottom, kNoiseTop);
  }

  std::string Svg() {
    svg_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
        "height=\"{1:g}\" font-family=\"sans-serif\" font-size=\"13\" fill=\"#222\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        "<clipPath id=\"paper\"><rect x=\"{2:g}\" y=\"{3:g}\" width=\"{4:g}\" height=\"{5:g}\"/>"
        "</clipPath>\n",
        kNoiseWidth, kNoiseHeight, kNoiseLeft, kNoiseTop, kNoiseWidth - kNoiseRight - kNoiseLeft,
        kNoiseHeight - kNoiseBottom - kNoiseTop);
    DrawGrid();
    svg_ += "<g clip-path=\"url(#paper)\">\n";
    DrawBand();
    DrawFit();
    DrawPoints();
    svg_ += "</g>\n";
    DrawLegend();
    DrawWarnings();
    return svg_ + "</svg>\n";
  }

 private:
  static LogAxis Axis(double least, double most, double from, double to) {
    // Half a decade at least, and no line on the frame.
    double low = std::log10(least) - 0.1;
    double high = std::log10(most) + 0.1;
    const double missing = std::max(0., 1 - (high - low));
    low -= missing / 2;
    high += missing / 2;
    return {low, high, from, to};
  }

  double Deviation(double variance) const { return std::sqrt(variance) / labels_.deviation_si; }

  void Line(double x1, double y1, double x2, double y2, const char* colour) {
    svg_ += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" fill=\"none\"/>\n",
                        x1, y1, x2, y2, colour);
  }

  void Text(double x, double y, const char* anchor, const std::string& text) {
    svg_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y,
                        anchor, text);
  }

  static std::string PowerText(int power) {
    if (power >= -3 && power <= 4) return fmt::format("{:g}", std::pow(10, power));
    return fmt::format("10<tspan dy=\"-6\" font-size=\"10\">{}</tspan>", power);
  }

  void DrawAxis(const LogAxis& axis, bool horizontal) {
    const double paper_end = horizontal ? kNoiseHeight - kNoiseBottom : kNoiseWidth - kNoiseRight;
    const double paper_begin = horizontal ? kNoiseTop : kNoiseLeft;
    const bool wide = axis.high - axis.low > 8;
    const bool narrow = axis.high - axis.low < 2.2;
    for (int power = static_cast<int>(std::floor(axis.low)); power <= axis.high; ++power) {
      for (int k = 1; k < 10; ++k) {
        const double value = k * std::pow(10, power);
        const double at = axis(value);
        if (at < std::min(axis.from, axis.to) || at > std::max(axis.from, axis.to)) continue;
        if (k > 1 && wide) continue;
        const char* colour = k == 1 ? "#bbb" : "#eee";
        if (horizontal) {
          Line(at, paper_begin, at, paper_end, colour);
        } else {
          Line(paper_begin, at, paper_end, at, colour);
        }
        const bool between = narrow && (k == 2 || k == 5);
        if (k != 1 && !between) continue;
        const std::string text = k == 1 ? PowerText(power) : fmt::format("{:g}", value);
        if (horizontal) {
          Text(at, paper_end + 20, "middle", text);
        } else {
          Text(kNoiseLeft - 8, at + 4, "end", text);
        }
      }
    }
  }

  void DrawGrid() {
    DrawAxis(x_, true);
    DrawAxis(y_, false);
    svg_ += fmt::format(
        "<rect x=\"{:g}\" y=\"{:g}\" width=\"{:g}\" height=\"{:g}\" fill=\"none\" "
        "stroke=\"#222\"/>\n",
        kNoiseLeft, kNoiseTop, kNoiseWidth - kNoiseRight - kNoiseLeft,
        kNoiseHeight - kNoiseBottom - kNoiseTop);
    Text((kNoiseLeft + kNoiseWidth - kNoiseRight) / 2, kNoiseHeight - 24, "middle",
         "averaging time [s]");
    svg_ += fmt::format(
        "<text transform=\"translate(24 {:g}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
        (kNoiseTop + kNoiseHeight - kNoiseBottom) / 2, SvgText(labels_.deviation));
    svg_ += fmt::format("<text x=\"{:g}\" y=\"30\" font-size=\"16\">{}</text>\n", kNoiseLeft,
                        SvgText(labels_.title));
    std::string facts;
    for (const std::string& fact : labels_.facts) facts += (facts.empty() ? "" : "; ") + fact;
    Text(kNoiseLeft, 50, "start", SvgText(facts));
  }

  std::string PathOf(const std::vector<Point>& points) const {
    std::string path;
    for (const auto& p : points) {
      path += fmt::format("{}{:.2f} {:.2f}", path.empty() ? 'M' : 'L', p.x, p.y);
    }
    return path;
  }

  void DrawBand() {
    std::vector<Point> outline;
    for (const auto& row : rows_) {
      outline.push_back({x_(row.point.tau), y_(Deviation(row.interval95.upper))});
    }
    for (auto row = rows_.rbegin(); row != rows_.rend(); ++row) {
      outline.push_back({x_(row->point.tau), y_(Deviation(row->interval95.lower))});
    }
    svg_ +=
        fmt::format("<path d=\"{}Z\" fill=\"#9ecae1\" fill-opacity=\"0.5\"/>\n", PathOf(outline));
  }

  template <class Variance>
  std::string Curve(Variance variance) const {
    constexpr int kPoints = 240;  // a point every 2.2 pixels
    std::vector<Point> points;
    const double first = rows_.front().point.tau;
    const double last = rows_.back().point.tau;
    for (int i = 0; i <= kPoints; ++i) {
      const double tau = first * std::pow(last / first, static_cast<double>(i) / kPoints);
      const double value = variance(tau);
      // Far below the paper a curve only makes the file larger.
      if (value <= 0 || std::log10(Deviation(value)) < y_.low - 1) continue;
      points.push_back({x_(tau), y_(Deviation(value))});
    }
    return PathOf(points);
  }

  void DrawFit() {
    if (!fit_) return;
    const NoiseModel& model = fit_->model;
    for (const auto term : kAllNoiseTerms) {
      if (!fit_->term[term].observable) continue;
      const double c = fit_->term[term].value;
      svg_ += fmt::format(
          "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\" "
          "stroke-dasharray=\"7 4\"/>\n",
          Curve([&](double tau) { return c * c * UnitAllanVariance(term, model.shape, tau); }),
          kTermColours[static_cast<std::size_t>(term)]);
    }
    svg_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#222\" stroke-width=\"1.5\"/>\n",
                        Curve([&](double tau) { return ModelAllanVariance(model, tau); }));
  }

  void DrawPoints() {
    // Many points stand too close for circles.
    const double radius = rows_.size() > 60 ? 1.6 : 3;
    for (const auto& row : rows_) {
      svg_ += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:g}\" fill=\"#08519c\"/>\n",
                          x_(row.point.tau), y_(Deviation(row.point.variance)), radius);
    }
  }

  void DrawLegend() {
    const double x = kNoiseWidth - kNoiseRight + 16;
    double y = kNoiseTop + 12;
    const auto entry = [&](const std::string& mark, const std::string& text) {
      svg_ += mark;
      Text(x + 34, y + 4, "start", text);
      y += 24;
    };
    entry(fmt::format("<circle cx=\"{:g}\" cy=\"{:g}\" r=\"3\" fill=\"#08519c\"/>", x + 13, y),
          "measured");
    entry(fmt::format("<rect x=\"{:g}\" y=\"{:g}\" width=\"26\" height=\"12\" fill=\"#9ecae1\" "
                      "fill-opacity=\"0.5\"/>",
                      x, y - 6),
          "95 % interval");
    if (!fit_) return DrawBounds(y);
    const auto stroke = [&](const char* colour, const char* dash) {
      return fmt::format(
          "<path d=\"M{:g} {:g}h26\" stroke=\"{}\" stroke-width=\"1.5\" stroke-dasharray=\"{}\"/>",
          x, y, colour, dash);
    };
    entry(stroke("#222", "none"), "fitted sum");
    for (const auto term : kAllNoiseTerms) {
      if (!fit_->term[term].observable) continue;
      // Name on one line, value on the next.
      const std::string& label = labels_.term[term];
      const std::size_t split = std::min(label.find('\n'), label.size());
      entry(stroke(kTermColours[static_cast<std::size_t>(term)], "7 4"),
            SvgText(label.substr(0, split)));
      if (split < label.size()) {
        y -= 6;
        Text(x + 34, y + 2, "start", SvgText(label.substr(split + 1)));
        y += 24;
      }
    }
    DrawBounds(y + 8);
  }

  /// What is not observable, as far as the paper goes.
  void DrawBounds(double y) {
    const double x = kNoiseWidth - kNoiseRight + 16;
    for (const std::string& bound : labels_.bounds) {
      if (y > kNoiseHeight - kNoiseBottom) return;
      svg_ += fmt::format("<text x=\"{:g}\" y=\"{:g}\" font-size=\"11\">{}</text>\n", x, y + 4,
                          SvgText(bound));
      y += 16;
    }
  }

  void DrawWarnings() {
    constexpr std::size_t kMost = 6;      // lines
    constexpr std::size_t kLetters = 86;  // of a line that stays on the paper
    double y = kNoiseHeight - kNoiseBottom - 12;
    for (std::size_t i = std::min(labels_.warnings.size(), kMost); i-- > 0;) {
      std::string text = labels_.warnings[i];
      if (text.size() > kLetters) {
        std::size_t end = kLetters;
        while ((static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // whole characters
        text = text.substr(0, end) + " ...";
      }
      svg_ +=
          fmt::format("<text x=\"{:g}\" y=\"{:g}\" font-size=\"12\" fill=\"#9c0000\">{}</text>\n",
                      kNoiseLeft + 10, y, SvgText(text));
      y -= 17;
    }
  }

  std::span<const AllanRow> rows_;
  const NoiseFit* fit_;
  const NoisePlotLabels& labels_;
  LogAxis x_;
  LogAxis y_;
  std::string svg_;
};

}  // namespace

std::string NoisePlotSvg(std::span<const AllanRow> rows, const NoiseFit* fit,
                         const NoisePlotLabels& labels) {
  if (rows.empty()) throw std::invalid_argument("NoisePlotSvg: there are no rows");
  return Plot(rows, fit, labels).Svg();
}

}  // namespace wellgyro
