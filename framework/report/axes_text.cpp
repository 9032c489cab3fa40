#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "framework/report/axes.h"
#include "framework/report/layout.h"
#include "framework/report/verdict.h"

namespace talus {
namespace {

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
    const std::string& name = finder_.program().name;
    out_ = text_of(verdict_of_axes(result_, context_.recordings_files)) +
           fmt::format("\n{}\n  model {}{}\n", name.empty() ? "Model" : name, context_.model_file,
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
    const bool known = of.located[0].fit.noise_known;
    Table table({"<recordings", ">poses",
                 known ? ".times the stated noise" : ".residuals (weighted)",
                 "<uncertainties from"});
    for (std::size_t r = 0; r < of.located.size(); ++r) {
      const Located& l = of.located[r];
      table.row({context_.recordings_files[r], std::to_string(l.fit.poses_fit),
                 fmt::format("{:.3g}", l.fit.noise_scale),
                 l.observed ? "the residuals' spread" : "the stated noise"});
    }
    out_ += table.text();
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
        fmt::format("    in {}, main direction {}\n", view.name, context_.labels.along[view.main]);
    Table table({"<where", ".value", ".std", "<unit"});
    for (std::size_t v = 0; v < 4; ++v) {
      const int d = decimals_for(a.std[v] / unit(v).factor);
      table.row({names[v], fixed(a.value[v] / unit(v).factor, d),
                 "± " + fixed(a.std[v] / unit(v).factor, d), unit(v).text});
    }
    const std::string rows = table.text(6);
    out_ += rows.substr(rows.find('\n') + 1);
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
    for (std::size_t k = 0; k < finder_.hinges().size(); ++k) {
      const auto names = context_.labels.of(result_.views[k].main);
      std::vector<std::string> headings{"<" + finder_.hinges()[k].name};
      for (std::size_t v = 0; v < 4; ++v)
        headings.push_back("." + fmt::format("{} {}", names[v], unit(v).text));
      Table table(headings);
      std::string without;
      for (std::size_t r = 0; r < of.changes.size(); ++r) {
        const AxisChange& c = of.changes[r][k];
        if (!c.determined) {
          const LocatedAxis& here = of.located[r + 1].axes[k];
          without += wrapped((here.determined ? of.located[0].axes[k].why : here.why),
                             "  " + context_.recordings_files[r + 1] + ": ", "    ");
          continue;
        }
        std::vector<std::string> cells{context_.recordings_files[r + 1]};
        for (std::size_t v = 0; v < 4; ++v)
          cells.push_back(with_std(c.value[v], c.std[v], unit(v)));
        table.row(cells);
      }
      out_ += table.text() + without;
    }
  }

  void errors() {
    if (result_.worst.empty()) return;
    out_ +=
        fmt::format("\nErrors of the changes, measured minus actual ({})\n", context_.actual_file);
    Table table({"<of", "<variable", ">n", ".bias", ".precision", ".RMSE", "<unit"});
    auto row = [&](const ChangeErrors& e, const std::string& of) {
      const Unit u = unit(e.variable);
      table.row({of, variable_name(finder_, result_, context_.labels, e.axis, e.variable),
                 std::to_string(e.count), fixed(e.bias / u.factor, 3),
                 fixed(e.precision / u.factor, 3), fixed(e.rmse / u.factor, 3), u.text});
    };
    auto rows = [&](const ArcAxes& of) {
      for (const ChangeErrors& e : of.errors) row(e, title(of));
    };
    rows(result_.whole);
    for (const ArcAxes& arc : result_.arcs) rows(arc);
    out_ += table.text();
    if (result_.arcs.empty()) return;
    out_ += "\nThe worst arc of each\n";
    table.clear();
    for (const auto& [arc, e] : result_.worst) row(e, "arc " + result_.arcs[arc].arc->name);
    out_ += table.text();
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
