#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/report/axes.h"

namespace talus {
namespace {

// Decimals that show the uncertainty with two digits.
int decimals_for(double std) {
  if (!(std > 0) || !std::isfinite(std)) return 4;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(std))), 0, 7);
}

std::string with_std(double value, double std, const Unit& unit) {
  const int d = decimals_for(std / unit.factor);
  return fmt::format("{:.{}f} ± {:.{}f}", value / unit.factor, d, std / unit.factor, d);
}

class Text {
 public:
  Text(const AxisFinder& finder, const AxesResult& result, const AxesContext& context)
      : finder_(finder), result_(result), context_(context), units_(finder.program().units) {}

  std::string whole() {
    const Located& reference = result_.whole.located[0];
    out_ = fmt::format("{}\n  model {}{}\n", finder_.program().name, context_.model_file,
                       context_.linkage_file.empty() ? "" : ", linkage " + context_.linkage_file);
    fits(result_.whole);
    out_ += fmt::format("\nAxes in the reference, {}\n", context_.recordings_files[0]);
    for (std::size_t k = 0; k < reference.axes.size(); ++k) axis(reference, k);
    between(reference);
    if (result_.whole.located.size() > 1) {
      changes(result_.whole);
      for (const ArcAxes& arc : result_.arcs) changes(arc);
    } else {
      for (const ArcAxes& arc : result_.arcs) arc_alone(arc);
    }
    errors();
    return out_;
  }

 private:
  Unit unit(std::size_t variable) const { return variable < 2 ? units_.length : units_.angle; }

  void fits(const ArcAxes& of) {
    for (std::size_t r = 0; r < of.located.size(); ++r) {
      const Located& l = of.located[r];
      out_ +=
          fmt::format("  recordings {}: {} poses, residuals {:.3g} {}; uncertainties from {}\n",
                      context_.recordings_files[r], l.fit.poses_fit,
                      l.fit.noise_known ? l.fit.fit_rms / l.fit.expected_rms : l.fit.noise_scale,
                      l.fit.noise_known ? "times the stated noise" : "(weighted; noise not stated)",
                      l.observed ? "the residuals' spread from pose to pose" : "the stated noise");
      for (const std::string& w : l.fit.warnings)
        if (w.starts_with("The solver") || w.starts_with("Another set"))
          out_ += fmt::format("    {}\n", w);
    }
  }

  void axis(const Located& l, std::size_t k) {
    const LocatedAxis& a = l.axes[k];
    const Hinge& h = finder_.hinges()[k];
    const View& view = result_.views[k];
    const std::string body = finder_.body(h);
    out_ += fmt::format("  {}, {} {}{}; {} from {:.1f} to {:.1f} {}\n", h.name,
                        h.still ? "still in" : "in", body, h.still ? "" : " at zero angles",
                        h.coordinate, a.low / units_.angle.factor, a.high / units_.angle.factor,
                        units_.angle.text);
    if (!a.determined) {
      out_ += fmt::format("    {}\n", a.why);
      return;
    }
    const Eigen::Vector3d p = a.line.point / units_.length.factor, u = a.line.direction;
    out_ += fmt::format(
        "    through ({:.3f}, {:.3f}, {:.3f}) {} along ({:.5f}, {:.5f}, {:.5f}) in {}\n", p[0],
        p[1], p[2], units_.length.text, u[0], u[1], u[2], body);
    const auto names = context_.labels.of(view.main);
    out_ +=
        fmt::format("    in {}, main direction {}:", view.name, context_.labels.along[view.main]);
    for (std::size_t v = 0; v < 4; ++v)
      out_ += fmt::format("{} {} {} {}", v ? "," : "", names[v],
                          with_std(a.value[v], a.std[v], unit(v)), unit(v).text);
    out_ += "\n";
  }

  void between(const Located& l) {
    for (const Apartness& p : l.apart) {
      if (!l.axes[p.first].determined || !l.axes[p.second].determined) continue;
      out_ += fmt::format("  {} and {}: angle {} {}, distance {} {}\n",
                          finder_.hinges()[p.first].name, finder_.hinges()[p.second].name,
                          with_std(p.angle, p.angle_std, units_.angle), units_.angle.text,
                          with_std(p.distance, p.distance_std, units_.length), units_.length.text);
    }
  }

  std::string title(const ArcAxes& of) const {
    return of.arc ? fmt::format("arc {} {}", of.arc->name, units_.angle.text) : "the whole motion";
  }

  void arc_alone(const ArcAxes& of) {
    out_ += fmt::format("\nAxes from the {} ({} poses)\n", title(of), of.located[0].fit.poses_fit);
    for (std::size_t k = 0; k < of.located[0].axes.size(); ++k) axis(of.located[0], k);
    between(of.located[0]);
  }

  void changes(const ArcAxes& of) {
    out_ += fmt::format("\nChanges from the reference, {}\n", title(of));
    std::size_t width = 10;
    for (const std::string& file : context_.recordings_files) width = std::max(width, file.size());
    for (std::size_t k = 0; k < finder_.hinges().size(); ++k) {
      out_ += fmt::format("  {:<{}}", finder_.hinges()[k].name, width);
      const auto names = context_.labels.of(result_.views[k].main);
      for (std::size_t v = 0; v < 4; ++v)
        out_ += fmt::format(" {:>19}", fmt::format("{} {}", names[v], unit(v).text));
      out_ += "\n";
      for (std::size_t r = 0; r < of.changes.size(); ++r) {
        const AxisChange& c = of.changes[r][k];
        out_ += fmt::format("    {:<{}}", context_.recordings_files[r + 1], width - 2);
        if (!c.determined) {
          const LocatedAxis& here = of.located[r + 1].axes[k];
          out_ += " " + (here.determined ? of.located[0].axes[k].why : here.why) + "\n";
          continue;
        }
        // The sign of plus-minus is two bytes and one column wide.
        for (std::size_t v = 0; v < 4; ++v)
          out_ += fmt::format(" {:>20}", with_std(c.value[v], c.std[v], unit(v)));
        out_ += "\n";
      }
    }
  }

  void errors() {
    if (result_.worst.empty()) return;
    out_ +=
        fmt::format("\nErrors of the changes, measured minus actual ({})\n", context_.actual_file);
    auto table = [&](const ArcAxes& of) {
      out_ += fmt::format("  {}\n", title(of));
      for (const ChangeErrors& e : of.errors) row(e, "");
    };
    table(result_.whole);
    for (const ArcAxes& arc : result_.arcs) table(arc);
    if (result_.arcs.empty()) return;
    out_ += "  worst arc of each\n";
    for (const auto& [arc, e] : result_.worst) row(e, result_.arcs[arc].arc->name);
  }

  void row(const ChangeErrors& e, const std::string& arc) {
    const Unit u = unit(e.variable);
    out_ +=
        fmt::format("    {:<20} {:>3}  bias {:>8.3f}  precision {:>8.3f}  RMSE {:>8.3f} {} {}",
                    variable_name(finder_, result_, context_.labels, e.axis, e.variable), e.count,
                    e.bias / u.factor, e.precision / u.factor, e.rmse / u.factor, u.text, arc);
    out_.erase(out_.find_last_not_of(' ') + 1);
    out_ += "\n";
  }

  const AxisFinder& finder_;
  const AxesResult& result_;
  const AxesContext& context_;
  const UnitSystem& units_;
  std::string out_;
};

}  // namespace

std::string axes_text(const AxisFinder& finder, const AxesResult& result,
                      const AxesContext& context) {
  return Text(finder, result, context).whole();
}

}  // namespace talus
