#include <fmt/format.h>

#include <cmath>

#include "framework/report/diagnosis_report.h"

namespace talus {

std::string diagnosis_text(const Diagnosis& d, const std::string& extended_model) {
  std::string out = fmt::format("{}: {}\n", to_string(d.verdict), d.statement);
  auto finding = [&](const Finding& f, const char* kind) {
    out += fmt::format("\n{}: {} at {}, probability {:.2f}, {:.3g} sigmas a pose\n", kind, f.effect,
                       f.location, f.probability, f.sigmas);
    for (const ShownValue& v : f.parameters)
      out += fmt::format("  {:<12} {:>12.5g}{} {}\n", v.name, v.value,
                         std::isfinite(v.std) ? fmt::format(" ± {:.2g}", v.std) : "",
                         v.unit == "1" ? "" : v.unit);
    for (const NamedRival& r : f.rivals)
      out += fmt::format("  or {} at {}: {:.4f}\n", r.effect, r.location, r.probability);
  };
  for (const Finding& f : d.findings) finding(f, "Finding");
  for (const Finding& f : d.hints) finding(f, "Hint");
  if (!extended_model.empty()) out += fmt::format("\nExtended model: {}\n", extended_model);
  return out;
}

}  // namespace talus
