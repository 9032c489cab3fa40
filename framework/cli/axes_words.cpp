#include "framework/cli/axes_words.h"

#include <fmt/format.h>

namespace talus {

AxisLabels AxesWords::axis_labels() const {
  AxisLabels result;
  if (anatomical()) result = {{"A-P", "M-L", "P-D"}, {"V-V", "F-E", "I-E"}};
  if (labels.empty()) return result;
  const auto words = CLI::detail::split(labels, ',');
  if (words.size() != 6)
    throw InputError({"--labels " + labels, 0, 0}, fmt::format("{} names", words.size()),
                     "six: along x, y, z, then about x, y, z, such as A-P,M-L,P-D,V-V,F-E,I-E");
  for (std::size_t i = 0; i < 3; ++i) {
    result.along[i] = CLI::detail::trim_copy(words[i]);
    result.about[i] = CLI::detail::trim_copy(words[i + 3]);
  }
  return result;
}

void add_axes_words(CLI::App& command, AxesWords& words) {
  command.add_option("--of", words.of, "the measured frame, where the model has several");
  command.add_option("--by", words.by, "the flexing hinge (default: the first)");
  command
      .add_option("--frames", words.frames,
                  "describe axes in the bodies' own frames, or in anatomical ones made from the "
                  "reference (y along the flexion axis, z nearest to the other axis)")
      ->check(CLI::IsMember({"body", "anatomical"}))
      ->capture_default_str();
  command.add_option("--labels", words.labels,
                     "names along x, y, z and about x, y, z: A-P,M-L,P-D,V-V,F-E,I-E");
  command.add_option("--reverse", words.reverse, "a hinge whose axis is to point the other way")
      ->allow_extra_args(false);
}

}  // namespace talus
