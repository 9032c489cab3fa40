// What a user sees of the commands: the verdict first, colours and a bar on a terminal only,
// nothing beside the results with --quiet.
#include <regex>

#include "framework/report/layout.h"
#include "tests/support/command.h"
#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

namespace {

const std::string arm = "'" + shipped("arm-6r/model.xml") + "'", escape = "\x1b[";

struct RecordedFolder : Folder {
  RecordedFolder() {
    REQUIRE(command(*this, "simulate " + arm + " --poses 60 --recordings poses.csv --quiet").code ==
            0);
  }
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("the verdict comes first, in words, with figures of rows held out") {
  const RecordedFolder folder;
  const Run fit = command(folder, "calibrate " + arm + " poses.csv");
  CHECK(std::regex_search(
      fit.out,
      std::regex("^CALIBRATED\\. The stated noise explains what the fit leaves\\.\n  On 18 "
                 "poses held out, residuals are [0-9.]+ times the stated noise")));
  CHECK(fit.error.empty());
  // Rows with an error that the model lacks.
  REQUIRE(
      command(folder, "simulate " + arm + " --poses 60 --noise 4 --recordings noisy.csv --seed 3")
          .code == 0);
  const Run noisy = command(folder, "calibrate " + arm + " noisy.csv");
  CHECK(noisy.out.starts_with("NOT EXPLAINED. "));
  CHECK(!contains(noisy.out, "Warning"));
  CHECK(noisy.error.starts_with("Warning: What is left is "));
  const Run few = command(folder, "calibrate " + arm + " poses.csv --iterations 1 --restarts 0");
  CHECK(few.code == 1);
  CHECK(few.out.starts_with("NOT CONVERGED. "));
  const Run model = command(folder, "check " + arm);
  CHECK(model.out.starts_with("SOUND. A linkage of 6 joints and 27 free parameters.\n"));
  const Run both = command(folder, "check " + arm + " poses.csv");
  CHECK(contains(both.out.substr(0, 300), "At the nominal values every direction"));
}

TEST_CASE("no line of a report is wider than 80 columns, and warnings come once") {
  const RecordedFolder folder;
  for (const std::string& arguments :
       {"calibrate " + arm + " poses.csv --folds 3", "check " + arm + " poses.csv"}) {
    std::istringstream lines(command(folder, arguments).out);
    for (std::string line; std::getline(lines, line);) {
      CAPTURE(line);
      CHECK((columns_of(line) <= kTextWidth || contains(line, "/")));  // a path is not broken
    }
  }
}

TEST_CASE("--quiet: nothing on standard output, whatever the command; --json - is JSON alone") {
  const RecordedFolder folder;
  for (const std::string& arguments :
       {"check " + arm + " poses.csv", "calibrate " + arm + " poses.csv",
        "diagnose " + arm + " poses.csv --next-count 0 --only encoder_eccentricity",
        "simulate " + arm + " --poses 3 --recordings few.csv",
        "motion " + arm + " --poses 3 --table motion.csv", "draw " + arm,
        "axes '" + shipped("knee-two-axis/model.xml") + "' nowhere.csv"}) {
    CAPTURE(arguments);
    const Run run = command(folder, arguments + " --quiet");
    CHECK(run.out.empty());
    CHECK(run.error.empty() == (run.code == 0));  // errors are told nevertheless
  }
  for (const std::string& arguments :
       {"calibrate " + arm + " poses.csv --quiet",
        "diagnose " + arm + " poses.csv --next-count 0 --only encoder_eccentricity"}) {
    const Run run = command(folder, arguments + " --json -");
    CHECK(run.out.starts_with("{"));
    CHECK(run.out.ends_with("}\n"));
  }
}

TEST_CASE("colours: on a terminal, unless NO_COLOR is set or TERM is dumb; --color decides") {
  const RecordedFolder folder;
  const std::string check = "check " + arm;
  CHECK(!contains(command(folder, check).out, escape));
  const std::string always = command(folder, check + " --color always").out;
  CHECK(always.starts_with(escape));
  CHECK(contains(always, "SOUND."));
  CHECK(contains(always, escape + "1mFrames" + escape + "0m\n"));
  std::string bare = std::regex_replace(always, std::regex("\x1b\\[[0-9]*m"), "");
  CHECK(bare == command(folder, check).out);
  CHECK(contains(terminal(folder, check), escape));
  CHECK(!contains(terminal(folder, check + " --color never"), escape));
  CHECK(!contains(terminal(folder, check, "TERM=xterm NO_COLOR=1"), escape));
  CHECK(contains(terminal(folder, check, "TERM=xterm NO_COLOR="), escape));
  CHECK(contains(terminal(folder, check + " --color always", "TERM=xterm NO_COLOR=1"), escape));
  CHECK(!contains(terminal(folder, check, "TERM=dumb"), escape));
  // Data are never coloured.
  CHECK(!contains(command(folder, "simulate " + arm + " --poses 3 --color always").out, escape));
  CHECK(!contains(command(folder, "calibrate " + arm + " poses.csv --json - --color always").out,
                  escape));
}

TEST_CASE("errors: the place, the word error, what was found") {
  const Folder folder;
  folder.write("broken.csv", "pose,theta1[deg]\n1,three\n");
  const std::string arguments = "calibrate " + arm + " broken.csv";
  const std::string plain = command(folder, arguments).error;
  CHECK(plain.starts_with("broken.csv:2:3: error: "));
  CHECK(!contains(plain, escape));
  const std::string coloured = command(folder, arguments + " --color always").error;
  CHECK(coloured.starts_with(escape + "1mbroken.csv:2:3:" + escape + "0m "));
  CHECK(contains(coloured, "31merror:"));
  CHECK(command(folder, "check --colour never x").error.starts_with("talus check: error: "));
}

TEST_CASE("a bar, on a terminal, of what takes long; cleared before the report") {
  const RecordedFolder folder;
  const std::string slow = "calibrate " + arm + " poses.csv --threads 1 --restarts 10000 ";
  const std::string shown = terminal(folder, slow + "--color never");
  const std::size_t cleared = shown.rfind("\r\x1b[K"), verdict = shown.find("CALIBRATED.");
  CHECK(std::regex_search(shown, std::regex("\rfitting +\\[#*")));
  CHECK(std::regex_search(shown, std::regex(" %, about [0-9]+ (s|min) left")));
  REQUIRE(verdict != std::string::npos);
  CHECK(cleared + 4 == verdict);
  CHECK(!contains(terminal(folder, slow + "--quiet"), "\x1b["));
  CHECK(!contains(terminal(folder, slow, "TERM=dumb"), "\r"));
  CHECK(command(folder, slow).error.find('%') == std::string::npos);
  // What is done at once has none.
  CHECK(!contains(terminal(folder, "check " + arm + " --color never"), "\r"));
}
