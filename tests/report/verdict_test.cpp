// The words of a verdict: one number, the one with degrees of freedom, in text and page alike.
#include "framework/report/verdict.h"

#include <fmt/format.h>

#include "framework/page/contents.h"
#include "tests/support/fits.h"

using namespace talus;
using namespace talus::testing;

namespace {

std::string whole(const Spoken& verdict) { return join(verdict.sentences, " "); }

}  // namespace

TEST_CASE("the verdict of a fit, as text and on its page") {
  const Program program = program_of(shipped("isl-bonny-2013/model.xml"));
  const Recordings recordings = read_recordings(shipped("isl-bonny-2013/recordings.csv"));
  const Split split = random_split(recordings, 1);
  FitOptions options;
  options.restarts = 0;
  Fit fit = calibrate(program, recordings, split, options);
  const Spoken verdict = verdict_of_fit(program, fit);
  CHECK(verdict.word == "CALIBRATED");
  CHECK(fit.noise_scale != doctest::Approx(fit.fit_rms / fit.expected_rms).epsilon(0.02));
  CHECK(whole(verdict).find(fmt::format("{:#.3g} times the stated noise: chi-square",
                                        fit.noise_scale)) != std::string::npos);
  CHECK(whole(verdict).find("36 of 38 directions") != std::string::npos);
  PageContent page;
  page_of_fit(page, program, recordings, split, fit);
  CHECK(page.headline == verdict.headline);
  REQUIRE(page.sentences.size() >= verdict.sentences.size());
  CHECK(page.sentences[0] == verdict.sentences[0]);
  CHECK(text_report(program, fit, {}).starts_with(text_of(verdict)));

  fit.heldout_rms = 4 * fit.fit_rms;  // worse than the fit warns of
  CHECK(verdict_of_fit(program, fit).word == "NOT EXPLAINED");
  fit.dof = 0, fit.heldout_rms = fit.fit_rms;
  CHECK(verdict_of_fit(program, fit).word == "NOT JUDGED");
  fit.converged = false;
  CHECK(verdict_of_fit(program, fit).word == "NOT CONVERGED");
}

TEST_CASE("every word of a verdict has its mood, and others have none") {
  for (const char* word : {"SOUND", "CALIBRATED", "LOCATED", "EXPLAINED", "NOTHING MISSING"})
    CHECK(mood_of(word) == Mood::good);
  for (const char* word : {"NOT EXPLAINED", "NOT JUDGED", "AMBIGUOUS", "UNKNOWN PHYSICS"})
    CHECK(mood_of(word) == Mood::doubtful);
  CHECK(mood_of("NOT CONVERGED") == Mood::bad);
  CHECK(!mood_of("Parameters"));
}
