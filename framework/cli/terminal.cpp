#include "framework/cli/terminal.h"

#include <fmt/color.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "framework/report/layout.h"
#include "framework/report/progress.h"
#include "framework/report/verdict.h"

namespace talus {
namespace {

bool coloured(int file) {
  if (colours() != Colours::automatic) return colours() == Colours::always;
  const char* no = std::getenv("NO_COLOR");  // https://no-color.org
  return is_terminal(file) && !(no && *no);
}

std::string in_style(const std::string& text, fmt::text_style style) {
  return fmt::format(style, "{}", text);
}

fmt::text_style style_of(Mood mood) {
  const auto in = [](fmt::terminal_color c) { return fmt::emphasis::bold | fmt::fg(c); };
  switch (mood) {
    case Mood::good:
      return in(fmt::terminal_color::green);
    case Mood::doubtful:
      return in(fmt::terminal_color::yellow);
    case Mood::bad:
      return in(fmt::terminal_color::red);
  }
  return fmt::emphasis::bold;
}

// The first line's word, or a heading: a title alone, or what stands before the first full stop.
std::string with_style(const std::string& line, bool first) {
  const std::size_t stop = line.find(". ");
  if (first && stop != std::string::npos)
    if (const auto mood = mood_of(line.substr(0, stop)))
      return in_style(line.substr(0, stop + 1), style_of(*mood)) + line.substr(stop + 1);
  const std::size_t end = stop == std::string::npos ? line.size() : stop + 1;
  return in_style(line.substr(0, end), fmt::emphasis::bold) + line.substr(end);
}

std::size_t width() {
  return isatty(STDERR_FILENO)
             ? std::clamp<std::size_t>(terminal_columns(STDERR_FILENO), 30, kTextWidth)
             : kTextWidth;
}

}  // namespace

Colours& colours() {
  static Colours chosen = Colours::automatic;
  return chosen;
}

void show(const std::string& report) {
  if (!coloured(STDOUT_FILENO)) {
    fmt::print("{}", report);
    return;
  }
  bool behind_empty = true;
  std::string out;
  for (std::size_t at = 0; at < report.size();) {
    const std::size_t end = std::min(report.find('\n', at), report.size());
    const std::string line = report.substr(at, end - at);
    const bool heading = behind_empty && !line.empty() && line[0] != ' ';
    out += (heading ? with_style(line, at == 0) : line) + "\n";
    behind_empty = line.empty();
    at = end + 1;
  }
  fmt::print("{}", out);
}

void warn(const std::string& sentence) {
  static std::set<std::string> said;
  if (!said.insert(sentence).second) return;
  std::fflush(stdout);
  std::string text = wrapped(sentence, "Warning: ", "  ", width());
  if (coloured(STDERR_FILENO))
    text = in_style("Warning:", fmt::fg(fmt::terminal_color::yellow)) + text.substr(8);
  fmt::print(stderr, "{}", text);
}

void complain(const std::string& place, const std::string& what) {
  std::fflush(stdout);
  if (coloured(STDERR_FILENO))
    fmt::print(stderr, "{} {} {}\n", in_style(place + ":", fmt::emphasis::bold),
               in_style("error:", fmt::emphasis::bold | fmt::fg(fmt::terminal_color::red)), what);
  else
    fmt::print(stderr, "{}: error: {}\n", place, what);
}

void complain(const InputError& error) {
  const std::string place = to_string(error.place());
  std::string what = error.what();
  if (!place.empty() && what.starts_with(place + ": ")) what.erase(0, place.size() + 2);
  complain(place.empty() ? "talus" : place, what);
}

}  // namespace talus
